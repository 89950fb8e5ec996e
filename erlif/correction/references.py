"""Dark, flat, gain and read noise of both cameras (EMVA 1288)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.core.detector import QUANTISATION_VAR
from erlif.core.products import References
from erlif.correction.darks import _Darks, _reduce_darks
from erlif.correction.flats import _photon_transfer, _read_flats, _reduce_flats
from erlif.correction.pages import PageStack
from erlif.correction.photon_transfer import measure_response_spread
from erlif.correction.saturation import _find_saturation_in_frames
from erlif.ingest import Recording
from erlif.settings import CameraSettings

_TOLERATED = (
    0.10  # a declared gain or read noise further than this from the measured one is worth a word
)


_SUPPOSED_CAPACITY, _SUPPOSED_READ_NOISE = (
    16000.0,
    10.0,
)  # of a camera of which nothing is known yet [electron]


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
    page_var = (read_noise / gain) ** 2 + QUANTISATION_VAR
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
        variance = max(darks.temporal_var - QUANTISATION_VAR, 0.0)
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
