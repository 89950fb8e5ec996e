"""Camera 2 onto camera 1: from the coarse start to the final map, for one pair of frames or for many together.

The rig is fixed, so one map serves a run: the cell sums of many frames are added up and solved as if they were one
frame, each frame read at its own drift.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from erlif.core.errors import RegistrationError
from erlif.registration.camera_map import CameraMap
from erlif.registration.coarse import Start, coarse_binning, find_start
from erlif.registration.drift import follow_drift
from erlif.registration.matching import (
    EE,
    WEIGHT,
    cell_centres,
    cell_sums,
    correlation,
    merge_cells,
    move_sums,
    solve_shift,
)
from erlif.registration.pairs import Pair, Textures, laid_over, make_pair, textures
from erlif.registration.selection import Model, choose_model
from erlif.registration.settings import RegistrationSettings
from erlif.registration.surface import Cells, Surface, cell_weights, equations, solve_surface
from erlif.registration.uncertainty import surface_covariance, surface_std
from erlif.registration.whitening import Filter, Spectra, make_filter, measure_spectra, whiten

Array = NDArray[Any]
PairOfArrays = tuple[Array, Array, Array | None, Array | None]
Pairs = Sequence[PairOfArrays] | Callable[[], Iterable[PairOfArrays]]

CUBIC: Final = Model((1, 1), 3)
BEYOND: Final = 8.0
"""How far beyond the frame of camera 2 the displacement is still given, for frames that drift. [px]"""


def make_cells(sums: Array, step: int, surface: Surface, *, binning: int = 1) -> Cells:
    """Attach to cell sums where they were taken. ``step`` is in binned pixels; the result is in full ones."""
    rows, cols = sums.shape[:2]
    centre = (binning - 1) / 2
    x = cell_centres(cols * step, step) * binning + centre
    y = cell_centres(rows * step, step) * binning + centre
    scaled = sums.copy()
    scaled[..., :3] /= binning**2
    scaled[..., 3:5] /= binning
    here_x, here_y = surface.evaluate(x, y)
    return Cells(scaled, x, y, here_x, here_y, cell_weights(scaled))


def expected_rms(sums: Array) -> Array:
    """Rms difference of the textures to be expected in each cell: the median over its surroundings."""
    n = sums[..., WEIGHT]
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.where(n > 0, sums[..., EE] / n, 0)
    return np.asarray(np.sqrt(ndimage.median_filter(mean, 5, mode="nearest")))


def align_small(pair: Pair, start: Start, settings: RegistrationSettings) -> Surface:
    """Go from the coarse affine map to a cubic surface at a binning of two, level by level. [px]"""
    h, w = pair.reference.shape
    binning = coarse_binning((min(h, pair.moving.shape[0]), min(w, pair.moving.shape[1])))
    surface = start.surface((0.0, float(w), 0.0, float(h)))
    degrees: tuple[int, ...] = (1, 1, 3, 3)
    while binning >= 2 or len(degrees) == 4:
        views = textures(pair, binning, settings.threads)
        spline = views.spline(settings.threads)
        shape = (views.a.shape[0], views.a.shape[1])
        for degree in degrees:
            dx, dy = surface.on_pixels(shape, binning=binning)
            b = laid_over(spline, dx, dy, (0.0, 0.0), settings.threads)
            sums = cell_sums(views.a, views.weight, b, settings.step, threads=settings.threads)
            cells = make_cells(sums, settings.step, surface, binning=binning)
            system = equations(cells, (1, 1), box=surface.box)
            surface = solve_surface(system, basis=Model((1, 1), degree).basis)
        degrees = (3, 3)
        binning //= 2
    return surface


@dataclass(frozen=True)
class Frames:
    """Frames that can be gone through again and again, one pair in memory at a time."""

    source: Pairs
    count: int
    chosen: tuple[int, ...]
    """Those from which the map is made."""
    settings: RegistrationSettings

    def pick(self, wanted: Sequence[int]) -> Iterator[Pair]:
        """Read the pairs with these numbers, which must ascend."""
        if callable(self.source):
            keep = set(wanted)
            for number, pair in enumerate(self.source()):
                if number in keep:
                    yield make_pair(*pair, self.settings)
        else:
            for number in wanted:
                yield make_pair(*self.source[number], self.settings)


def open_frames(source: Pairs, settings: RegistrationSettings) -> Frames:
    """Count the frames and choose those for the map, evenly spaced."""
    count = sum(1 for _ in source()) if callable(source) else len(source)
    if count == 0:
        raise RegistrationError("Registration needs at least one pair of frames, got none.")
    most = min(count, settings.frames_for_map)
    chosen = tuple(sorted({round((i + 0.5) * count / most - 0.5) for i in range(most)}))
    return Frames(source, count, chosen, settings)


def register(
    reference: Array,
    moving: Array,
    *,
    weight_reference: Array | None = None,
    weight_moving: Array | None = None,
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
        Ordinary ones if missing.

    Raises
    ------
    RegistrationError
        If the frames share no texture, are mirrored or turned against the settings, or lie too far apart.
    """
    settings = RegistrationSettings() if settings is None else settings
    found, _ = register_frames([(reference, moving, weight_reference, weight_moving)], settings=settings)
    return found


def register_frames(pairs: Pairs, *, settings: RegistrationSettings | None = None) -> tuple[CameraMap, Array]:
    """Find the fixed map of a run and the drift of each of its frames.

    Parameters
    ----------
    pairs : sequence, or callable that gives a fresh iterable
        Of ``(reference, moving, weight_reference, weight_moving)`` as in `register`. Frames are read when they are
        needed and not kept; a sequence is indexed, a callable is gone through several times.
    settings : RegistrationSettings, optional
        Ordinary ones if missing.

    Returns
    -------
    camera_map : CameraMap
        The fixed map; the drift over all frames has mean 0 against it.
    drift : array, (frame, 2)
        Translation of camera 2 in each frame, ``(dx, dy)``, to be added to the map. [px]

    Raises
    ------
    RegistrationError
        If the frames share no texture, are mirrored or turned against the settings, or lie too far apart.
    """
    settings = RegistrationSettings() if settings is None else settings
    frames = open_frames(pairs, settings)
    first = next(frames.pick(frames.chosen[:1]))
    start = find_start(first.reference, first.moving, first.weight_reference, first.weight_moving, settings)
    surface = align_small(first, start, settings)
    return _finish(frames, first, surface, settings)


def _finish(frames: Frames, first: Pair, surface: Surface, settings: RegistrationSettings) -> tuple[CameraMap, Array]:
    """Full resolution: whiten, choose how fine the surface may be, solve, and say how good it is."""
    single = frames.count == 1
    cached = textures(first, 1, settings.threads) if single else None
    shape = (first.reference.shape[0], first.reference.shape[1])
    drift = np.zeros((len(frames.chosen), 2))
    step = settings.step
    merge = 2 if min(shape) >= 400 else 1
    box = surface.box
    model = CUBIC
    whitening: Filter | None = None
    quality = 0.0
    scale: Array | None = None
    cells = None
    for stage in ("plain", "choose", "final"):
        total: Array | None = None
        spectra: Spectra | None = None
        dx, dy = surface.on_pixels(shape)
        for number, pair in enumerate([first] if single else frames.pick(frames.chosen)):
            if stage == "plain" and not single:
                known = follow_drift(dx, dy, pair, threads=settings.threads)
                drift[number] = known.dx, known.dy
            views = cached if cached is not None else textures(pair, 1, settings.threads)
            if whitening is not None:
                views = _whitened(views, whitening, settings.threads)
                cached = views if single else None
            b = laid_over(views.spline(settings.threads), dx, dy, tuple(drift[number]), settings.threads)
            sums = cell_sums(views.a, views.weight, b, step, scale=scale, threads=settings.threads)
            if stage == "plain" and settings.whiten:
                here = measure_spectra(views.a, views.weight, b)
                spectra = here if spectra is None else spectra + here
            if not single:
                shift = solve_shift(sums)
                drift[number] += shift
                sums = move_sums(sums, *shift)
            total = sums if total is None else total + sums
        assert total is not None
        if single and whitening is not None:
            whitening = None  # the textures in memory are filtered already
        if not single:
            surface = surface.moved(*drift.mean(0))
            drift -= drift.mean(0)
        if stage == "plain":
            quality = correlation(total)
            if spectra is not None:
                whitening = make_filter(spectra)
        scale = expected_rms(total) if stage != "plain" or whitening is None else None
        cells = make_cells(merge_cells(total, merge), step * merge, surface)
        if stage == "choose":
            model = choose_model(cells)
            box = cells.box
        surface = solve_surface(equations(cells, model.elements, box=box), basis=model.basis)
    assert cells is not None
    camera_map = _surface_map(
        cells, surface, model, shape, (first.moving.shape[0], first.moving.shape[1]), quality, settings
    )
    if single:
        return camera_map, np.zeros((1, 2))
    found = np.empty((frames.count, 2))
    for number, pair in enumerate(frames.pick(range(frames.count))):
        one = follow_drift(camera_map.displacement_x, camera_map.displacement_y, pair, threads=settings.threads)
        found[number] = one.dx, one.dy
    mean = found.mean(0)
    moved = surface.moved(*mean)
    camera_map = _surface_map(
        cells, moved, model, shape, (first.moving.shape[0], first.moving.shape[1]), quality, settings
    )
    return camera_map, found - mean


def _whitened(views: Textures, whitening: Filter, threads: int) -> Textures:
    grid = whitening.on_grid((views.a.shape[0], views.a.shape[1]))
    a, wa = whiten(views.a, views.weight, grid, threads=threads)
    if views.b.shape != views.a.shape:
        grid = whitening.on_grid((views.b.shape[0], views.b.shape[1]))
    b, wb = whiten(views.b, views.weight_b, grid, threads=threads)
    return Textures(a, wa, b, wb)


def _surface_map(
    cells: Cells,
    surface: Surface,
    model: Model,
    shape: tuple[int, int],
    other: tuple[int, int],
    quality: float,
    settings: RegistrationSettings,
) -> CameraMap:
    dx, dy = surface.evaluate(cells.x, cells.y)
    residual = Cells(
        move_sums(cells.sums, dx - cells.here_x, dy - cells.here_y), cells.x, cells.y, dx, dy, cells.weight
    )
    covariance = surface_covariance(residual, model, surface.box)
    x, y = np.linspace(0, shape[1] - 1, 81), np.linspace(0, shape[0] - 1, 65)
    coarse = surface_std(covariance, model, surface.box, x, y)
    std = _bilinear(coarse, shape)
    displacement_x, displacement_y = surface.on_pixels(shape)
    px = np.arange(shape[1], dtype=np.float32)[None, :] + displacement_x
    py = np.arange(shape[0], dtype=np.float32)[:, None] + displacement_y
    overlap = (px >= 0) & (px <= other[1] - 1) & (py >= 0) & (py <= other[0] - 1)
    far = (px < -BEYOND) | (px > other[1] - 1 + BEYOND) | (py < -BEYOND) | (py > other[0] - 1 + BEYOND)
    for field in (displacement_x, displacement_y, std):
        field[far] = np.nan
    return CameraMap(displacement_x, displacement_y, std, overlap, std > 0.25, quality, str(model), settings)


def _bilinear(coarse: Array, shape: tuple[int, int]) -> Array:
    """Interpolate values on an equidistant grid over the frame, corners included, to every pixel; float32."""

    def matrix(n: int, size: int) -> Array:
        t = np.linspace(0, n - 1, size)
        i = np.minimum(t.astype(int), n - 2)
        m = np.zeros((size, n), np.float32)
        m[np.arange(size), i] = 1 - (t - i)
        m[np.arange(size), i + 1] = t - i
        return m

    return np.asarray(
        matrix(coarse.shape[0], shape[0]) @ coarse.astype(np.float32) @ matrix(coarse.shape[1], shape[1]).T
    )
