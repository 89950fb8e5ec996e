"""Detection of exchanged cameras: the map of a run is then the inverse of a stored one.

With cameras exchanged, camera 1 of the run is camera 2 of the calibration. If the stored map takes
an object point from x to x + d(x), the map of the run has the displacement -d(x) at x + d(x); with
the cameras in place it has d(x) at x. The translation between the cameras drifts from session to
session, so it decides nothing: magnification, rotation and distortion do.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy import ndimage

from erlif.core.arrays import AnyArray, Array, Mask
from erlif.registration.camera_map import CameraMap
from erlif.registration.settings import orient

# Points along each axis at which the maps are compared; a map is smooth.
NODES: Final = 65
# Points that both maps must know.
FEWEST: Final = 64
# Rms change of magnification, rotation and distortion between two sessions on one rig. [px]
REPRODUCIBILITY: Final = 0.05
# Standard deviations of the maps between the found one and the middle of the two candidates.
CLEAR: Final = 5.0
# Largest misfit of the better candidate in parts of that of the other; a third map has more.
CLOSE: Final = 0.25


@dataclass(frozen=True)
class InverseComparison:
    """A map found on a run beside a stored map and beside the inverse of the stored map.

    Attributes
    ----------
    misfit : float
        Rms distance from the stored map after the best translation; infinite if the two maps
        have different orientations or frame sizes, NaN if they have too few points in common.
        [px]
    misfit_inverse : float
        The same from the inverse of the stored map. [px]
    significance : float
        Distance of the found map from the middle between the two candidates, in standard
        deviations of the maps; half the distance between the candidates if one of them fits
        exactly. [1]
    inverted : bool | None
        True if the found map is the inverse of the stored one, False if it is the stored map
        itself, None if the maps have too little structure to decide or the found map fits
        neither.
    """

    misfit: float
    misfit_inverse: float
    significance: float
    inverted: bool | None


@dataclass(frozen=True)
class MapField:
    """Displacement at some points, its standard deviation, and where they can be used.

    Attributes
    ----------
    dx : Array
        Displacement along x, of any shape. [px]
    dy : Array
        Displacement along y. [px]
    std : Array
        Standard deviation of one component. [px]
    known : Mask
        True where the map can be used.
    """

    dx: Array
    dy: Array
    std: Array
    known: Mask


@dataclass(frozen=True)
class MapNodes:
    """A stored map at the points where it is compared: the map itself need not be kept.

    Attributes
    ----------
    shape : tuple[int, int]
        Rows and columns of camera 1. [px]
    orientation : str
        Orientation of camera 2 in the settings of the map.
    x : Array
        Columns of the points, (row, column). [px]
    y : Array
        Rows of the points, (row, column). [px]
    field : MapField
        The map at the points, (row, column).
    """

    shape: tuple[int, int]
    orientation: str
    x: Array
    y: Array
    field: MapField

    @classmethod
    def of(cls, camera_map: CameraMap) -> MapNodes:
        """The points of a map."""
        row, column = (np.unique(np.linspace(0, n - 1, NODES).round()) for n in camera_map.shape)
        x, y = np.meshgrid(column, row)
        field = _sample(camera_map, x, y)
        return cls(camera_map.shape, camera_map.settings.orientation, x, y, field)


def compare_with_inverse(stored: CameraMap | MapNodes, camera_map: CameraMap) -> InverseComparison:
    """Decide whether a map found on a run is a stored map or the inverse of it.

    Parameters
    ----------
    stored : CameraMap or MapNodes
        The map of the calibration, from its camera 1 to its camera 2.
    camera_map : CameraMap
        The map found on the run, from the run's camera 1 to the run's camera 2.

    Returns
    -------
    InverseComparison
        Both misfits and the verdict. Translations are left out of the comparison, so maps without
        magnification, rotation or distortion are undecided.

    Examples
    --------
    Camera 2 magnifies by 1.02 about the centre of the frame; seen from camera 2, camera 1 reduces.

    >>> from erlif.registration import CameraMap, MapKind
    >>> y, x = np.indices((200, 300)) - np.array([99.5, 149.5]).reshape(2, 1, 1)
    >>> everywhere, exact = x == x, 0 * x
    >>> def magnify(by):
    ...     shift = (by - 1) * x, (by - 1) * y
    ...     return CameraMap(*shift, exact, everywhere, ~everywhere, 1.0, MapKind.SURFACE)
    >>> compare_with_inverse(magnify(1.02), magnify(1 / 1.02)).inverted
    True
    >>> compare_with_inverse(magnify(1.02), magnify(1.02)).inverted
    False
    """
    nodes = MapNodes.of(stored) if isinstance(stored, CameraMap) else stored
    own, x, y = nodes.field, nodes.x, nodes.y
    same = exchanged = None
    if nodes.shape == camera_map.shape and nodes.orientation == camera_map.settings.orientation:
        same = _sample(camera_map, x, y)

    # the turn of the run's camera 2 undoes that of the stored map's camera 2
    turn = _turn_matrix(nodes.orientation)
    if (turn @ _turn_matrix(camera_map.settings.orientation) == np.eye(2)).all():
        exchanged = _sample(camera_map, x + own.dx, y + own.dy, nodes.orientation)

    # one set of points for both candidates, so that their misfits can be compared
    known = own.known
    for field in (same, exchanged):
        if field is not None:
            known = known & field.known
    if known.sum() < FEWEST:
        return InverseComparison(np.nan, np.nan, 0.0, None)

    misfit, misfit_inverse = np.inf, np.inf
    variance = 2 * (own.std[known] ** 2).mean()  # of the two components together
    if same is not None:
        misfit = _rms(same.dx - own.dx, same.dy - own.dy, known)
    if exchanged is not None:
        misfit_inverse = _rms(exchanged.dx + own.dx, exchanged.dy + own.dy, known)
    run = exchanged if same is None else same
    if run is not None:
        variance += 2 * (run.std[known] ** 2).mean()

    return judge(
        misfit,
        misfit_inverse,
        apart=2 * _rms(own.dx, own.dy, known),  # d and -d are apart by twice d
        std=float(np.sqrt(variance + REPRODUCIBILITY**2)),
    )


def judge(misfit: float, misfit_inverse: float, *, apart: float, std: float) -> InverseComparison:
    """Verdict from the misfits, the distance between the candidates and the noise of the maps. [px]

    The found map lies ``(worse^2 - better^2) / (2 apart)`` from the middle, along the line between
    the candidates. The error of a map is correlated over the frame: at worst all of ``std`` lies
    along that line, and this is assumed.
    """
    better, worse = sorted((misfit, misfit_inverse))
    worse = min(worse, apart)  # also where the orientation excludes one of the candidates
    if not better < worse:
        return InverseComparison(misfit, misfit_inverse, 0.0, None)

    significance = (worse**2 - better**2) / (2 * apart * std)
    clear = significance > CLEAR and better < CLOSE * worse
    return InverseComparison(
        misfit, misfit_inverse, significance, misfit_inverse < misfit if clear else None
    )


def _turn_matrix(orientation: str) -> Array:
    """Matrix that takes a vector (x, y) on the pixels of a camera to the oriented image."""
    row, column = (orient(index, orientation) for index in np.indices((2, 2), dtype=float))
    # the derivatives of the original coordinates are the inverse of the matrix, its transpose
    return np.array(
        [
            [column[0, 1] - column[0, 0], row[0, 1] - row[0, 0]],
            [column[1, 0] - column[0, 0], row[1, 0] - row[0, 0]],
        ]
    )


def _sample(camera_map: CameraMap, x: Array, y: Array, orientation: str = "normal") -> MapField:
    """A map at any points, by bilinear interpolation; not known beyond its edges.

    With the orientation of a stored map, a map of a run on the pixels of the stored map's camera 2:
    the turn of camera 2 applies to camera 1 of the run if the cameras are exchanged. Both the image
    of the displacement and its vectors are turned.
    """
    usable, turn = camera_map.overlap & ~camera_map.poor, _turn_matrix(orientation)

    def at_points(values: AnyArray) -> Array:
        used = orient(np.where(usable, values, np.nan), orientation)
        return np.asarray(ndimage.map_coordinates(used, [y, x], float, order=1, cval=np.nan))

    dx, dy = at_points(camera_map.displacement_x), at_points(camera_map.displacement_y)
    dx, dy = turn[0, 0] * dx + turn[0, 1] * dy, turn[1, 0] * dx + turn[1, 1] * dy
    std = at_points(camera_map.displacement_std)
    return MapField(dx, dy, std, np.isfinite(dx + dy + std))


def _rms(dx: Array, dy: Array, known: Mask) -> float:
    """Rms length of vectors about their mean, which is the best translation."""
    return float(np.sqrt(dx[known].var() + dy[known].var()))
