"""The position of a pin in its bushing, from the gap that a map shows.

The gap of rigid and parallel circles is h = c - ex cos phi - ey sin phi, with the radial clearance
c and the displacement (ex, ey) of the axis of the pin along the load and sideways; a tilt adds the
position z along the axis to both. The four numbers are fitted to the log ratio of blocks. The
curvature along sliding is fixed by the radii; a bore that is not straight adds its known shape. A
second fit leaves the curvature and a bend along the axis free, as a check of calibration and radii.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
import xarray as xr

from erlif.calibration import RatioCurve, calibration_of
from erlif.core.arrays import Array
from erlif.core.errors import ConfigError
from erlif.core.products import RatioImages, require
from erlif.core.statistics import symmetric_root
from erlif.models.contact import conformal_radius
from erlif.trend.block_fit import average_blocks, fit_blocks, sum_by_strips
from erlif.trend.blocks import BlockSums, Region, sum_blocks
from erlif.trend.bore import AxialShape
from erlif.trend.curve import FilmCurve

# Order of the numbers of a position: displacements [um], then tilts [um/mm].
PARAMETERS = ("displacement_load", "displacement_side", "tilt_load", "tilt_side")

_PINNED = len(PARAMETERS)


@dataclass(frozen=True)
class PinView:
    """The joint as the camera sees it.

    Attributes
    ----------
    pitch : float
        Size of a pixel in the object plane. [mm]
    pin_radius : float
        Radius of the pin. [m]
    bushing_radius : float
        Radius of the bore. [m]
    load_line : float
        Position along sliding at which the load presses, from the first pixel. [mm]
    axial_origin : float
        Position along the axis at which z is zero, from the first pixel. [mm]
    sliding_along_x : bool
        Whether image x is the sliding direction.
    bore : AxialShape or None
        Shape along the axis of a bore that is not straight.
    """

    pin_radius: float
    bushing_radius: float
    pitch: float
    load_line: float
    axial_origin: float
    sliding_along_x: bool = True
    bore: AxialShape | None = None

    @property
    def clearance(self) -> float:
        """Radial clearance. [um]"""
        return (self.bushing_radius - self.pin_radius) * 1e6

    @property
    def least_clearance(self) -> float:
        """Radial clearance where the bore is narrowest along the axis. [um]"""
        return self.clearance + (0.0 if self.bore is None else float(self.bore.height.min()))

    @property
    def radius(self) -> float:
        """Radius over which positions along sliding are angles, sqrt(R1 R2). [mm]

        With it, the gap of touching circles has the curvature 1/R of `conformal_radius`.
        """
        return float(np.sqrt(self.pin_radius * self.bushing_radius)) * 1e3

    @property
    def curvature(self) -> float:
        """Second derivative 1/R of the gap of touching circles along sliding. [um/mm2]"""
        return 1 / float(conformal_radius(self.pin_radius, bushing_radius=self.bushing_radius))

    def sees(self, first: float, last: float) -> bool:
        """Whether positions along sliding [mm] lie within a quarter of a turn of the load line."""
        far = max(abs(first - self.load_line), abs(last - self.load_line))
        return far < 0.5 * np.pi * self.radius


@dataclass(frozen=True)
class FittedNumbers:
    """Some numbers of a fit to the film of one trigger, and their errors.

    The parts of the covariances are disjoint: noise is new at every trigger, marks of the surfaces
    are the same at every trigger, and an error of the calibration is common to all.

    Attributes
    ----------
    value : Array
        (number,)
    random_cov : Array
        Their covariance by the noise of the ratio, (number, number).
    surface_cov : Array
        By marks and waviness of the surfaces.
    gradient : Array
        Their change with what was fitted to the fixture, (number, calibration parameter), in the
        order of `RatioCurve.full_covariance`.
    """

    value: Array
    random_cov: Array
    surface_cov: Array
    gradient: Array

    def covariance(self, calibration_cov: Array) -> Array:
        """Covariance of the numbers, all parts together.

        Parameters
        ----------
        calibration_cov : array
            `RatioCurve.full_covariance`.

        Returns
        -------
        array, (number, number)
        """
        shared = self.gradient @ calibration_cov @ self.gradient.T
        return np.asarray(self.random_cov + self.surface_cov + shared)


@dataclass(frozen=True)
class PinPosition(FittedNumbers):
    """Position of the pin at one trigger, and the form of its gap.

    The position is the displacement of the pin towards the load and sideways [um] and its tilts
    [um/mm], in the order of `PARAMETERS`.

    Attributes
    ----------
    form : FittedNumbers
        Curvature along sliding beyond that of the circles, and curvature along the axis. [um/mm2]
    """

    form: FittedNumbers


def find_pin_position(
    ratios: RatioImages, calibration: RatioCurve, *, region: Region, view: PinView
) -> PinPosition:
    """Find the position of the pin in its bushing from the ratio of a region.

    The gap is that of circles whose distance c is small against their radii R1 and R2,
    h = c - (ex + tx z) cos phi - (ey + ty z) sin phi with phi = (x - x_load) / sqrt(R1 R2), x along
    sliding and z along the axis. Pinkus and Sternlicht (1961).

    Parameters
    ----------
    ratios : RatioImages
        log_ratio, log_ratio_var and flags (y, x).
    calibration : RatioCurve
    region : Region
    view : PinView
        Radii of the joint, scale of the image and load line.

    Returns
    -------
    PinPosition
        NaN where too few blocks are valid.

    Raises
    ------
    ErlifError
        If a variable is missing, or the region does not lie within a quarter of a turn of the load
        line.

    Notes
    -----
    The formula is good to c/R. On the bore, the gap of exact circles has at the load line the slope
    -ey/R2: the side displacement and tilt of the formula are sqrt(R1/R2) times those of circles,
    0.3 % more for the joint of Farzaneh (2002).

    Examples
    --------
    A pin that is 3 um from the wall at the load line, and rises by 0.01 um/mm along the axis:

    >>> import xarray as xr
    >>> from erlif.core.products import RatioImages
    >>> from erlif.show.plots import example_calibration
    >>> from erlif.trend import PinView, Region
    >>> calibration, position = example_calibration(), 0.1 * np.arange(64)
    >>> view = PinView(33.36e-3, 33.59e-3, 0.1, load_line=3.15, axial_origin=3.15)
    >>> phi, z = (position - 3.15) / view.radius, position[:, None] - 3.15
    >>> film = 230 - (227 - 0.01 * z) * np.cos(phi)
    >>> ratios = RatioImages(xr.Dataset({
    ...     "log_ratio": (("y", "x"), calibration.predict_log(film)),
    ...     "log_ratio_var": (("y", "x"), np.full((64, 64), 1e-8)),
    ...     "flags": (("y", "x"), np.zeros((64, 64), np.uint16)),
    ... }))
    >>> whole = Region(slice(0, 64), slice(0, 64))
    >>> found = find_pin_position(ratios, calibration, region=whole, view=view)
    >>> found.value[0].round(2), found.value[2].round(3)
    (np.float64(227.0), np.float64(-0.01))
    """
    require(ratios, "log_ratio", "log_ratio_var", "flags")
    curve = FilmCurve.of(calibration)
    return find_pin_in_blocks(sum_blocks(ratios, region), curve, region=region, view=view)


def find_pin_in_blocks(
    sums: BlockSums, curve: FilmCurve, *, region: Region, view: PinView
) -> PinPosition:
    """Find the position of the pin from the sums over the blocks of a region.

    `find_pin_position` does the same from images, and states the equation and the errors.

    Returns
    -------
    PinPosition
        NaN where too few blocks are valid.

    Examples
    --------
    A region without light has no position:

    >>> from erlif.show.plots import example_calibration as made
    >>> whole, view = Region(slice(0, 64), slice(0, 64)), PinView(33e-3, 34e-3, 0.1, 3.0, 3.0)
    >>> dark = BlockSums((64, 64), 0.0, *[np.zeros((8, 8))] * 11, valid=0, beyond=0)
    >>> find_pin_in_blocks(dark, FilmCurve.of(made()), region=whole, view=view).value
    array([nan, nan, nan, nan])
    """
    blocks = average_blocks(sums, sliding_along_x=view.sliding_along_x)
    sliding, axial = (
        (region.columns, region.rows) if view.sliding_along_x else (region.rows, region.columns)
    )

    # positions in mm; blocks have the means of x and of its square
    centre, half = _region_span(sliding, view.pitch)
    offset = centre - view.load_line
    ends = centre - half, centre + half
    if not view.sees(*ends):
        raise ConfigError(
            f"Expected a load line within {0.5 * np.pi * view.radius:.0f} mm of all of the region, "
            f"a quarter of a turn; it is at {view.load_line:.2f} mm, the region lies at "
            f"{ends[0]:.2f} to {ends[1]:.2f} mm. Correct load_line in [prediction], pixel_pitch in "
            "[optics] or the radii in [joint]."
        )
    x = offset + half * blocks.along
    x_squared = offset**2 + 2 * offset * half * blocks.along + half**2 * blocks.along_squared
    axial_centre, axial_half = _region_span(axial, view.pitch)
    z = axial_centre - view.axial_origin + axial_half * blocks.across

    # means of cosine and sine over a block, to the second order of its width
    phi = x / view.radius
    within = 1 - (x_squared - x**2) / (2 * view.radius**2)
    cosine, sine = np.cos(phi) * within, np.sin(phi) * within
    shapes = np.stack([-cosine, -sine, -z * cosine, -z * sine, x_squared / 2, z**2 / 2])

    # amplitudes of shapes that reach 1 are films; the fit ends by the change of those
    scale = 1 / np.abs(shapes).max(axis=1, initial=1e-9)
    shape = 0.0 if view.bore is None else view.bore.in_blocks(blocks, axial)
    fit = fit_blocks(blocks, curve, shapes * scale[:, None], base=view.clearance + shape)
    if fit is None:
        return _no_position(curve.parameters)

    # the position with the form held at zero follows from the free fit in one linear step
    curvature = fit.curvature
    pinned = curvature[:_PINNED, :_PINNED]
    inverse = np.linalg.inv(pinned)
    released = inverse @ curvature[:_PINNED, _PINNED:]
    held = fit.amplitudes[:_PINNED] + released @ fit.amplitudes[_PINNED:]
    value = np.concatenate([held, fit.amplitudes[_PINNED:]]) * scale

    # change of each number with the ratio of each block, through the reweighted fit
    pull = scale[:, None] * np.concatenate(
        [
            inverse @ fit.jacobian[:_PINNED],
            np.linalg.inv(curvature)[_PINNED:] @ fit.jacobian,
        ]
    )
    along, across = (
        part.start + 0.5 * (at + 1) * (part.stop - 1 - part.start)
        for part, at in ((sliding, blocks.along), (axial, blocks.across))
    )
    place = (along, across) if view.sliding_along_x else (across, along)
    acts = curve.calibration.gradient(fit.film, place=place)
    gradient = -(pull * (fit.response / fit.total_var)) @ acts.T

    # the scatter of the blocks about the fit beyond their noise is that of the surfaces
    score = pull * (fit.weight * fit.residual)
    random = (score * (blocks.variance / fit.total_var)) @ score.T
    strips = [sum_by_strips(score, strip) for strip in (blocks.strip_along, blocks.strip_across)]
    surface = _rest_covariance(_join_larger(*strips), random)

    def numbers(part: slice) -> tuple[Array, Array, Array, Array]:
        return value[part], random[part, part], surface[part, part], gradient[part]

    form = FittedNumbers(*numbers(slice(_PINNED, None)))
    return PinPosition(*numbers(slice(0, _PINNED)), form)


def pin_covariance(film: xr.Dataset) -> Array:
    """Covariance of the positions of all triggers of a film.

    Noise is new at every trigger. Marks of the surfaces are taken as the same at every trigger, and
    an error of the calibration is common to all: neither is averaged away by many triggers.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.process` returns it, with the position of the pin.

    Returns
    -------
    array, (trigger x parameter, trigger x parameter)
        In the order of the triggers, for each that of `PARAMETERS`: displacements in um, tilts in
        um/mm. NaN where a trigger has no position.

    Raises
    ------
    ErlifError
        If the film holds no position.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> whole = pin_covariance(film)
    >>> whole.shape
    (24, 24)
    >>> bool(np.allclose(whole[4:8, 4:8], film.pin_position_cov[1]))
    True
    """
    require(film, "pin_position_cov", "pin_position_cov_random", "pin_position_gradient")
    calibration_cov = calibration_of(film).full_covariance
    whole, random, gradient = (
        film[name].values
        for name in ("pin_position_cov", "pin_position_cov_random", "pin_position_gradient")
    )
    triggers = len(whole)
    gradient = gradient.reshape(triggers * _PINNED, -1)
    total = gradient @ calibration_cov @ gradient.T

    # the root of what is left at each trigger links the marks of one with those of another
    roots = np.full((triggers, _PINNED, _PINNED), np.nan)
    for k in range(triggers):
        here = slice(k * _PINNED, (k + 1) * _PINNED)
        left = whole[k] - random[k] - total[here, here]
        if np.isfinite(left).all():
            roots[k] = symmetric_root(left)
    marks = roots.reshape(triggers * _PINNED, _PINNED)
    return np.asarray(total + marks @ marks.T + scipy.linalg.block_diag(*random))


def load_line_covariance(film: xr.Dataset) -> Array:
    """Covariance of the positions due to the error of the load line.

    Displacements and tilts turn with the line. It repeats from trigger to trigger, and changes no
    film.

    Parameters
    ----------
    film : xarray.Dataset
        pin_displacement and pin_tilt; attributes load_line_std and radius [mm] of pin_displacement
        where the error is known.

    Returns
    -------
    array, (trigger, parameter, parameter)
        Zero where it is not known. [um2]

    Examples
    --------
    A line that is known to 0.1 mm shifts a pin that is 220 um off centre by 0.66 um sideways:

    >>> attrs = {"load_line_std": 0.1, "radius": 33.5}
    >>> film = xr.Dataset({
    ...     "pin_displacement": (("trigger", "axis"), [[220.0, 0.0]], attrs),
    ...     "pin_tilt": (("trigger", "axis"), [[0.0, 0.0]]),
    ... })
    >>> float(np.sqrt(load_line_covariance(film)[0, 1, 1]).round(2))
    0.66
    """
    attrs = film.pin_displacement.attrs
    angle = attrs.get("load_line_std", 0.0) / attrs.get("radius", 1.0)
    both = (film[name].values for name in ("pin_displacement", "pin_tilt") if name in film)
    change = angle * np.concatenate([one[:, ::-1] * [1.0, -1.0] for one in both], axis=1)
    return np.asarray(change[:, :, np.newaxis] * change[:, np.newaxis, :])


def _region_span(pixels: slice, pitch: float) -> tuple[float, float]:
    """Middle and half of the extent of the pixel centres of a region. [mm]"""
    first, last = pixels.start, pixels.stop - 1
    return 0.5 * (first + last) * pitch, 0.5 * (last - first) * pitch


def _join_larger(one: Array, two: Array) -> Array:
    """A covariance with the larger of two variances of each number."""
    both = one + two
    scale = np.sqrt(np.maximum(np.diag(one), np.diag(two)) / np.diag(both))
    return np.asarray(both * scale * scale[:, None])


def _rest_covariance(total: Array, part: Array) -> Array:
    """The total covariance less a part of it, without negative variances in any direction."""
    root = np.linalg.cholesky(part)
    inverse = np.linalg.inv(root)
    ratio, axes = np.linalg.eigh(inverse @ total @ inverse.T)
    turned = root @ axes
    return np.asarray((turned * np.maximum(ratio - 1, 0.0)) @ turned.T)


def _no_position(calibration_parameters: int) -> PinPosition:
    """NaN everywhere."""

    def unknown(count: int) -> tuple[Array, Array, Array, Array]:
        shapes = (count,), (count, count), (count, count), (count, calibration_parameters)
        value, random, surface, gradient = (np.full(shape, np.nan) for shape in shapes)
        return value, random, surface, gradient

    return PinPosition(*unknown(_PINNED), FittedNumbers(*unknown(2)))
