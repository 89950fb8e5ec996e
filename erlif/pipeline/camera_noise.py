"""Gain, read noise and response spread of cameras of which nothing was given, from the frames themselves.

Both cameras photograph one speckle pattern, so it cancels in the logarithm of their ratio, and what is left there from pixel to
pixel is mostly noise. Differences between frames cancel what stays in its place as well: film, pixel response, marks. Their
variance follows the light as a camera's noise must, which is the photon transfer of Poisson and Gauss (Foi et al., IEEE Trans.
Image Process. 17 (2008) 1737) with a scene that need not be flat.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import cv2
import numpy as np
import numpy.typing as npt
from scipy.optimize import nnls
from scipy.signal import convolve2d, correlate2d

from erlif.core.arrays import Array, Mask
from erlif.core.detector import QUANTISATION_VAR
from erlif.core.errors import FrameError
from erlif.core.products import CorrectedFrames, References
from erlif.correction import CameraNoise, correct_frames, measure_references
from erlif.ingest import read_frames
from erlif.pipeline.chain import Chain, measure_blur, one_thread_per_frame, some_frames
from erlif.ratio.log_ratio import compute_ratio
from erlif.registration import align_frames, interpolation_variance_factor

_CELL, _CELLS = 8, 4000  # least size of a cell [px], and about how many there are in a large frame


_LEAST_FILLING = 0.25  # share of its pixels that a cell needs
_BLOCKS = 6  # blocks along each axis, whose scatter gives the standard deviations
_UNLIKE = 0.05  # how probable two cameras of unlike gain are beforehand
_UNLIKENESS = 0.4  # by how much of themselves such gains differ
_FREEDOM = 10  # degrees of freedom of a standard deviation found from the blocks
_WORST = 0.3  # relative standard deviation of a gain that is still an answer
_STILL = (
    1e-3  # share of a pattern in the variance of differences that a drift of about 0.01 px leaves
)


_SHARP, _VAGUE = (
    0.005**2,
    0.01**2,
)  # std of the response's variance: an answer though it be zero, and none at all [1]


_RING = np.zeros(
    (5, 5)
)  # a pixel less the mean of the eight two pixels off: takes off a tilted film
_RING[::2, ::2] = -1 / 8
_RING[2, 2] = 1


def complete_noise(chain: Chain) -> Chain:
    """Estimate what neither settings nor darks and flats tell of gain and noise, from the frames of the recording.

    The chain needs a gain to know its noise, so it begins with a guess and takes a few turns. Without a flat the pixels' unequal
    response stays in the ratio; how unequal camera 2's pixels are, and camera 1's like them, becomes part of the variance. Only a
    drift of camera 2 tells that: of cameras that stand still it is left out, and the notes say so. Two open gains are taken to be
    the same by as much as is probable; where both read noises are open, one dark variance is fitted, and one read noise [DN] for
    both.

    Parameters
    ----------
    chain : Chain

    Returns
    -------
    Chain
        The same where everything was known; else with references, and blur difference, that go with the estimate. Its notes say what
        was estimated and what was assumed.

    Raises
    ------
    FrameError
        If the frames do not tell the gain or the read noise either.
    """
    wanted = _Open(
        *(~chain.references[name].values for name in ("gain_known", "read_noise_known", "has_flat"))
    )
    if not wanted.any:
        return chain
    before = np.zeros((2, 2))
    for _ in range(5):
        found = _estimate(chain, wanted)
        if found is None:
            return chain
        estimate = found
        chain = replace(
            chain, references=measure_references(chain.recording, estimated=estimate.cameras)
        )
        chain = replace(chain, blur=measure_blur(chain))
        now = np.nan_to_num([[noise.gain, noise.response_spread] for noise in estimate.cameras])
        if np.all(np.abs(now - before) <= 5e-3 * now):
            break
        before = now
    return replace(chain, references=_say(chain.references, estimate, wanted))


@dataclass(frozen=True)
class _Open:
    """What is to be estimated, camera by camera."""

    gain: Mask
    read_noise: Mask
    response: Mask

    @property
    def noise(self) -> Mask:
        """Cameras whose gain or read noise is open."""
        return np.asarray(self.gain | self.read_noise)

    @property
    def any(self) -> bool:
        """Whether frames are to be looked at; they tell nothing of the response of camera 1 alone."""
        return bool(self.noise.any() or self.response[1])


@dataclass(frozen=True)
class _Estimate:
    cameras: tuple[CameraNoise, CameraNoise]
    alike: float
    """Probability that both cameras have one gain, where both were open."""
    frames: int


def _say(references: References, estimate: _Estimate, wanted: _Open) -> References:
    said = []
    for camera, noise in enumerate(estimate.cameras):
        if wanted.noise[camera]:
            what = " and ".join(
                ["gain"] * int(wanted.gain[camera])
                + ["read noise"] * int(wanted.read_noise[camera])
            )
            assumed = ["shot noise"]
            if wanted.gain[camera] and not np.isnan(estimate.alike):
                assumed.append(
                    f"gains of both cameras that are the same with a probability of {estimate.alike:.2f}"
                )
            if wanted.read_noise.all():
                assumed.append("one read noise [DN] for both")
            relative = (
                f", the gain to {100 * noise.gain_std / noise.gain:.0f} %"
                if wanted.gain[camera]
                else ""
            )
            said.append(
                f"camera{camera + 1}: {what} estimated from the noise that {estimate.frames} frames of the two cameras do not have in "
                f"common{relative}, assuming {' and '.join(assumed)}; give them, or record darks and flats, for something better"
            )
    if wanted.response[1]:
        cameras = "both cameras" if wanted.response[0] else "camera 2"
        spread = estimate.cameras[1].response_spread
        said.append(
            f"how pixels of {cameras} differ is not known, for the cameras did not move, or hardly, against each other; for want of a flat, "
            "pixel response is neither corrected nor counted"
            if np.isnan(spread)
            else f"pixels of {cameras} differ by {100 * spread:.1f} %, as the drift of camera 2 shows; for want of a flat this is counted as "
            "noise"
        )
    attributes = {
        kind: "\n".join(filter(None, [references.attrs[kind], *said]))
        for kind in ("notes", "warnings")
    }
    return References(references.assign_attrs(attributes))


def _estimate(chain: Chain, wanted: _Open) -> _Estimate | None:
    """What is wanted; None where only the response is, and frames do not tell it."""
    frames = some_frames(chain.recording, 6 if np.prod(chain.recording.shape) > 500_000 else 24)
    with one_thread_per_frame():
        cells = _gather_cells(chain, frames)
    references = chain.references
    gain, read_noise = references.gain.values.copy(), references.read_noise.values.copy()
    if len(cells.variance) < 50:
        if not wanted.noise.any():
            return None
        raise FrameError(
            f"camera{1 + int(np.argmax(wanted.noise))} has no gain or read noise, and the frames do not tell it: expected two or more frames "
            f"with enough light and overlap, got {len(frames)} with {len(cells.variance)} usable patches. Give gain = "
            '"4.4 electron/DN" and read_noise = "9 electron", or flats and darks with at least two pages each.'
        )
    pattern = bool(wanted.response[1] and cells.pattern.mean() > _STILL)
    fit, alike = _fit(cells, references, wanted, one_gain=True, pattern=pattern), float("nan")
    if pattern and not fit.tells_response:
        # a column so like the constant would take from it, or give to it, at random
        pattern = False
        fit = _fit(cells, references, wanted, one_gain=True, pattern=False)
    if wanted.gain.all():
        fit, alike = _weigh(fit, _fit(cells, references, wanted, one_gain=False, pattern=pattern))
    gain_std = np.zeros(2)
    for n in np.nonzero(wanted.gain)[0]:
        slope, std = fit.slope[n], float(np.sqrt(fit.slope_covariance[n, n]))
        if not std < _WORST * slope:
            raise FrameError(
                f"camera{n + 1} has no gain, and the frames do not tell it: expected noise that rises with the light, got 1/gain = "
                f'{slope:.3g} ± {std:.2g} DN/electron. Give gain = "4.4 electron/DN", or flats with at least two pages of one light level '
                "to measure it by photon transfer."
            )
        gain[n], gain_std[n] = 1 / slope, std / slope**2
    read_std, dark = np.zeros(2), wanted.read_noise
    read_noise[dark] = gain[dark] * np.sqrt(fit.dark)
    # of the root of a variance near zero, the root of its standard deviation is what can be said
    read_std[dark] = (
        gain[dark] * fit.dark_std / (2 * np.sqrt(max(fit.dark, fit.dark_std / 4, 1e-12)))
    )
    response = np.where(wanted.response & wanted.response[1], np.sqrt(fit.response), np.nan)
    one, two = (
        CameraNoise(*map(float, row))
        for row in zip(gain, gain_std, read_noise, read_std, response, strict=True)
    )
    return _Estimate((one, two), alike, len(frames))


def _weigh(same: _Fit, apart: _Fit) -> tuple[_Fit, float]:
    """Mean of the answers of like and unlike cameras by their probability, and that of like ones.

    By Bayes: the odds are those beforehand times the densities of the difference where it scatters about zero by its standard
    deviation, and where unlike gains scatter it more. Both are Student's, because the standard deviation is itself taken from
    a few dozen blocks, not all of which weigh alike.
    """
    contrast = np.array([1.0, -1.0])
    difference, variance = contrast @ apart.slope, contrast @ apart.slope_covariance @ contrast
    spread = (_UNLIKENESS * same.slope.mean()) ** 2
    share = spread / (variance + spread)
    pull = np.array([difference**2 / variance, difference**2 / (variance + spread)])
    density = np.sqrt([1.0, 1 - share]) * (1 + pull / _FREEDOM) ** (-(_FREEDOM + 1) / 2)
    odds = _UNLIKE / (1 - _UNLIKE) * density[1] / density[0]
    alike = float(1 / (1 + odds))
    towards = (
        apart.slope_covariance @ contrast / (variance + spread)
    )  # what unlike gains may differ by is known beforehand
    unlike = apart.slope - towards * difference
    off = unlike - same.slope
    slope = same.slope + (1 - alike) * off
    narrowed = apart.slope_covariance - np.outer(towards, towards) * (variance + spread)
    between = alike * (1 - alike) * np.outer(off, off)
    covariance = alike * same.slope_covariance + (1 - alike) * narrowed + between
    likelier = same if alike > 0.5 else apart
    return replace(likelier, slope=slope, slope_covariance=covariance), alike


@dataclass(frozen=True)
class _Cells:
    """Patches of differences between two frames: their variance, and what it would be by each cause of size one."""

    pixels: Array
    """Pixels that count."""
    block: npt.NDArray[np.int64]
    """Which part of the image."""
    variance: Array
    shot: Array
    """(cell, camera), for a gain of 1 electron/DN."""
    read: Array
    """(cell, camera), for 1 DN2 of the dark's variance."""
    pattern: Array
    """For a relative pattern of variance 1 on the pixels of camera 2."""


@dataclass(frozen=True)
class _View:
    """One frame: logarithm of the ratio (y, x), NaN where flagged, and what one unit of noise gives."""

    log_ratio: Array
    shot: Array
    read: Array
    place: Array
    """(axis x y, row, column): where the middles of the cells lie on camera 2. [px]"""


def _gather_cells(chain: Chain, frames: list[int]) -> _Cells:
    height, width = chain.recording.shape
    size = max(_CELL, round(np.sqrt(height * width / _CELLS)))
    kernels = _kernels(chain)
    rows: list[Array] = []
    before: _View | None = None
    for frame in frames:
        view = _look(chain, frame, size)
        if before is not None:
            rows.append(_compare(before, view, kernels, size))
        before = view
    table = np.concatenate(rows, axis=1) if rows else np.zeros((8, 0))
    return _Cells(
        table[0], table[1].astype(np.int64), table[2], table[3:5].T, table[5:7].T, table[7]
    )


def _look(chain: Chain, frame: int, size: int) -> _View:
    """Shot noise of a gain of one, and a dark variance of one, go through the alignment in place of the true variances."""
    share = chain.recording.settings.thickness.no_film_below
    aligned = chain.aligned(frame)
    ratio = compute_ratio(aligned, no_film_below=share, blur=chain.blur)
    drift = np.array([[float(aligned.drift_x[0]), float(aligned.drift_y[0])]])
    corrected = correct_frames(read_frames(chain.recording, [frame]), chain.references)
    flat = chain.references.flat.values[:, None]
    dims, signal = corrected.signal.dims, corrected.signal.values
    units = corrected.assign(
        signal_var=(dims, np.maximum(signal, 0) / flat),
        signal_var_fixed=(dims, np.broadcast_to(flat**-2.0, signal.shape)),
    )
    shown = align_frames(CorrectedFrames(units), chain.camera_map, drift=drift)
    x, y = (
        getattr(chain.camera_map, f"displacement_{axis}").astype(float) + drift[0, n]
        for n, axis in enumerate("xy")
    )
    # the averaging of the interpolation is reckoned cell by cell, with that of the differences
    averaged = np.stack([np.ones_like(x), interpolation_variance_factor(x, y)])
    with np.errstate(divide="ignore", invalid="ignore"):
        per_light = 1 / (shown.signal.values[:, 0] ** 2 * averaged)
        shot, read = (
            shown.signal_var.values[:, 0] * per_light,
            shown.signal_var_fixed.values[:, 0] * per_light,
        )
    flagged = (ratio.flags.values[0] != 0) | ~np.isfinite(shot.sum(axis=0) + read.sum(axis=0))
    middles = (slice(size // 2, None, size), slice(size // 2, None, size))
    return _View(
        np.where(flagged, np.nan, ratio.log_ratio.values[0]).astype(float),
        shot,
        read,
        np.stack([x[middles], y[middles]])[:, : x.shape[0] // size, : x.shape[1] // size],
    )


def _kernels(chain: Chain) -> tuple[Array, Array]:
    """How a difference is made up of the logarithms of camera 1 and of camera 2, the removal of the ghost included."""
    x, y = (chain.blur.x, chain.blur.y) if chain.blur.significant else (0.0, 0.0)
    ghost = np.array([[0, -y / 2, 0], [-x / 2, x + y, -x / 2], [0, -y / 2, 0]])
    pixel = np.zeros((3, 3))
    pixel[1, 1] = 1
    one, two = (convolve2d(_RING, ghost + sign * pixel) for sign in (-1, 1))
    return one, two


def _compare(first: _View, second: _View, kernels: tuple[Array, Array], size: int) -> Array:
    """The table of the cells of two frames; columns as in _Cells."""
    difference = second.log_ratio - first.log_ratio
    squared = (
        np.asarray(cv2.filter2D(difference, -1, _RING, borderType=cv2.BORDER_CONSTANT), float) ** 2
    )
    for edge in (squared, squared.T):
        edge[:2] = edge[-2:] = np.nan
    good = np.isfinite(squared)
    pixels = _sum_cells(good.astype(float), size)

    def mean(image: Array) -> Array:
        return _sum_cells(np.where(good, image, 0.0), size) / np.maximum(pixels, 1)

    own = float((kernels[0] ** 2).sum())
    factors = [_overlap(kernels[1], view.place, view.place) for view in (first, second)]
    common = _overlap(kernels[1], first.place, second.place)
    units = []
    for name in ("shot", "read"):
        a, b = getattr(first, name), getattr(second, name)
        units.append(own * mean(a[0] + b[0]))
        units.append(factors[0] * mean(a[1]) + factors[1] * mean(b[1]))
    pattern = factors[0] + factors[1] - 2 * common
    rows, columns = np.indices(pixels.shape)
    block = rows * _BLOCKS // pixels.shape[0] * _BLOCKS + columns * _BLOCKS // pixels.shape[1]
    use = (pixels >= _LEAST_FILLING * size**2) & np.isfinite(pattern)
    return np.stack([image[use] for image in (pixels, block, mean(squared), *units, pattern)])


def _sum_cells(image: Array, size: int) -> Array:
    rows, columns = (n // size for n in image.shape)
    return np.asarray(
        image[: rows * size, : columns * size].reshape(rows, size, columns, size).sum(axis=(1, 3))
    )


def _overlap(kernel: Array, first: Array, second: Array) -> Array:
    """Covariance of a difference taken at two places of camera 2, for independent pixels of variance one.

    Weights of the interpolation are those of the cardinal cubic spline; a place is one of each cell, (axis x y, row, column).
    """
    together = correlate2d(kernel, kernel)
    reach = kernel.shape[0] - 1
    along = [
        np.stack(
            [_overlap_along(first[axis], second[axis] + lag) for lag in range(-reach, reach + 1)]
        )
        for axis in (0, 1)
    ]
    return np.asarray(np.einsum("vu,vij,uij->ij", together, along[1], along[0]))


def _overlap_along(first: Array, second: Array) -> Array:
    """Sum over k of eta(first - k) eta(second - k), eta being the cardinal cubic spline."""
    at, eta = _spline_table()
    base = np.floor(first)
    total = np.zeros(first.shape)
    for k in range(-7, 9):
        total += np.interp(first - base - k, at, eta) * np.interp(
            second - base - k, at, eta, left=0.0, right=0.0
        )
    return total


@cache
def _spline_table() -> tuple[Array, Array]:
    """The cardinal cubic spline: interpolates 1 at zero and 0 at every other whole number."""
    at = np.linspace(-9, 9, 18 * 128 + 1)
    pole = np.sqrt(3.0) - 2
    eta = np.zeros(at.size)
    for j in range(-16, 17):
        t = np.abs(at - j)
        b_spline = np.where(t < 1, (4 - 6 * t**2 + 3 * t**3) / 6, np.maximum(2 - t, 0) ** 3 / 6)
        eta += np.sqrt(3.0) * pole ** abs(j) * b_spline
    return at, eta


@dataclass(frozen=True)
class _Fit:
    """What the frames say; zeros where gain or dark was known."""

    slope: Array
    """(camera,), 1/gain. [DN/electron]"""
    slope_covariance: Array
    dark: float
    """Variance of the dark. [DN2]"""
    dark_std: float
    response: float
    """Relative variance of the response of camera 2, NaN where it was left out. [1]"""
    response_std: float

    @property
    def tells_response(self) -> bool:
        """Whether the response is an answer: sharp, or at least clearly there."""
        return self.response_std < _SHARP or self.response_std < min(_VAGUE, self.response / 3)


def _fit(
    cells: _Cells, references: References, wanted: _Open, *, one_gain: bool, pattern: bool
) -> _Fit:
    """Causes of the variance: light, dark, pattern and a rest.

    The pattern, where it is asked for, is that of camera 2 without a flat, which its drift moves, and the rest a constant: speckle
    that alignment and blur have not made the same to the last.
    """
    gain, read_noise = references.gain.values, references.read_noise.values
    known = np.zeros(len(cells.variance))
    for camera in range(2):
        if not wanted.gain[camera]:
            known += cells.shot[:, camera] / gain[camera]
        electronic = 0.0 if wanted.read_noise[camera] else (read_noise[camera] / gain[camera]) ** 2
        known += cells.read[:, camera] * (electronic + QUANTISATION_VAR)
    # which column belongs to which camera
    share = np.eye(2)[wanted.gain]
    if one_gain and len(share):
        share = share.sum(axis=0, keepdims=True)
    columns = [cells.shot @ cameras for cameras in share]
    if wanted.read_noise.any():
        columns.append(cells.read[:, wanted.read_noise].sum(axis=1))
    if pattern:
        columns.append(cells.pattern)
    elif not wanted.response[1]:
        two = references.isel(camera=1)
        good = ~two.bad.values
        known += cells.pattern * float((two.flat_var.values / two.flat.values**2)[good].mean())
    columns.append(np.ones(len(known)))
    values, covariance = _solve(
        np.stack(columns, axis=1), cells.variance, known, cells.pixels, cells.block
    )
    gains, dark = len(share), bool(wanted.read_noise.any())
    return _Fit(
        slope=values[:gains] @ share,
        slope_covariance=share.T @ covariance[:gains, :gains] @ share,
        dark=float(values[gains]) if dark else 0.0,
        dark_std=float(np.sqrt(covariance[gains, gains])) if dark else 0.0,
        response=float(values[-2]) if pattern else float("nan"),
        response_std=float(np.sqrt(covariance[-2, -2])) if pattern else float("nan"),
    )


def _solve(
    design: Array, variance: Array, known: Array, pixels: Array, block: npt.NDArray[np.int64]
) -> tuple[Array, Array]:
    """Least squares with no negative cause, and its covariance.

    Cells are weighted by the variance they should have and the farthest ones left out. The standard deviations come from the scatter between parts of the image, so that neither noise that cells share nor a
    misfit that goes with the place passes for knowledge.
    """
    scale = design.mean(axis=0)
    design = design / scale
    expected = np.full(variance.shape, np.median(variance))
    keep = np.ones(variance.shape, bool)
    for _ in range(20):
        weight = keep * np.sqrt(pixels) / expected
        values = nnls(design * weight[:, None], (variance - known) * weight)[0]
        expected = np.maximum(known + design @ values, 0.1 * np.median(variance))
        off = (variance - expected) / expected * np.sqrt(pixels)
        keep = np.abs(off) < 6 * 1.4826 * np.median(np.abs(off))
    weight = keep * pixels / expected**2
    inverse = np.linalg.pinv(design.T @ (design * weight[:, None]), hermitian=True)
    pull = (variance - known - design @ values) * weight
    score = np.stack([np.bincount(block, pull * column, _BLOCKS**2) for column in design.T], axis=1)
    covariance = inverse @ (score.T @ score) @ inverse * _BLOCKS**2 / (_BLOCKS**2 - 1)
    return values / scale, covariance / np.outer(scale, scale)
