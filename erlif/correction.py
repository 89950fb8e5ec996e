"""Raw counts to light: dark and flat, bad pixels, saturation. The variance of every pixel is born here.

Gain and read noise are taken from the settings or measured, read noise from the darks in time and gain from the flats by
photon transfer (EMVA 1288: temporal variance of a pixel against its mean). Where neither is possible, `erlif.noise` estimates
them from the frames.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numba
import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy.stats import chi2

from erlif.config import CameraSettings
from erlif.core.errors import FrameError
from erlif.core.flags import FLAG_ATTRS, Flag
from erlif.core.products import CorrectedFrames, Frames, References, require
from erlif.ingest import Recording, find_reference_pages, read_frames, read_reference
from erlif.photon_transfer import (
    LightLevel,
    PageStack,
    PhotonTransfer,
    find_pile_up,
    fit_photon_transfer,
    measure_response_spread,
    reduce_level,
    robust_std,
)

Array = npt.NDArray[np.float64]
Image = npt.NDArray[np.float32]

_SATURATED, _DIM, _BAD_PIXEL = int(Flag.SATURATED), int(Flag.DIM), int(Flag.BAD_PIXEL)
_QUANTISATION = 1 / 12  # variance of rounding to whole counts [DN2]
_SAME_LEVEL = 0.05  # flat pages whose means differ by less were taken at one light level
_TOLERATED = (
    0.10  # a declared gain or read noise further than this from the measured one is worth a word
)
_SUPPOSED_CAPACITY, _SUPPOSED_READ_NOISE = (
    16000.0,
    10.0,
)  # of a camera of which nothing is known yet [electron]
_FRAMES_SEEN = 8  # frames searched for saturation below full scale


@dataclass(frozen=True)
class CameraNoise:
    """Gain [electron/DN] and read noise [electron] of one camera with their standard deviations, and its response spread [1].

    The response spread is NaN where nothing tells it.
    """

    gain: float
    gain_std: float
    read_noise: float
    read_noise_std: float
    response_spread: float = float("nan")


def measure_references(
    recording: Recording, *, estimated: Sequence[CameraNoise | None] = (None, None)
) -> References:
    """Reduce darks and flats of both cameras, and measure what the settings leave open.

    Parameters
    ----------
    recording : Recording
        A run or a fixture; its darks and flats are read page by page, and a few of its frames for where the cameras saturate.
    estimated : sequence of two CameraNoise or None
        Used where a camera's gain or read noise is neither given nor measurable from darks and flats; the response spread where
        there is no flat.

    Returns
    -------
    References
        dark and flat (camera, y, x) with their variances, bad pixels, gain, read noise and full scale, and the characteristics
        of each camera after EMVA 1288, NaN where they were not measured. The attribute ``notes`` says what was measured,
        ``warnings`` which of these lines deserve attention. Where gain_known or read_noise_known is False, the value is a guess to
        begin with.

    Raises
    ------
    FrameError
        If darks or flats do not fit the frames.
    """
    levels = _find_saturation_in_frames(recording)
    cameras = [
        _measure_camera(recording, settings, camera=number, seen=seen, estimated=noise)
        for number, (settings, seen, noise) in enumerate(
            zip(recording.cameras, levels, estimated, strict=True), 1
        )
    ]
    merged = xr.concat(cameras, xr.Variable("camera", [1, 2]), combine_attrs="drop")
    for kind in ("notes", "warnings"):
        merged.attrs[kind] = "\n".join(line for camera in cameras for line in camera.attrs[kind])
    return References(merged)


def correct_frames(
    frames: Frames, references: References, *, least_signal: float = 100.0
) -> CorrectedFrames:
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
                "signal": (
                    dims,
                    signal,
                    {"units": "DN", "ancillary_variables": "signal_var flags"},
                ),
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


def _find_saturation_in_frames(recording: Recording) -> list[npt.NDArray[np.int64]]:
    """Pixels by count in a few frames of each camera."""
    usable = recording.frames
    places = np.unique(np.linspace(0, len(usable) - 1, _FRAMES_SEEN).round().astype(int))
    seen = [np.zeros(settings.full_scale + 1, np.int64) for settings in recording.cameras]
    for place in places:
        counts = read_frames(recording, [usable[place]]).counts.values
        for camera, histogram in enumerate(seen):
            histogram += np.bincount(counts[camera].ravel(), minlength=histogram.size)
    return seen


@dataclass
class _CameraRecord:
    """What is known of one camera, with its unit and meaning, and what is to be said of it."""

    camera: int
    values: dict[str, tuple[float, str, str]]
    notes: list[str]
    warnings: list[str]

    def put(self, name: str, value: float, units: str, meaning: str) -> None:
        self.values[name] = (value, units, meaning)

    def say(self, text: str, *, warning: bool = False) -> None:
        line = f"camera{self.camera}: {text}"
        self.notes.append(line)
        if warning:
            self.warnings.append(line)


def _measure_camera(
    recording: Recording,
    settings: CameraSettings,
    *,
    camera: int,
    seen: npt.NDArray[np.int64],
    estimated: CameraNoise | None,
) -> xr.Dataset:
    record = _CameraRecord(camera, {}, [], [])
    darks = _reduce_darks(recording, settings, camera)
    levels, saturation = _read_flats(recording, settings, darks.mean, camera, seen)
    gain, gain_std, gain_known = _find_gain(levels, settings, darks, saturation, estimated, record)
    read_noise, read_noise_known = _find_read_noise(
        settings, darks, gain, gain_std if gain_known else None, estimated, record
    )
    page_var = (read_noise / gain) ** 2 + _QUANTISATION
    # one dark page does not tell its variance, but it has the noise of a page
    dark_var = np.full(recording.shape, page_var if darks.pages == 1 else darks.mean_var)
    flat, flat_var, bad = np.ones(recording.shape), np.zeros(recording.shape), darks.bad
    spread = float("nan")
    if levels:
        flat, flat_var, dead = _reduce_flats(levels, dark_var, bad, gain, page_var)
        bad = bad | dead
        spread = measure_response_spread(flat, flat_var, bad)
    elif estimated is not None:
        spread = estimated.response_spread
        flat_var += (
            np.nan_to_num(spread) ** 2
        )  # what is not corrected is noise, the same in every frame
    dark = float(darks.mean[~darks.bad].mean())
    record.put("full_scale", saturation, "DN", "count at which the camera saturates")
    record.put("dark_signal", dark, "DN", "mean dark level")
    record.put(
        "dark_signal_std",
        darks.mean_std,
        "DN",
        "standard deviation of dark_signal, from page to page",
    )
    record.put(
        "dark_spread",
        darks.spread,
        "DN",
        "standard deviation of the dark level over the pixels (DSNU)",
    )
    record.put(
        "response_spread",
        spread,
        "1",
        "standard deviation of the response from pixel to pixel (PRNU)",
    )
    record.put(
        "saturation_capacity", (saturation - dark) * gain, "electron", "electrons at saturation"
    )
    record.notes.insert(0, _summarise(record, settings, gain_known=gain_known))
    if saturation < settings.full_scale:
        record.say(
            f"counts pile up at {saturation}, below full scale ({settings.full_scale}): pixels that read {saturation} or more count as "
            "saturated",
            warning=True,
        )
    if not levels:
        record.say("no flat; vignetting and pixel response are not corrected", warning=True)
    scalars = {
        name: ((), value, {"units": units, "long_name": meaning})
        for name, (value, units, meaning) in record.values.items()
    }
    return xr.Dataset(
        {
            "dark": (("y", "x"), darks.mean.astype(np.float32), {"units": "DN"}),
            "dark_var": (("y", "x"), dark_var.astype(np.float32), {"units": "DN2"}),
            "flat": (("y", "x"), flat.astype(np.float32), {"units": "1"}),
            "flat_var": (("y", "x"), flat_var.astype(np.float32), {"units": "1"}),
            "bad": (("y", "x"), bad),
            "gain_known": ((), gain_known),
            "read_noise_known": ((), read_noise_known),
            "has_flat": ((), bool(levels)),
        }
        | scalars,
        attrs={"notes": record.notes, "warnings": record.warnings},
    )


def _find_gain(
    levels: Sequence[PageStack],
    settings: CameraSettings,
    darks: _Darks,
    saturation: int,
    estimated: CameraNoise | None,
    record: _CameraRecord,
) -> tuple[float, float, bool]:
    """Gain in use, its standard deviation (0 of a declared one), and whether it is more than a guess."""
    measured = _photon_transfer(levels, settings, darks, saturation)
    own, std = (measured.gain, measured.gain_std) if measured else (float("nan"), float("nan"))
    if measured is None and settings.gain is None and estimated is not None:
        own, std = estimated.gain, estimated.gain_std
    known = settings.gain is not None or not np.isnan(own)
    gain = settings.gain or (own if known else _SUPPOSED_CAPACITY / settings.full_scale)
    record.put("gain", gain, "electron/DN", "gain in use")
    record.put("gain_measured", own, "electron/DN", "gain as measured")
    record.put("gain_std", std, "electron/DN", "standard deviation of gain_measured")
    record.put(
        "bend",
        measured.bend if measured else float("nan"),
        "1",
        "bend of the photon transfer curve",
    )
    record.put(
        "bend_std",
        measured.bend_std if measured else float("nan"),
        "1",
        "standard deviation of bend",
    )
    if settings.gain is not None and abs(settings.gain / own - 1) > _TOLERATED:
        record.say(
            f"the declared gain, {settings.gain:g} electron/DN, is {100 * (settings.gain / own - 1):+.0f} % off the measured one; the "
            "declared value is used. Check it: every error bar scales with it.",
            warning=True,
        )
    if not known:
        record.say(
            "neither gain nor flats with two pages of one light level: its gain will be estimated from the noise of the frames",
            warning=True,
        )
    if measured is not None and measured.is_bent:
        record.say(
            f"the photon transfer curve is not straight: variance per light changes by {100 * measured.bend:+.1f} ± "
            f"{100 * measured.bend_std:.1f} % from dark to the brightest flat, as of a response that is not linear by about a third of "
            "that, or of charge that spreads to neighbours",
            warning=True,
        )
    return gain, std if settings.gain is None and known else 0.0, known


def _find_read_noise(
    settings: CameraSettings,
    darks: _Darks,
    gain: float,
    gain_std: float | None,
    estimated: CameraNoise | None,
    record: _CameraRecord,
) -> tuple[float, bool]:
    """Read noise in use, and whether it is more than a guess; a gain without standard deviation is one."""
    own = std = float("nan")
    if darks.temporal_var is not None:
        variance = max(darks.temporal_var - _QUANTISATION, 0.0)
        own = float(np.sqrt(variance)) * gain
        # of the root of a variance near zero, the root of its standard deviation is what can be said
        of_root = darks.temporal_var_std / (
            2 * np.sqrt(max(variance, darks.temporal_var_std / 4, 1e-12))
        )
        std = float(np.hypot(gain * of_root, own * (gain_std or 0.0) / gain))
    elif settings.read_noise is None and estimated is not None:
        own, std = estimated.read_noise, estimated.read_noise_std
    known = settings.read_noise is not None or not np.isnan(own)
    read_noise = (
        settings.read_noise
        if settings.read_noise is not None
        else own
        if known
        else _SUPPOSED_READ_NOISE
    )
    record.put("read_noise", read_noise, "electron", "read noise in use")
    record.put("read_noise_measured", own, "electron", "read noise as measured")
    record.put("read_noise_std", std, "electron", "standard deviation of read_noise_measured")
    declared = settings.read_noise if gain_std is not None else None
    if declared is not None and abs(declared - own) > _TOLERATED * own + 3 * std:
        record.say(
            f"the declared read noise, {declared:g} electron, is not the measured one, {_with_std(own, std)} electron; the declared "
            "value is used.",
            warning=True,
        )
    if not known:
        record.say(
            "neither read noise nor two dark pages: its read noise will be estimated from the noise of the frames",
            warning=True,
        )
    return read_noise, known


def _summarise(record: _CameraRecord, settings: CameraSettings, *, gain_known: bool) -> str:
    """One line about a camera: what was measured of it, and what was declared."""

    def noise(name: str, what: str, unit: str, declared: float | None) -> str:
        used, own, std = (
            record.values[key][0] for key in (name, f"{name}_measured", f"{name}_std")
        )
        if np.isnan(own):
            return f"{what} {used:g} {unit} ({'declared' if declared is not None else 'supposed'})"
        return f"{what} {_with_std(own, std)} {unit}" + (
            f" (declared {declared:g})" if declared is not None else ""
        )

    saturation, capacity = (record.values[key][0] for key in ("full_scale", "saturation_capacity"))
    spread = record.values["response_spread"][0]
    electronic = [
        noise("gain", "gain", "electron/DN", settings.gain),
        noise("read_noise", "read noise", "electron", settings.read_noise),
    ]
    parts = [
        *(electronic if gain_known else ["gain not known yet"]),
        f"dark {record.values['dark_signal'][0]:.1f} DN",
        *([] if np.isnan(spread) else [f"response spread {100 * spread:.1f} %"]),
        f"saturation {saturation:.0f} DN" + (f" = {capacity / 1e3:.1f} ke" if gain_known else ""),
    ]
    return f"camera{record.camera}: {', '.join(parts)}"


def _with_std(value: float, std: float) -> str:
    """Value and standard deviation, to the first digit of the latter, or to the second where that is a 1."""
    digits = int(np.clip(np.ceil(-np.log10(std / 1.95)), 0, 4)) if std > 0 else 2
    return f"{value:.{digits}f} ± {std:.{digits}f}"


@dataclass(frozen=True)
class _Darks:
    """Darks of one camera, reduced."""

    mean: Array
    """Mean of each pixel. [DN]"""
    mean_var: float
    """Its variance. [DN2]"""
    bad: npt.NDArray[np.bool_]
    """Hot or noisy pixels."""
    pages: int
    """0 where the dark is a declared level."""
    temporal_var: float | None = None
    """Temporal variance of a pixel. [DN2]"""
    temporal_var_std: float = 0.0
    mean_std: float = float("nan")
    """Standard deviation of the mean level, from page to page. [DN]"""
    spread: float = float("nan")
    """Standard deviation over the pixels. [DN]"""


def _reduce_darks(recording: Recording, settings: CameraSettings, camera: int) -> _Darks:
    shape = recording.shape
    if settings.dark is None:
        assert settings.offset is not None  # the settings hold one or the other
        return _Darks(np.full(shape, settings.offset), 0.0, np.zeros(shape, bool), 0)
    found = find_reference_pages(recording.directory, settings.dark, what=f"camera{camera} dark")
    read = (
        read_reference(page, settings, directory=recording.directory, shape=shape).astype(float)
        for page in found
    )
    pages: PageStack | None = None
    levels = []
    for image in read:
        pages = pages or PageStack(image)
        pages.add(image)
        levels.append(float(np.median(image - pages.first)))
    assert pages is not None  # find_reference_pages refuses an empty file
    mean, variance, n = pages.mean, pages.variance, pages.count
    excess = mean - _median_of_surroundings(mean)
    hot = np.abs(excess) > np.maximum(8 * robust_std(excess), 8.0)
    if n < 2:
        return _Darks(mean, 0.0, hot, 1)
    # the variance of n pages is a chi-square of n - 1: a noisy pixel stands above what one in ten million does
    typical = max(
        float(np.median(variance)) * (n - 1) / chi2.ppf(0.5, n - 1),
        # of few pages of a quiet camera most counts are alike, and the median is 0; noisy pixels must not lift this mean
        float(np.minimum(variance, np.quantile(variance, 0.99)).mean()),
        _QUANTISATION,
    )
    noisy = variance > typical * chi2.isf(1e-7, n - 1) / (n - 1) + 1.0
    bad = hot | noisy
    temporal_var = float(variance[~bad].mean())
    drift = float(np.std(levels, ddof=1)) / np.sqrt(n)
    pixels = int((~bad).sum())
    return _Darks(
        mean,
        temporal_var / n,
        bad,
        n,
        temporal_var,
        temporal_var * float(np.sqrt(2 / ((n - 1) * pixels))),
        float(np.hypot(drift, np.sqrt(temporal_var / (n * pixels)))),
        float(np.sqrt(max(float(mean[~bad].var()) - temporal_var / n, 0.0))),
    )


def _median_of_surroundings(image: Array) -> Array:
    """Median over 5 x 5 pixels."""
    return np.asarray(cv2.medianBlur(np.ascontiguousarray(image, np.float32), 5), float)


def _read_flats(
    recording: Recording,
    settings: CameraSettings,
    dark: Array,
    camera: int,
    seen: npt.NDArray[np.int64],
) -> tuple[list[PageStack], int]:
    """Flats above dark, level by level, and the count at which the camera saturates.

    A level is consecutive pages of one brightness, freed of the lamp's flicker. Saturated pages are left out, those too that pile up
    below full scale; `seen`, pixels by count in some frames, is searched for such a pile-up as well.
    """
    levels: list[PageStack] = []
    saturation = find_pile_up(seen) or settings.full_scale
    if settings.flat is None:
        return levels, saturation
    pages = find_reference_pages(recording.directory, settings.flat, what=f"camera{camera} flat")
    total = seen.copy()
    for page in pages:
        image = read_reference(page, settings, directory=recording.directory, shape=recording.shape)
        histogram = np.bincount(image.ravel(), minlength=settings.full_scale + 1)
        total += histogram
        top = find_pile_up(histogram) or settings.full_scale
        if histogram[top:].sum() > 1e-3 * image.size:
            continue
        light = image - dark
        if not levels or abs(light.mean() / levels[-1].first.mean() - 1) >= _SAME_LEVEL:
            levels.append(PageStack(light))
        levels[-1].add(light, scale=levels[-1].first.mean() / light.mean())
    saturation = find_pile_up(total) or settings.full_scale
    if not levels or max(level.first.mean() for level in levels) < settings.full_scale / 50:
        raise FrameError(
            f"Expected flats of camera{camera} well above dark and below saturation ({saturation}); none is. Record flats with the light "
            "at a quarter to three quarters of full scale."
        )
    return levels, saturation


def _photon_transfer(
    levels: Sequence[PageStack], settings: CameraSettings, darks: _Darks, saturation: int
) -> PhotonTransfer | None:
    """Photon transfer over the pixels that are sound and clear of saturation."""
    points: list[LightLevel] = []
    for level in levels:
        point = reduce_level(level, ~darks.bad & (level.mean + darks.mean < 0.95 * saturation))
        if point is not None:
            points.append(point)
    if darks.temporal_var is not None or settings.read_noise is None:
        return fit_photon_transfer(
            points, dark_variance=darks.temporal_var, dark_variance_std=darks.temporal_var_std
        )
    # a read noise declared in electrons is a variance of counts once the gain is known: two rounds settle it
    found = fit_photon_transfer(points, dark_variance=_QUANTISATION)
    for _ in range(3):
        if found is not None:
            dark_variance = (settings.read_noise / found.gain) ** 2 + _QUANTISATION
            found = fit_photon_transfer(points, dark_variance=dark_variance)
    return found


def _reduce_flats(
    levels: Sequence[PageStack],
    dark_var: Array,
    bad: npt.NDArray[np.bool_],
    gain: float,
    page_var: float,
) -> tuple[Array, Array, npt.NDArray[np.bool_]]:
    """Response of each pixel relative to the mean, its variance, and the dead pixels."""
    count = sum(level.count for level in levels)
    total = np.sum([level.count * level.mean for level in levels], axis=0)
    scale = float(total[~bad].mean())
    surroundings = _median_of_surroundings(total)
    dead = (total < 0.5 * surroundings) | (total > 1.5 * surroundings) | (total < 0.02 * scale)
    flat = np.where(dead | bad, np.maximum(surroundings, 0.02 * scale), total) / scale
    variance = np.maximum(total, 0.0) / gain + count * page_var + count**2 * dark_var
    return flat, variance / scale**2, dead
