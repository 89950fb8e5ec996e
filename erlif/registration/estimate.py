"""Camera 2 onto camera 1: from the coarse start to the final map, for one pair of frames or many.

The method step by step: a coarse affine map, a cubic surface from binned frames, the textures
filtered by what the cameras share, a surface as fine as the data support, and windows where no
surface suffices. docs/registration.md has the reasons and the measurements.
"""

from typing import Final, NamedTuple

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.core.errors import RegistrationError
from erlif.registration.blocks import Agreement
from erlif.registration.camera_map import CameraMap
from erlif.registration.coarse import coarse_binning, find_start
from erlif.registration.drift import DriftSearch
from erlif.registration.interpolation import laid_over
from erlif.registration.matching import beyond_chance, cell_sums, coefficients_of, correlation
from erlif.registration.pairs import Pair, Pairs, PairSeries, open_series, textures
from erlif.registration.selection import (
    FINE_LADDER,
    Model,
    choose_model,
    is_unresolved,
    left_over,
    moved_to,
)
from erlif.registration.settings import RegistrationSettings
from erlif.registration.solution import (
    Solution,
    describe_surface,
    finish_map,
    fits_better,
    solve_local,
)
from erlif.registration.surface import Cells, Surface, affine_surface, equations, solve_surface
from erlif.registration.views import TextureViews, expected_rms, make_cells
from erlif.registration.whitening import make_filter, slope_gain

# Frames that are tried for the coarse alignment before it is given up.
CANDIDATES: Final = 4

# Elements from which on a surface is compared with windows: the distortion may be finer still.
FINE: Final = 16

# Standard errors by which the mean correlation coefficient of the cells must stand above 0.
BEYOND_CHANCE: Final = 8.0


def register(
    reference: AnyArray,
    moving: AnyArray,
    *,
    weight_reference: AnyArray | None = None,
    weight_moving: AnyArray | None = None,
    settings: RegistrationSettings | None = None,
) -> CameraMap:
    """Find the displacement that lays camera 2 over camera 1, from one pair of frames.

    Parameters
    ----------
    reference, moving : array, (y, x)
        Camera 1 and camera 2, counts above the dark level.
    weight_reference, weight_moving : array, (y, x), optional
        0 for pixels that must not count (bad, saturated, dust), otherwise 1.
    settings : RegistrationSettings, optional
        Defaults if missing.

    Returns
    -------
    CameraMap
        Camera-2 pixel minus camera-1 pixel of the same object point, x to the right and y down,
        with its standard deviation. [px]

    Raises
    ------
    RegistrationError
        If the frames share no texture, are mirrored or turned against the settings, or lie too far
        apart.

    Examples
    --------
    Two windows cut from one wall, camera 2 three pixels further left and two further down:

    >>> rng = np.random.default_rng(1)
    >>> wall = 1000 + 100 * rng.standard_normal((160, 192))
    >>> found = register(wall[10:-10, 10:-10], wall[12:-8, 7:-13])
    >>> bool(np.allclose(found.displacement_x[found.overlap], 3, atol=0.01))
    True
    >>> bool(np.allclose(found.displacement_y[found.overlap], -2, atol=0.01))
    True
    """
    pair = reference, moving, weight_reference, weight_moving
    return register_frames([pair], settings=settings)[0]


def register_frames(
    pairs: Pairs, *, settings: RegistrationSettings | None = None
) -> tuple[CameraMap, Array]:
    """Find the fixed map of a run and the drift of each of its frames.

    Parameters
    ----------
    pairs : sequence
        Of ``(reference, moving, weight_reference, weight_moving)`` as in `register`. It is indexed
        when a frame is needed, and may read the frame then; textures are kept, as long as they fit
        into some 300 MB.
    settings : RegistrationSettings, optional
        Defaults if missing.

    Returns
    -------
    camera_map : CameraMap
        The fixed map; the drift over all frames has mean 0 against it.
    drift : array, (frame, 2)
        Translation of camera 2 in each frame, ``(dx, dy)``, to be added to the map; NaN for a
        frame in which the cameras share no texture, such as a pulse that misfired. [px]

    Raises
    ------
    RegistrationError
        As `register`.

    Examples
    --------
    Camera 2 moves by one pixel between two frames:

    >>> rng = np.random.default_rng(1)
    >>> wall = 1000 + 100 * rng.standard_normal((160, 192))
    >>> first = (wall[10:-10, 10:-10], wall[12:-8, 7:-13], None, None)
    >>> second = (wall[10:-10, 10:-10], wall[12:-8, 6:-14], None, None)
    >>> camera_map, drift = register_frames([first, second])
    >>> np.abs(drift.round(2)).tolist(), bool(drift[1, 0] > drift[0, 0])
    ([[0.5, 0.0], [0.5, 0.0]], True)
    """
    settings = RegistrationSettings() if settings is None else settings
    frames = open_series(pairs, settings)
    number, first, surface = start_with_any(frames)
    views = TextureViews(frames, first, number=number)
    del first  # its textures are kept, so the frame itself need not be

    fit = fit_surface(views, surface)
    solution = choose_solution(views, fit)
    camera_map = finish_map(solution, views, fit.cells, fit.quality)
    if len(frames.chosen) == frames.count:
        return camera_map, views.drift

    # the map takes the mean drift of all frames, not only of those it was made from
    drift = measure_drift(frames, camera_map)
    mean = np.nanmean(drift, axis=0)
    moved = solution.moved(mean[0], mean[1])
    return finish_map(moved, views, fit.cells, fit.quality), drift - mean


def start_with_any(frames: PairSeries) -> tuple[int, Pair, Surface]:
    """Find the coarse alignment from the first of a few frames that allows it.

    Returns
    -------
    int
        Place of this frame among the chosen ones; blank frames before it do no harm.
    Pair
        The frame.
    Surface
        The displacement from images binned by two. [px]

    Raises
    ------
    RegistrationError
        That of the first frame, if none of the few can be aligned.
    """
    failures = []
    for number, pair in enumerate(frames.pick(frames.chosen[:CANDIDATES])):
        try:
            start = find_start(pair, frames.settings)
        except RegistrationError as error:
            failures.append(error)
            continue
        return number, pair, align_small(pair, start, frames.settings)
    raise failures[0]


def align_small(pair: Pair, start: Agreement, settings: RegistrationSettings) -> Surface:
    """Go from the coarse affine map to a cubic surface, binning by binning down to two.

    Parameters
    ----------
    pair : Pair
        Any frame of the run.
    start : Agreement
        Its coarse affine map.
    settings : RegistrationSettings
        Gives the side of the cells and the threads.

    Returns
    -------
    Surface
        The displacement. [px]
    """
    h, w = pair.reference.shape
    binning = coarse_binning(pair.smaller)
    surface = affine_surface((0.0, float(w), 0.0, float(h)), start.matrix, start.offset)

    # two affine and two cubic passes on the smallest images, which small frames get at full size;
    # two cubic ones at each binning between, one at the last
    degrees: tuple[int, ...] = (1, 1, 3, 3)
    while binning >= 2 or len(degrees) > 2:
        views = textures(pair, binning, settings.threads)
        spline = views.spline(settings.threads)
        shape = (views.a.shape[0], views.a.shape[1])
        for degree in degrees:
            dx, dy = surface.on_pixels(shape, binning=binning)
            b = laid_over(spline, dx, dy, (0.0, 0.0), settings.threads)
            sums = cell_sums(views.a, views.weight, b, settings.step, threads=settings.threads)
            cells = make_cells(sums, settings.step, surface, binning=binning)
            model = Model((1, 1), degree)
            system = equations(cells, model.elements, box=surface.box)
            surface = solve_surface(system, basis=model.basis)
        binning //= 2
        degrees = (3, 3) if binning > 2 else (3,)
    return surface


class MapFit(NamedTuple):
    """The surface through all chosen frames and what later steps need of it.

    Attributes
    ----------
    surface : Surface
        The displacement at zero drift. [px]
    model : Model
        The family that the data support.
    cells : Cells
        The last sums, moved to the surface.
    sums : Array
        The last sums as they were taken, (row, column, 11).
    slope : float
        See `erlif.registration.whitening.slope_gain`. [1]
    quality : float
        Correlation coefficient of the textures before the filter. [1]
    unresolved : bool
        The surface leaves distortion that no finer one resolves either.
    """

    surface: Surface
    model: Model
    cells: Cells
    sums: Array
    slope: float
    quality: float
    unresolved: bool


def fit_surface(views: TextureViews, surface: Surface) -> MapFit:
    """Find the surface that fits the frames, as fine as they support.

    Parameters
    ----------
    views : TextureViews
        The frames; their filter is set here.
    surface : Surface
        The start. [px]

    Returns
    -------
    MapFit

    Raises
    ------
    RegistrationError
        If the textures agree no better than by chance.
    """
    settings = views.settings

    # without the filter: how well the cameras agree, and at which spatial frequencies
    sums, surface, spectra = views.compare(surface)
    quality = check_correlation(sums)
    whitening = make_filter(spectra) if settings.whiten else None
    slope = slope_gain(spectra, whitening)

    # on the filtered textures of all frames: how fine the surface may be
    if whitening is not None:
        views.filter_through(whitening)
    sums, surface = views.look(surface)
    cells = views.cells(sums, surface, slope)
    model, unresolved = choose_surface(cells, settings.window)
    surface = solve_surface(equations(cells, model.elements), basis=model.basis)

    # once more from there; dust, which one camera alone sees, loses its weight
    sums, surface = views.look(surface, scale=expected_rms(sums))
    cells = views.cells(sums, surface, slope)
    system = equations(cells, model.elements, box=surface.box)
    surface = solve_surface(system, basis=model.basis)
    cells = moved_to(cells, surface)
    return MapFit(surface, model, cells, sums, slope, quality, unresolved)


def check_correlation(sums: Array) -> float:
    """Correlation coefficient of the textures, refused if it could be chance.

    Parameters
    ----------
    sums : array, (row, column, 11)
        As `cell_sums` makes them.

    Returns
    -------
    float
        Correlation coefficient over all cells. [1]

    Raises
    ------
    RegistrationError
        If the mean coefficient of the cells is within eight of its standard errors.
    """
    quality = correlation(sums)
    if not beyond_chance(coefficients_of(sums), BEYOND_CHANCE):
        raise RegistrationError(
            "No common texture found: laid over each other as well as possible, the images of the "
            f"two cameras have a correlation coefficient of {quality:.3f}, no more than chance "
            "gives. Check that both cameras see the same field in focus and in the same pulse."
        )
    return quality


def choose_surface(cells: Cells, window: float) -> tuple[Model, bool]:
    """Choose the model of the surface.

    Parameters
    ----------
    cells : Cells
        The sums over all chosen frames.
    window : float
        Side of the windows that may take its place. [px]

    Returns
    -------
    model : Model
        One of the coarse ladder, or of the fine one where those leave a displacement.
    unresolved : bool
        Whether it leaves distortion that none of the models resolves and that windows would follow
        better.
    """
    model = choose_model(cells)
    if left_over(_left_by(cells, model)) < 1:
        return model, False

    finer = choose_model(cells, FINE_LADDER, model)
    return finer, is_unresolved(_left_by(cells, finer), window)


def _left_by(cells: Cells, model: Model) -> Cells:
    """The cells moved to the best surface of a model."""
    return moved_to(cells, solve_surface(equations(cells, model.elements), basis=model.basis))


def choose_solution(views: TextureViews, fit: MapFit) -> Solution:
    """Take the surface, or one displacement for each window where the surface does not suffice.

    ``model = "auto"`` of the settings tries windows where the surface leaves distortion, and
    compares them with a fine surface.
    """
    settings = views.settings
    surface = describe_surface(fit.cells, fit.surface, fit.model, views.shape)
    doubtful = fit.unresolved or max(fit.model.elements) >= FINE
    if settings.model == "surface" or (settings.model == "auto" and not doubtful):
        return surface

    windows = solve_local(views, fit.surface, fit.slope, expected_rms(fit.sums))
    if settings.model == "local" or fit.unresolved or fits_better(views, windows, surface):
        return windows
    return surface


def measure_drift(frames: PairSeries, camera_map: CameraMap) -> Array:
    """Drift (frame, 2) of all frames against a map, x first; NaN without common texture. [px]"""
    search = DriftSearch.of(camera_map.displacement_x, camera_map.displacement_y)
    drift, threads = np.empty((frames.count, 2)), frames.settings.threads
    for number, pair in enumerate(frames.pick(range(frames.count))):
        one = search.find(textures(pair, search.binning, threads), threads=threads)
        drift[number] = one.dx, one.dy
    return drift
