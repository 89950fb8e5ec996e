"""Raw counts to light: dark and flat, bad pixels, saturation. The variance of every pixel is born here.

Gain and read noise are taken from the settings or measured, read noise from the darks in time and gain from the flats by
photon transfer (EMVA 1288: temporal variance of a pixel against its mean).
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numba
import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.config import CameraSettings
from erlif.core.errors import FrameError
from erlif.core.flags import FLAG_ATTRS, Flag
from erlif.core.products import CorrectedFrames, Frames, References, require
from erlif.ingest import Recording, find_reference_pages, read_reference

Array = npt.NDArray[np.float64]
Image = npt.NDArray[np.float32]

_SATURATED, _DIM, _BAD_PIXEL = int(Flag.SATURATED), int(Flag.DIM), int(Flag.BAD_PIXEL)
_QUANTISATION = 1 / 12  # variance of rounding to whole counts [DN2]
_SAME_LEVEL = 0.05  # flat pages whose means differ by less were taken at one light level
_TOLERATED = 0.10  # a declared gain or read noise further than this from the measured one is worth a word


def measure_references(recording: Recording) -> References:
    """Reduce darks and flats of both cameras, and measure what the settings leave open.

    Parameters
    ----------
    recording : Recording
        A run or a fixture; its darks and flats are read page by page.

    Returns
    -------
    References
        dark and flat (camera, y, x) with their variances, bad pixels, gain, read noise and full scale; the attribute
        ``notes`` says what was measured and what disagrees.

    Raises
    ------
    FrameError
        If darks or flats do not fit the frames, or gain or read noise is neither given nor measurable.
    """
    cameras = [
        _measure_camera(recording, settings, camera=number) for number, settings in enumerate(recording.cameras, 1)
    ]
    merged = xr.concat(cameras, xr.Variable("camera", [1, 2]), combine_attrs="drop")
    merged.attrs["notes"] = "\n".join(note for camera in cameras for note in camera.attrs["notes"])
    return References(merged)


def correct_frames(frames: Frames, references: References, *, least_signal: float = 100.0) -> CorrectedFrames:
    """Subtract the dark, divide by the flat, and give every pixel its variance and flags.

    The variance holds shot noise, read noise and rounding of the pixel; the noise of its dark and flat, which does not average
    out over frames, stands beside it. Bad pixels are
    filled from their neighbours, so that an interpolation does not ring about them, and stay flagged.

    Parameters
    ----------
    frames : Frames
        counts (camera, frame, y, x). [DN]
    references : References
    least_signal : float
        Pixels with less light than this are flagged dim. [electron]

    Returns
    -------
    CorrectedFrames
        signal [DN], signal_var and signal_var_fixed [DN2] and flags, each (camera, frame, y, x).
    """
    require(frames, "counts")
    require(references, "dark", "flat", "bad", "gain", "read_noise", "full_scale")
    counts = frames.counts.values
    signal = np.empty(counts.shape, np.float32)
    variance = np.empty(counts.shape, np.float32)
    fixed = np.empty(counts.shape, np.float32)
    flags = np.empty(counts.shape, np.uint8)
    for camera in range(counts.shape[0]):
        reference = references.isel(camera=camera)
        bad = reference.bad.values
        rows, columns = np.nonzero(bad)
        for n in range(counts.shape[1]):
            _correct(
                counts[camera, n],
                reference.dark.values,
                reference.dark_var.values,
                reference.flat.values,
                reference.flat_var.values,
                bad,
                float(reference.gain),
                float(reference.read_noise),
                int(reference.full_scale),
                least_signal,
                signal[camera, n],
                variance[camera, n],
                fixed[camera, n],
                flags[camera, n],
            )
            _fill_from_neighbours(signal[camera, n], bad, rows, columns)
    dims = ("camera", "frame", "y", "x")
    return CorrectedFrames(
        xr.Dataset(
            {
                "signal": (dims, signal, {"units": "DN", "ancillary_variables": "signal_var flags"}),
                "signal_var": (dims, variance, {"units": "DN2"}),
                "signal_var_fixed": (dims, fixed, {"units": "DN2"}),
                "flags": (dims, flags, FLAG_ATTRS),
            },
            frames.coords,
        )
    )


@numba.njit(nogil=True, cache=True)
def _correct(  # type: ignore[no-untyped-def]
    counts,
    dark,
    dark_var,
    flat,
    flat_var,
    bad,
    gain,
    read_noise,
    full_scale,
    least_signal,
    signal,
    variance,
    fixed,
    flags,
):
    read_var = (read_noise / gain) ** 2 + _QUANTISATION
    least = least_signal / gain
    for i in range(counts.shape[0]):
        for j in range(counts.shape[1]):
            light = counts[i, j] - dark[i, j]
            per_flat = 1.0 / flat[i, j]
            value = light * per_flat
            square = per_flat * per_flat
            signal[i, j] = value
            variance[i, j] = (max(light, 0.0) / gain + read_var) * square
            fixed[i, j] = (dark_var[i, j] + value * value * flat_var[i, j]) * square
            flag = 0
            if counts[i, j] >= full_scale:
                flag |= _SATURATED
            if light < least:
                flag |= _DIM
            if bad[i, j]:
                flag |= _BAD_PIXEL
            flags[i, j] = flag


@numba.njit(nogil=True, cache=True)
def _fill_from_neighbours(signal, bad, rows, columns):  # type: ignore[no-untyped-def]
    """Put the mean of the good pixels of the smallest ring that has some in place of each bad one."""
    height, width = signal.shape
    for n in range(rows.size):
        i, j = rows[n], columns[n]
        for reach in range(1, 6):
            total = 0.0
            count = 0
            for k in range(max(i - reach, 0), min(i + reach + 1, height)):
                for m in range(max(j - reach, 0), min(j + reach + 1, width)):
                    if not bad[k, m]:
                        total += signal[k, m]
                        count += 1
            if count > 0:
                signal[i, j] = total / count
                break


def _measure_camera(recording: Recording, settings: CameraSettings, *, camera: int) -> xr.Dataset:
    notes: list[str] = []
    shape = recording.shape
    dark, dark_var, temporal_var, bad = _reduce_darks(recording, settings, camera)
    flat = np.ones(shape)
    flat_var = np.zeros(shape)
    gain = settings.gain
    levels = _read_flats(recording, settings, dark, camera)
    measured = _photon_transfer(levels, settings, dark, temporal_var, bad)
    if measured is not None:
        notes.append(f"camera{camera}: gain measured from the flats, {measured[0]:.3f} ± {measured[1]:.3f} electron/DN")
        if gain is None:
            gain = measured[0]
        elif abs(gain / measured[0] - 1) > _TOLERATED:
            notes.append(
                f"camera{camera}: the declared gain, {gain:g} electron/DN, is {100 * (gain / measured[0] - 1):+.0f} % off the measured "
                "one; the declared value is used. Check it: every error bar scales with it."
            )
    if gain is None:
        raise FrameError(
            f'camera{camera} has no gain: give gain = "4.4 electron/DN", or flats with at least two pages of one light level to '
            "measure it by photon transfer."
        )
    read_noise = settings.read_noise
    if temporal_var is not None:
        own = float(np.sqrt(max(temporal_var - _QUANTISATION, 0.0))) * gain
        notes.append(f"camera{camera}: read noise measured from the darks, {own:.2f} electron")
        if read_noise is None:
            read_noise = own
        elif abs(read_noise / max(own, 1e-9) - 1) > _TOLERATED:
            notes.append(
                f"camera{camera}: the declared read noise, {read_noise:g} electron, is {100 * (read_noise / own - 1):+.0f} % off the "
                "measured one; the declared value is used."
            )
    if read_noise is None:
        raise FrameError(
            f'camera{camera} has no read noise: give read_noise = "9 electron", or darks with at least two pages to measure it.'
        )
    if levels:
        flat, flat_var, dead = _reduce_flats(levels, dark_var, bad, gain, read_noise)
        bad = bad | dead
    else:
        notes.append(f"camera{camera}: no flat; vignetting and pixel response are not corrected")
    return xr.Dataset(
        {
            "dark": (("y", "x"), dark.astype(np.float32), {"units": "DN"}),
            "dark_var": (("y", "x"), dark_var.astype(np.float32), {"units": "DN2"}),
            "flat": (("y", "x"), flat.astype(np.float32), {"units": "1"}),
            "flat_var": (("y", "x"), flat_var.astype(np.float32), {"units": "1"}),
            "bad": (("y", "x"), bad),
            "gain": ((), gain, {"units": "electron/DN"}),
            "read_noise": ((), read_noise, {"units": "electron"}),
            "full_scale": ((), settings.full_scale, {"units": "DN"}),
        },
        attrs={"notes": notes},
    )


def _reduce_darks(
    recording: Recording, settings: CameraSettings, camera: int
) -> tuple[Array, Array, float | None, npt.NDArray[np.bool_]]:
    """Mean dark, its variance, the mean temporal variance of a pixel and the hot or noisy pixels."""
    shape = recording.shape
    if settings.dark is None:
        assert settings.offset is not None  # the settings hold one or the other
        return np.full(shape, settings.offset), np.zeros(shape), None, np.zeros(shape, bool)
    found = find_reference_pages(recording.directory, settings.dark, what=f"camera{camera} dark")
    read = (read_reference(page, settings, directory=recording.directory, shape=shape).astype(float) for page in found)
    pages: _Pages | None = None
    for image in read:
        pages = pages or _Pages(image)
        pages.add(image)
    assert pages is not None  # find_reference_pages refuses an empty file
    mean, variance = pages.mean, pages.variance
    excess = mean - _median_of_surroundings(mean)
    hot = np.abs(excess) > np.maximum(8 * _robust_std(excess), 8.0)
    if pages.count < 2:
        return mean, np.zeros(shape), None, hot
    typical = float(np.median(variance))
    # the variance of n pages scatters by sqrt(2/(n-1)) of itself: a noisy pixel stands far above that
    noisy = variance > typical * (1 + 8 * np.sqrt(2 / (pages.count - 1))) + 1.0
    bad = hot | noisy
    temporal_var = float(variance[~bad].mean())
    return mean, np.full(shape, temporal_var / pages.count), temporal_var, bad


class _Pages:
    """Mean and temporal variance of each pixel over pages that come one at a time."""

    def __init__(self, first: Array) -> None:
        self.count = 0
        self.first = first
        self.total, self.squares = np.zeros(first.shape), np.zeros(first.shape)

    def add(self, page: Array) -> None:
        difference = page - self.first  # about the first page, so that squares do not cancel
        self.count += 1
        self.total += difference
        self.squares += difference**2

    @property
    def mean(self) -> Array:
        return self.first + self.total / self.count

    @property
    def variance(self) -> Array:
        return np.maximum(self.squares - self.total**2 / self.count, 0.0) / max(self.count - 1, 1)


def _median_of_surroundings(image: Array) -> Array:
    """Median over 5 x 5 pixels."""
    return np.asarray(cv2.medianBlur(np.ascontiguousarray(image, np.float32), 5), float)


def _read_flats(recording: Recording, settings: CameraSettings, dark: Array, camera: int) -> list[_Pages]:
    """Flats above dark, level by level: consecutive pages of one light level, freed of the lamp's flicker.

    Saturated pages are left out.
    """
    if settings.flat is None:
        return []
    levels: list[_Pages] = []
    for page in find_reference_pages(recording.directory, settings.flat, what=f"camera{camera} flat"):
        image = read_reference(page, settings, directory=recording.directory, shape=recording.shape)
        if np.mean(image >= settings.full_scale) > 1e-3:
            continue
        light = image - dark
        if not levels or abs(light.mean() / levels[-1].first.mean() - 1) >= _SAME_LEVEL:
            levels.append(_Pages(light))
        levels[-1].add(light * (levels[-1].first.mean() / light.mean()))
    if not levels or max(level.first.mean() for level in levels) < settings.full_scale / 50:
        raise FrameError(
            f"Expected flats of camera{camera} well above dark and below full scale ({settings.full_scale}); none is. Record flats "
            "with the light at a quarter to three quarters of full scale."
        )
    return levels


def _photon_transfer(
    levels: Sequence[_Pages],
    settings: CameraSettings,
    dark: Array,
    dark_temporal_var: float | None,
    bad: npt.NDArray[np.bool_],
) -> tuple[float, float] | None:
    """Gain and its standard deviation [electron/DN] from the rise of temporal variance with light (EMVA 1288, sec. 6)."""
    light, noise, weight = [], [], []
    for level in levels:
        if level.count < 2:
            continue
        mean, variance = level.mean, level.variance
        good = ~bad & (mean + dark < 0.95 * settings.full_scale)
        light.append(float(mean[good].mean()))
        noise.append(float(variance[good].mean()) - (dark_temporal_var if dark_temporal_var is not None else 0.0))
        weight.append((level.count - 1) * good.sum() / (2 * float((variance[good] ** 2).mean())))
    if not light or sum(noise) <= 0:
        return None
    x, y, w = np.array(light), np.array(noise), np.array(weight)
    slope = float((w * x * y).sum() / (w * x * x).sum())
    slope_std = float(1 / np.sqrt((w * x * x).sum()))
    return 1 / slope, slope_std / slope**2


def _reduce_flats(
    levels: Sequence[_Pages], dark_var: Array, bad: npt.NDArray[np.bool_], gain: float, read_noise: float
) -> tuple[Array, Array, npt.NDArray[np.bool_]]:
    """Response of each pixel relative to the mean, its variance, and the dead pixels."""
    count = sum(level.count for level in levels)
    total = np.sum([level.count * level.mean for level in levels], axis=0)
    scale = float(total[~bad].mean())
    surroundings = _median_of_surroundings(total)
    dead = (total < 0.5 * surroundings) | (total > 1.5 * surroundings) | (total < 0.02 * scale)
    flat = np.where(dead | bad, np.maximum(surroundings, 0.02 * scale), total) / scale
    page_var = (read_noise / gain) ** 2 + _QUANTISATION
    variance = np.maximum(total, 0.0) / gain + count * page_var + count**2 * dark_var
    return flat, variance / scale**2, dead


def _robust_std(values: Array) -> float:
    """Standard deviation of the bulk, from the median absolute deviation."""
    return float(1.4826 * np.median(np.abs(values - np.median(values))))
