"""Camera 2 onto camera 1: from the coarse start to the final map, for one pair of frames or for many together.

The rig is fixed, so one map serves a run: the cell sums of many frames are added up and solved as if they were one
frame, each frame read at its own drift.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numba import njit
from scipy import ndimage

from erlif.core.arrays import AnyArray
from erlif.core.errors import RegistrationError
from erlif.registration import local
from erlif.registration.camera_map import CameraMap, MapKind
from erlif.registration.coarse import Start, coarse_binning, find_start
from erlif.registration.drift import follow_drift
from erlif.registration.matching import (
    AB,
    EE,
    WEIGHT,
    cell_centres,
    cell_sums,
    correlation,
    merge_cells,
    move_sums,
    solve_shift,
    without_noise,
)
from erlif.registration.pairs import Frames, Pair, Pairs, Textures, laid_over, open_frames, textures
from erlif.registration.selection import (
    FINE_LADDER,
    Model,
    choose_model,
    left_over,
    moved_to,
)
from erlif.registration.settings import RegistrationSettings
from erlif.registration.surface import (
    Cells,
    Surface,
    bilinear,
    cell_weights,
    equations,
    solve_surface,
)
from erlif.registration.uncertainty import surface_covariance, surface_std
from erlif.registration.whitening import (
    Filter,
    Spectra,
    make_filter,
    measure_spectra,
    padded_size,
    slope_gain,
    whiten,
)

CUBIC: Final = Model((1, 1), 3)
BEYOND: Final = 8.0
"""How far beyond the frame of camera 2 the displacement is still given, for frames that drift. [px]"""
UNRESOLVED: Final = 2.0
"""What the best surface leaves, in units of what makes finer ones worth a trial, from which on windows take over."""
POOR_STD: Final = 0.25
"""Standard deviation of the displacement from which on a pixel counts as poorly registered. [px]"""
FINE: Final = 16
"""Elements from which on a surface is set against windows: distortion that asks for so many may ask for more."""
POOR_RESIDUAL: Final = 0.3
"""Displacement that a neighbourhood still asks for, from which on it counts as poorly registered. [px]"""


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
        Ordinary ones if missing.

    Raises
    ------
    RegistrationError
        If the frames share no texture, are mirrored or turned against the settings, or lie too far apart.
    """
    settings = RegistrationSettings() if settings is None else settings
    found, _ = register_frames(
        [(reference, moving, weight_reference, weight_moving)], settings=settings
    )
    return found


def register_frames(
    pairs: Pairs, *, settings: RegistrationSettings | None = None
) -> tuple[CameraMap, AnyArray]:
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
        Translation of camera 2 in each frame, ``(dx, dy)``, to be added to the map; NaN for a frame in which the
        cameras share no texture, such as a pulse that misfired. [px]

    Raises
    ------
    RegistrationError
        If the frames share no texture, are mirrored or turned against the settings, or lie too far apart.
    """
    settings = RegistrationSettings() if settings is None else settings
    frames = open_frames(pairs, settings)
    first, surface = start_with_any(frames)
    views = Views(frames, first, settings)

    # as the cameras see it: how well they agree, and at which spatial frequencies
    seen = views.look(surface)
    surface = seen.surface
    quality = check_correlation(seen.sums)
    whitening = make_filter(seen.spectra) if settings.whiten else None
    slope = slope_gain(seen.spectra, whitening)

    # on the filtered textures: how fine the surface may be
    if whitening is not None:
        views.whitening = whitening
        seen = views.look(surface)
        surface = seen.surface
    cells = views.cells(seen.sums, surface, slope)
    model, unresolved = choose_surface(cells)
    surface = solve_surface(equations(cells, model.elements), basis=model.basis)

    # once more from there, with what one camera alone sees taken out
    seen = views.look(surface, scale=expected_rms(seen.sums))
    cells = views.cells(seen.sums, seen.surface, slope)
    surface = solve_surface(equations(cells, model.elements, box=surface.box), basis=model.basis)
    cells = moved_to(cells, surface)
    solution = describe_surface(cells, surface, model, views.shape)
    if settings.model == "local" or (
        settings.model == "auto" and (unresolved or max(model.elements) >= FINE)
    ):
        windows = solve_local(views, surface, slope, expected_rms(seen.sums))
        if settings.model == "local" or unresolved or fits_better(views, windows, solution):
            solution = windows
    camera_map = finish_map(solution, views, cells, quality)
    if frames.count == 1:
        return camera_map, np.zeros((1, 2))
    drift = np.empty((frames.count, 2))
    for number, pair in enumerate(frames.pick(range(frames.count))):
        found = follow_drift(
            camera_map.displacement_x, camera_map.displacement_y, pair, threads=settings.threads
        )
        drift[number] = found.dx, found.dy
    mean = np.nanmean(drift, axis=0)
    moved = replace(
        solution, dx=solution.dx + np.float32(mean[0]), dy=solution.dy + np.float32(mean[1])
    )
    return finish_map(moved, views, cells, quality), drift - mean


def start_with_any(frames: Frames) -> tuple[Pair, Surface]:
    """Find the coarse alignment from the first of a few frames that allows it; a single blank frame does no harm."""
    failure: RegistrationError | None = None
    for pair in frames.pick(frames.chosen[:4]):
        try:
            start = find_start(
                pair.reference,
                pair.moving,
                pair.weight_reference,
                pair.weight_moving,
                frames.settings,
            )
        except RegistrationError as error:
            failure = failure or error
            continue
        return pair, align_small(pair, start, frames.settings)
    assert failure is not None
    raise failure


def align_small(pair: Pair, start: Start, settings: RegistrationSettings) -> Surface:
    """Go from the coarse affine map to a cubic surface at a binning of two, level by level. [px]"""
    h, w = pair.reference.shape
    binning = coarse_binning((min(h, pair.moving.shape[0]), min(w, pair.moving.shape[1])))
    surface = start.surface((0.0, float(w), 0.0, float(h)))
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
            surface = solve_surface(
                equations(cells, (1, 1), box=surface.box), basis=Model((1, 1), degree).basis
            )
        binning //= 2
        degrees = (3, 3) if binning > 2 else (3,)
    return surface


def make_cells(sums: AnyArray, step: int, surface: Surface, *, binning: int = 1) -> Cells:
    """Attach to cell sums where they were taken. ``step`` is in binned pixels; the result is in full ones."""
    rows, cols = sums.shape[:2]
    centre = (binning - 1) / 2
    x = cell_centres(cols * step, step) * binning + centre
    y = cell_centres(rows * step, step) * binning + centre
    scaled = sums.copy()
    scaled[..., :3] /= binning**2
    scaled[..., 3:5] /= binning
    here_x, here_y = surface.evaluate(x, y)
    weight = cell_weights(scaled)
    if not (weight > 0).sum() >= 16:
        raise RegistrationError(
            "Too little is left where both cameras have light and sound pixels: registration needs 16 cells of "
            f"{step} px, got {(weight > 0).sum()}. Check the masks, the exposure and the regions of interest."
        )
    return Cells(scaled, x, y, here_x, here_y, weight)


def expected_rms(sums: AnyArray) -> AnyArray:
    """Rms difference of the textures to be expected in each cell: the median over its surroundings."""
    merged = merge_cells(sums, 2)
    n = merged[..., WEIGHT]
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.where(n > 0, merged[..., EE] / n, 0)
    rms = np.sqrt(ndimage.median_filter(mean, 3, mode="nearest"))
    rms = np.repeat(np.repeat(rms, 2, axis=0), 2, axis=1)
    return np.asarray(rms[: sums.shape[0], : sums.shape[1]])


@dataclass(frozen=True)
class Seen:
    """Everything summed over the chosen frames at one displacement."""

    sums: AnyArray
    """(row, column, 11)"""
    spectra: Spectra
    surface: Surface
    """Where the sums hold: the surface looked at, plus the mean drift found meanwhile."""


class Views:
    """The frames from which the map is made, at full resolution, and the drift of each.

    One pair alone is kept in memory; of several, each is read, prepared and dropped again in every pass.
    """

    def __init__(self, frames: Frames, first: Pair, settings: RegistrationSettings) -> None:
        self.frames = frames
        self.settings = settings
        self.shape = (first.reference.shape[0], first.reference.shape[1])
        self.shape_moving = (first.moving.shape[0], first.moving.shape[1])
        self.drift = np.zeros((len(frames.chosen), 2))
        self._single = textures(first, 1, settings.threads) if frames.count == 1 else None
        self._drift_known = frames.count == 1
        self._whitening: Filter | None = None
        self.merge = 2 if min(self.shape) >= 400 else 1

    @property
    def whitening(self) -> Filter | None:
        """The filter through which the textures are seen."""
        return self._whitening

    @whitening.setter
    def whitening(self, chosen: Filter) -> None:
        self._whitening = chosen
        if self._single is not None:
            self._single = self._filtered(self._single)

    def _filtered(self, plain: Textures) -> Textures:
        assert self._whitening is not None
        grid = self._whitening.on_grid(padded_size(plain.a.shape))
        a, wa = whiten(plain.a, plain.weight, grid, threads=self.settings.threads)
        if plain.b.shape != plain.a.shape:
            grid = self._whitening.on_grid(padded_size(plain.b.shape))
        b, wb = whiten(plain.b, plain.weight_b, grid, threads=self.settings.threads)
        return Textures(a, wa, b, wb)

    def _each(self, dx: AnyArray, dy: AnyArray) -> Iterator[tuple[int, Textures]]:
        if self._single is not None:
            yield 0, self._single
            return
        for number, pair in enumerate(self.frames.pick(self.frames.chosen)):
            if not self._drift_known:
                found = follow_drift(dx, dy, pair, threads=self.settings.threads)
                self.drift[number] = found.dx, found.dy
            if np.isnan(self.drift[number]).any():
                continue
            plain = textures(pair, 1, self.settings.threads)
            yield number, plain if self._whitening is None else self._filtered(plain)
        self._drift_known = True

    def sums(
        self, dx: AnyArray, dy: AnyArray, scale: AnyArray | None
    ) -> tuple[AnyArray, Spectra | None, AnyArray]:
        """Sums over the frames at a dense displacement, spectra if not filtered yet, and the mean drift (dx, dy) by
        which the displacement must be moved for the sums to hold."""
        total: AnyArray | None = None
        spectra: Spectra | None = None
        threads = self.settings.threads
        for number, view in self._each(dx, dy):
            here = (float(self.drift[number, 0]), float(self.drift[number, 1]))
            b = laid_over(view.spline(threads), dx, dy, here, threads)
            sums = cell_sums(
                view.a, view.weight, b, self.settings.step, scale=scale, threads=threads
            )
            if self._whitening is None:
                one = measure_spectra(view.a, view.weight, b)
                spectra = one if spectra is None else spectra + one
            if self.frames.count > 1:
                shift = solve_shift(sums)
                self.drift[number] += shift
                sums = move_sums(sums, *shift)
            total = sums if total is None else total + sums
        if total is None:
            raise RegistrationError(
                f"None of the {len(self.frames.chosen)} frames from which the map is to be made shows texture that both "
                "cameras share. Check the exposure, the focus and that the frames of the two cameras belong together."
            )
        mean = np.nanmean(self.drift, axis=0)
        self.drift -= mean
        return total, spectra, mean

    def look(self, surface: Surface, *, scale: AnyArray | None = None) -> Seen:
        """Go through the frames once with camera 2 laid over camera 1 by the surface and each frame's drift."""
        dx, dy = surface.on_pixels(self.shape)
        total, spectra, mean = self.sums(dx, dy, scale)
        if spectra is None:
            spectra = Spectra(np.zeros((1, 1)), np.zeros((1, 1)), np.zeros((1, 1)), 0)
        return Seen(total, spectra, surface.moved(float(mean[0]), float(mean[1])))

    def cells(self, sums: AnyArray, surface: Surface, slope: float) -> Cells:
        """The cells from which a surface is made."""
        return make_cells(
            without_noise(merge_cells(sums, self.merge), slope),
            self.settings.step * self.merge,
            surface,
        )


def check_correlation(sums: AnyArray) -> float:
    """Correlation coefficient of the textures, refused if it could be chance.

    Raises
    ------
    RegistrationError
        If the mean product of the textures is within eight of its own standard errors over the cells.
    """
    products = sums[..., AB][sums[..., WEIGHT] > 0]
    quality = correlation(sums)
    if products.size < 16 or not products.mean() > 8 * products.std() / np.sqrt(products.size):
        raise RegistrationError(
            "No common texture found: laid over each other as well as possible, the images of the two cameras have a "
            f"correlation coefficient of {quality:.3f}, no more than chance gives. Check that both cameras see the "
            "same field in focus and in the same pulse."
        )
    return quality


def fits_better(views: Views, windows: "Solution", surface: "Solution") -> bool:
    """Whether windows leave clearly less difference between the textures than a fine surface does.

    Distortion finer than the surface shows in the difference, whatever its scale. Windows always take off a little noise with it,
    some per cent at 32 px; more than a tenth is distortion.
    """
    left = []
    for solution in (windows, surface):
        sums, _, _ = views.sums(solution.dx, solution.dy, None)
        left.append(float(sums[..., EE].sum()) / float(sums[..., WEIGHT].sum()))
    return left[0] < 0.9 * left[1]


def choose_surface(cells: Cells) -> tuple[Model, bool]:
    """The model for the surface, and whether it leaves distortion that none of the models resolves."""
    model = choose_model(cells)
    rest = moved_to(cells, solve_surface(equations(cells, model.elements), basis=model.basis))
    if left_over(rest) < 1:
        return model, False
    finer = choose_model(cells, FINE_LADDER, model)
    if finer != model:
        rest = moved_to(cells, solve_surface(equations(cells, finer.elements), basis=finer.basis))
    return finer, left_over(rest) > UNRESOLVED


@dataclass(frozen=True)
class Solution:
    """A dense displacement with its standard deviation, on every pixel of camera 1. [px]"""

    dx: AnyArray
    dy: AnyArray
    std: AnyArray
    kind: MapKind
    resolution: str


def describe_surface(
    cells: Cells, surface: Surface, model: Model, shape: tuple[int, int]
) -> Solution:
    """The surface on every pixel, with the uncertainty of its coefficients carried along."""
    covariance = surface_covariance(cells, model, surface.box)
    x, y = np.linspace(0, shape[1] - 1, 81), np.linspace(0, shape[0] - 1, 65)
    std = surface_std(covariance, model, surface.box, x, y)
    zoom = ((shape[0] - 1) / 64, (shape[1] - 1) / 80)
    row, column = (
        np.arange(n, dtype=np.float32) / np.float32(z) for n, z in zip(shape, zoom, strict=True)
    )
    std = bilinear(std.astype(np.float32), row, column)
    dx, dy = surface.on_pixels(shape)
    return Solution(dx, dy, std, MapKind.SURFACE, str(model))


def solve_local(views: Views, surface: Surface, slope: float, scale: AnyArray) -> Solution:
    """One displacement for each window, in passes that start from the surface."""
    settings = views.settings
    sigma = local.window_sigma(settings.window, settings.step)
    base_x, base_y = surface.on_pixels(views.shape)
    y, x = (cell_centres(n, settings.step) for n in views.shape)
    field = np.zeros((2, len(y), len(x)))
    dx, dy = base_x, base_y
    sums = np.zeros(0)
    for number in range(settings.passes + 1):
        sums, _, mean = views.sums(dx, dy, scale)
        field += mean.reshape(2, 1, 1)
        sums = without_noise(sums, slope)
        if number == settings.passes:
            break
        step, _, sound = local.solve_windows(sums, sigma)
        field = field + np.clip(step, -local.LARGEST_STEP, local.LARGEST_STEP)
        field = local.replace_outliers(field, sound)
        if number < settings.passes - 1:
            field = local.smooth(field)
        dx = base_x + local.to_pixels(field[0], y, x, views.shape)
        dy = base_y + local.to_pixels(field[1], y, x, views.shape)
    std = local.window_std(sums, sigma, settings.passes)
    std = np.minimum(std, 1e3)
    return Solution(
        base_x + local.to_pixels(field[0], y, x, views.shape),
        base_y + local.to_pixels(field[1], y, x, views.shape),
        np.maximum(local.to_pixels(std, y, x, views.shape), np.float32(std.min())),
        MapKind.LOCAL,
        f"{settings.window} px",
    )


def finish_map(solution: Solution, views: Views, cells: Cells, quality: float) -> CameraMap:
    """Mark what camera 2 does not see and what is not good enough; refuse a map that is mostly not.

    Raises
    ------
    RegistrationError
        If most of the overlap is poorly registered.
    """
    h, w = views.shape
    height, width = views.shape_moving
    dx, dy, std = solution.dx.copy(), solution.dy.copy(), solution.std.copy()
    overlap = np.empty((h, w), np.bool_)
    _find_overlap(dx, dy, std, height, width, overlap)
    poor = std > POOR_STD
    if solution.kind is MapKind.SURFACE:
        pitch = round(float(cells.x[1] - cells.x[0]))
        off = local.still_off(cells.sums * cells.weight[..., None], pitch, tolerance=POOR_RESIDUAL)
        row = np.minimum(np.arange(h) // pitch, len(cells.y) - 1)
        column = np.minimum(np.arange(w) // pitch, len(cells.x) - 1)
        poor |= off[np.ix_(row, column)]
    if not overlap.any() or poor[overlap].mean() > 0.5:
        part = float(poor[overlap].mean()) if overlap.any() else 1.0
        raise RegistrationError(
            f"The cameras could not be laid over each other: {part:.0%} of their common field is uncertain by more "
            f"than {POOR_STD} px or does not agree with its neighbourhood. Give more frames, more light or a wall "
            "with more texture, and check the focus."
        )
    kind, resolution = solution.kind, solution.resolution
    return CameraMap(dx, dy, std, overlap, poor, quality, kind, resolution, views.settings)


@njit(nogil=True, cache=True, error_model="numpy")
def _find_overlap(
    dx: AnyArray, dy: AnyArray, std: AnyArray, height: int, width: int, overlap: AnyArray
) -> None:
    """Mark the pixels whose point camera 2 sees; NaN into the fields far beyond its frame."""
    for y in range(dx.shape[0]):
        for x in range(dx.shape[1]):
            px = x + dx[y, x]
            py = y + dy[y, x]
            beyond = max(max(-px, px - (width - 1)), max(-py, py - (height - 1)))
            overlap[y, x] = beyond <= 0
            if not beyond <= BEYOND:
                dx[y, x] = np.nan
                dy[y, x] = np.nan
                std[y, x] = np.nan
