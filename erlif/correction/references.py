"""Dark, flat, gain and read noise of both cameras, with what was measured of each (EMVA 1288).

Gain and read noise come from the settings where they are declared, else from darks and flats
(photon transfer), else from an estimate by the noise of the frames (`erlif.ratio.camera_noise`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray, Mask
from erlif.core.detector import QUANTISATION_VAR, reading_var
from erlif.core.notes import Note, remark, warn
from erlif.core.products import References
from erlif.core.units import count_of
from erlif.correction.camera import CameraMeasurement
from erlif.correction.flats import make_flat_field
from erlif.correction.photon_transfer import (
    PhotonTransfer,
    fit_photon_transfer,
    measure_response_spread,
)

# Relative deviation of a declared gain or read noise from the measured one that is reported.
_TOLERATED = 0.10

# Electrons at full scale of a camera whose gain is not known yet. [electron]
_ASSUMED_CAPACITY = 16000.0

# Read noise of a camera until it is estimated. [electron]
_ASSUMED_READ_NOISE = 10.0

# Dark variance by which the fitted slope is differentiated; the dependence is linear. [DN2]
_TRIAL_VAR = 1.0

_NAN = float("nan")


@dataclass(frozen=True)
class DeclaredNoise:
    """Gain and read noise of one camera as the settings give them; None where they do not.

    Attributes
    ----------
    gain : float | None
        [electron/DN]
    read_noise : float | None
        [electron]
    """

    gain: float | None = None
    read_noise: float | None = None


# Subject of the note on gain, read noise, dark level and saturation of both cameras.
CHARACTERISTICS = "cameras"


@dataclass(frozen=True)
class CameraNoise:
    """Gain and read noise of one camera as estimated from the frames.

    Attributes
    ----------
    gain : float
        [electron/DN]
    gain_std : float
        [electron/DN]
    read_noise : float
        [electron]
    read_noise_std : float
        [electron]
    response_spread : float
        Relative standard deviation of the response over the pixels; NaN where the frames do not
        determine it. [1]
    """

    gain: float
    gain_std: float
    read_noise: float
    read_noise_std: float
    response_spread: float = _NAN


CAMERA_NOISE = ("gain", "read_noise", "response_spread")
"""Numbers of both cameras from which the noise of a film follows."""


@dataclass(frozen=True)
class Cameras:
    """References of both cameras, with the notes on their characterisation.

    Attributes
    ----------
    references : References
        Images and characteristics of camera 1 and camera 2.
    notes : tuple[Note, ...]
        What was measured, and what needs attention.
    """

    references: References
    notes: tuple[Note, ...]


@dataclass(frozen=True)
class _Quantity:
    """A characteristic of a camera, in use and as measured."""

    value: float  # in use
    measured: float  # NaN where it was not measured
    std: float  # standard deviation of the measured value
    known: bool  # whether the value in use is more than an assumption


class _Response(NamedTuple):
    """Flat of one camera in use, and its bad pixels."""

    flat: AnyArray  # response relative to the mean, (y, x); 1 without a flat. [1]
    flat_var: AnyArray  # its variance, (y, x). [1]
    bad: Mask  # hot, noisy and dead pixels, (y, x)
    spread: float  # standard deviation over the pixels (PRNU); NaN where it is not known. [1]


def make_references(
    measured: Sequence[CameraMeasurement],
    *,
    declared: Sequence[DeclaredNoise],
    estimated: Sequence[CameraNoise | None] = (None, None),
) -> Cameras:
    """Combine what was measured, declared and estimated of both cameras.

    Parameters
    ----------
    measured : sequence of two CameraMeasurement
    declared : sequence of two DeclaredNoise
        Takes precedence over what was measured.
    estimated : sequence of two CameraNoise or None
        Gain and read noise where they are neither declared nor measurable from darks and flats;
        response spread where there is no flat.

    Returns
    -------
    Cameras
        References: dark and flat (camera, y, x) with their variances, bad pixels, gain, read noise
        and full scale, and the characteristics of each camera after EMVA 1288, NaN where they were
        not measured. Where gain_known or read_noise_known is False, the value is an assumption to
        start from. The notes report what was measured; warnings among them need attention.

    Examples
    --------
    >>> from erlif.correction import measure_camera
    >>> camera = measure_camera(
    ...     darks=64.0, flats=[], histogram=np.zeros(4096, np.int64), shape=(4, 4), camera="camera1"
    ... )
    >>> cameras = make_references([camera, camera], declared=[DeclaredNoise(4.4, 9.0)] * 2)
    >>> cameras.references.gain.values
    array([4.4, 4.4])
    """
    datasets, lines = [], []
    notes: list[Note] = []
    dry = any(camera.background is not None for camera in measured)
    for number, sources in enumerate(zip(measured, declared, estimated, strict=True), 1):
        camera = _CameraEvidence(f"camera{number}", *sources)
        dataset = camera.to_dataset()
        if dry:
            dataset = dataset.assign(_describe_background(camera.measured, dataset))
        datasets.append(dataset)
        lines.append(f"{camera.name} {camera.summary()}")
        notes += camera.notes()
    merged = xr.concat(datasets, xr.Variable("camera", [1, 2]), combine_attrs="drop")

    # one number for each camera, stored once and not for every pixel
    of_dark = merged.dark_var.values[:, :1, :1].copy()
    merged["dark_var"] = merged.dark_var.copy(data=np.broadcast_to(of_dark, merged.dark.shape))
    both = remark(CHARACTERISTICS, "; ".join(lines))
    return Cameras(References(merged), (both, *notes))


@dataclass(frozen=True)
class _CameraEvidence:
    """Measured, declared and estimated noise of one camera."""

    name: str
    measured: CameraMeasurement
    declared: DeclaredNoise
    estimated: CameraNoise | None

    @cached_property
    def transfer(self) -> PhotonTransfer | None:
        """Photon transfer curve, with the best available dark variance."""
        darks, levels = self.measured.darks, self.measured.levels
        read_noise = self.declared.read_noise
        if darks.temporal_var is not None or read_noise is None:
            return fit_photon_transfer(
                levels, dark_variance=darks.temporal_var, dark_variance_std=darks.temporal_var_std
            )

        # a read noise R in electrons is the variance R^2 s^2 in counts, where s = 1/gain is the
        # slope of the curve; the fitted slope falls in proportion to the variance that is
        # subtracted, s = s0 - c R^2 s^2, so that s is the positive root of this equation
        start = fit_photon_transfer(levels, dark_variance=QUANTISATION_VAR)
        shifted = fit_photon_transfer(levels, dark_variance=QUANTISATION_VAR + _TRIAL_VAR)
        if start is None or shifted is None:
            return start
        squared = (1 / start.gain - 1 / shifted.gain) / _TRIAL_VAR * read_noise**2
        slope = 2 / start.gain / (1 + math.sqrt(1 + 4 * squared / start.gain))
        dark_variance = (read_noise * slope) ** 2 + QUANTISATION_VAR
        return fit_photon_transfer(levels, dark_variance=dark_variance)

    @cached_property
    def gain(self) -> _Quantity:
        """Gain in use. [electron/DN]"""
        # the frames are searched for a gain only where neither settings nor flats have one
        transfer, declared, estimated = self.transfer, self.declared.gain, self.estimated
        own, std = (transfer.gain, transfer.gain_std) if transfer else (_NAN, _NAN)
        if transfer is None and declared is None and estimated is not None:
            own, std = estimated.gain, estimated.gain_std

        known = declared is not None or not np.isnan(own)
        assumed = _ASSUMED_CAPACITY / self.measured.full_scale
        return _Quantity(declared or (own if known else assumed), own, std, known)

    @cached_property
    def read_noise(self) -> _Quantity:
        """Read noise in use. [electron]"""
        darks, gain, declared = self.measured.darks, self.gain, self.declared.read_noise
        own = std = _NAN
        if darks.temporal_var is not None:
            variance = max(darks.temporal_var - QUANTISATION_VAR, 0.0)
            own = float(np.sqrt(variance)) * gain.value

            # the root of a variance near zero is uncertain by the root of that variance's own
            # standard deviation; further up linear propagation holds
            std_of_variance = darks.temporal_var_std
            of_root = std_of_variance / (2 * np.sqrt(max(variance, std_of_variance / 4, 1e-12)))
            gain_std = gain.std if self.declared.gain is None and gain.known else 0.0
            std = float(np.hypot(gain.value * of_root, own * gain_std / gain.value))
        elif declared is None and self.estimated is not None:
            own, std = self.estimated.read_noise, self.estimated.read_noise_std

        # the declared value takes precedence; an assumed one serves until the frames are read
        known = declared is not None or not np.isnan(own)
        value = own if known else _ASSUMED_READ_NOISE
        return _Quantity(value if declared is None else declared, own, std, known)

    @property
    def capacity(self) -> float:
        """Electrons at saturation. [electron]"""
        return (self.measured.saturation - self.measured.darks.level) * self.gain.value

    @cached_property
    def page_var(self) -> float:
        """Variance of a page by reading. [DN2]"""
        return reading_var(self.read_noise.value, self.gain.value)

    @cached_property
    def dark_var(self) -> AnyArray:
        """Variance of the mean dark, (y, x). [DN2]"""
        # a single dark page does not determine its variance; it has the noise of a page
        darks = self.measured.darks
        of_mean = self.page_var if darks.pages == 1 else darks.mean_var
        return np.full(darks.mean.shape, of_mean, np.float32)

    @cached_property
    def response(self) -> _Response:
        """Response of the pixels from the flat, or its spread as estimated from the frames."""
        measured, bad = self.measured, self.measured.darks.bad
        if measured.flat_light is not None:
            field = make_flat_field(
                measured.flat_light,
                measured.flat_pages,
                dark_var=self.dark_var,
                bad=bad,
                gain=self.gain.value,
                page_var=self.page_var,
            )
            bad = bad | field.dead
            spread = measure_response_spread(field.response, field.response_var, bad)
            return _Response(field.response, field.response_var, bad, spread)

        # response that is not corrected is noise, the same in every frame
        spread = _NAN if self.estimated is None else self.estimated.response_spread
        flat_var = np.full(bad.shape, float(np.nan_to_num(spread)) ** 2, np.float32)
        return _Response(np.ones(bad.shape, np.float32), flat_var, bad, spread)

    def to_dataset(self) -> xr.Dataset:
        """Images and characteristics under their names in References."""
        measured, darks, transfer = self.measured, self.measured.darks, self.transfer
        gain, read_noise, response = self.gain, self.read_noise, self.response
        images = {
            "dark": (darks.mean, "DN"),
            "dark_var": (self.dark_var, "DN2"),
            "flat": (response.flat, "1"),
            "flat_var": (response.flat_var, "1"),
        }

        # characteristics after EMVA 1288, with the values in use beside the measured ones: value,
        # unit, and name in words
        bend, bend_std = (transfer.bend, transfer.bend_std) if transfer else (_NAN, _NAN)
        numbers: dict[str, tuple[float, str, str]] = {
            "gain": (gain.value, "electron/DN", "gain in use"),
            "gain_measured": (gain.measured, "electron/DN", "gain as measured"),
            "gain_std": (gain.std, "electron/DN", "standard deviation of gain_measured"),
            "bend": (bend, "1", "bend of the photon transfer curve"),
            "bend_std": (bend_std, "1", "standard deviation of bend"),
            "read_noise": (read_noise.value, "electron", "read noise in use"),
            "read_noise_measured": (read_noise.measured, "electron", "read noise as measured"),
            "read_noise_std": (
                read_noise.std,
                "electron",
                "standard deviation of read_noise_measured",
            ),
            "full_scale": (measured.saturation, "DN", "count at which the camera saturates"),
            "dark_signal": (darks.level, "DN", "mean dark level"),
            "dark_signal_std": (
                darks.level_std,
                "DN",
                "standard deviation of dark_signal, from page to page",
            ),
            "dark_spread": (
                darks.spread,
                "DN",
                "standard deviation of the dark level over the pixels (DSNU)",
            ),
            "response_spread": (
                response.spread,
                "1",
                "standard deviation of the response from pixel to pixel (PRNU)",
            ),
            "saturation_capacity": (self.capacity, "electron", "electrons at saturation"),
        }
        # single precision: the images are multiplied with counts of at most 16 bits
        return xr.Dataset(
            {
                name: (("y", "x"), image.astype(np.float32, copy=False), {"units": unit})
                for name, (image, unit) in images.items()
            }
            | {
                "bad": (("y", "x"), response.bad),
                "gain_known": ((), gain.known),
                "read_noise_known": ((), read_noise.known),
                "has_flat": ((), measured.has_flat),
            }
            | {
                name: ((), value, {"units": unit, "long_name": words})
                for name, (value, unit, words) in numbers.items()
            }
        )

    def notes(self) -> Iterator[Note]:
        """Yield notes on gain, read noise and recordings of the camera, in this order."""
        measured, gain, transfer = self.measured, self.gain, self.transfer
        # the comparison is False where no gain was measured, because that gain is NaN
        declared = self.declared.gain
        if declared is not None and abs(declared / gain.measured - 1) > _TOLERATED:
            off = 100 * (declared / gain.measured - 1)
            yield warn(
                self.name,
                f"the declared gain, {declared:g} electron/DN, deviates by {off:+.0f} % from the "
                "measured one; the declared value is used. Check it: every error bar scales with "
                "it.",
            )
        if not gain.known:
            yield warn(
                self.name,
                "neither gain nor flats with two pages of one light level; the gain will be "
                "estimated from the noise of the frames",
            )

        # variance per light of a response f is f'^2/f, which changes three times as much as f
        if transfer is not None and transfer.is_bent:
            yield warn(
                self.name,
                "the photon transfer curve is not straight: variance per light changes by "
                f"{100 * transfer.bend:+.1f} ± {100 * transfer.bend_std:.1f} % from dark to the "
                "brightest flat. A response that departs from linear by about a third of that has "
                "such a curve, or charge that spreads to neighbouring pixels",
            )

        # the measured read noise in electrons scales with the gain: without one there is no
        # comparison
        own, std = self.read_noise.measured, self.read_noise.std
        given = self.declared.read_noise if gain.known else None
        if given is not None and abs(given - own) > _TOLERATED * own + 3 * std:
            yield warn(
                self.name,
                f"the declared read noise, {given:g} electron, differs from the measured one, "
                f"{_with_std(own, std)} electron; the declared value is used.",
            )
        if not self.read_noise.known:
            yield warn(
                self.name,
                "neither read noise nor two dark pages; the read noise will be estimated from the "
                "noise of the frames",
            )

        dry = measured.background
        if dry is not None:
            yield remark(
                self.name,
                f"background of {count_of(dry.pages, 'frame')} of the dry joint subtracted, "
                f"{100 * dry.share:.2g} % of the median light",
            )

        # a pile-up below full scale comes from the sensor or from a range set in the camera
        if measured.saturation < measured.full_scale:
            top = measured.saturation
            yield warn(
                self.name,
                f"counts pile up at {top}, below full scale ({measured.full_scale}): pixels of "
                f"{top} and more count as saturated",
            )
        if not measured.has_flat:
            yield warn(self.name, "no flat; vignetting and pixel response are not corrected")

    def summary(self) -> str:
        """One line: what was measured, and what was declared."""
        # in electrons these three mean nothing without a gain, and are then left out
        measured, spread, known = self.measured, self.response.spread, self.gain.known
        electronic = [
            _describe_quantity("gain", self.gain, "electron/DN", self.declared.gain),
            _describe_quantity("read noise", self.read_noise, "electron", self.declared.read_noise),
        ]
        parts = [
            *(electronic if known else ["gain not known yet"]),
            f"dark {measured.darks.level:.1f} DN",
            *([] if np.isnan(spread) else [f"pixels respond alike within {100 * spread:.1f} %"]),
            f"saturation {measured.saturation:.0f} DN"
            + (f" = {self.capacity:.0f} electron" if known else ""),
        ]
        return ", ".join(parts)


def _describe_background(measured: CameraMeasurement, dataset: xr.Dataset) -> xr.Dataset:
    """Mean light of the dry joint with its variance; zero where one camera alone has none."""
    background = measured.background
    mean, variance = (np.zeros(dataset.dark.shape, np.float32) for _ in range(2))
    if background is not None:
        gain = float(dataset.gain)
        page_var = reading_var(float(dataset.read_noise), gain)
        mean = background.light.astype(np.float32)
        variance = (np.maximum(mean, 0) / gain + page_var).astype(np.float32) / background.pages
    return xr.Dataset(
        {
            "background": (("y", "x"), mean, {"units": "DN"}),
            "background_var": (("y", "x"), variance, {"units": "DN2"}),
            "background_recorded": ((), background is not None),
            "background_pages": ((), 0 if background is None else background.pages),
        }
    )


def _describe_quantity(what: str, quantity: _Quantity, unit: str, declared: float | None) -> str:
    if np.isnan(quantity.measured):
        origin = "declared" if declared is not None else "assumed"
        return f"{what} {quantity.value:g} {unit} ({origin})"
    given = f" (declared {declared:g})" if declared is not None else ""
    return f"{what} {_with_std(quantity.measured, quantity.std)} {unit}{given}"


def _with_std(value: float, std: float) -> str:
    """Value and standard deviation, rounded to the first digit of the latter, or to the second."""
    # the second digit is written where the first is 1: from 1.95 on it would round to 2
    digits = int(np.clip(np.ceil(-np.log10(std / 1.95)), 0, 4)) if std > 0 else 2
    return f"{value:.{digits}f} ± {std:.{digits}f}"
