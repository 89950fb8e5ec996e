"""A finished calibration: ratio against thickness and back, and its file."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy.linalg import block_diag
from scipy.optimize import brentq

from erlif.calibration.departure import Departure
from erlif.calibration.pose import FoundPose
from erlif.core.arrays import Array
from erlif.core.errors import CalibrationError
from erlif.models.fluorescence import log_band_ratio, log_band_ratio_gradient, log_band_ratio_slope
from erlif.registration import CameraMap

DIRECTION = "camera2/camera1"
"""The ratio that rises with thickness; the other way round is refused."""


@dataclass(frozen=True)
class Calibration:
    """The reabsorption model fitted to a fixture, with what departs from it: ratio against thickness and back.

    Attributes
    ----------
    ratio_at_zero, attenuation_camera1, attenuation_camera2 : float
        K [1], p and q [1/um] of `erlif.models.fluorescence.log_band_ratio`.
    covariance : array, (3, 3)
        Of K, p and q, in this order.
    thickness_range : (float, float)
        Where the calibration answers. [um]
    bands : (float, float)
        Filter bands of camera 1 and 2. [nm]
    curve : xarray.Dataset
        curve_thickness, curve_ratio, curve_ratio_std, curve_residual (bin): what was fitted.
    reduced_chi_square : float
    fixture : str
    notes : tuple of str
        What the fit has to say of itself.
    input_hashes : dict of str to str
    date : str
        When the fixture was photographed.
    camera_map : CameraMap or None
        Map from camera 1 to camera 2 on the fixture, for runs of the same rig.
    departure : Departure or None
        Spline added to the logarithm of the modelled ratio, where the fixture insisted on one.
    pose : FoundPose or None
        Where the fixture was found to lie, if its pose was refined.
    """

    ratio_at_zero: float
    attenuation_camera1: float
    attenuation_camera2: float
    covariance: Array
    thickness_range: tuple[float, float]
    bands: tuple[float, float]
    curve: xr.Dataset = field(repr=False)
    reduced_chi_square: float
    fixture: str
    notes: tuple[str, ...] = ()
    input_hashes: dict[str, str] = field(default_factory=dict, repr=False)
    date: str = ""
    camera_map: CameraMap | None = field(default=None, repr=False)
    departure: Departure | None = field(default=None, repr=False)
    pose: FoundPose | None = field(default=None, repr=False)

    @property
    def covered_range(self) -> tuple[float, float]:
        """Thickness the fixture covers; as far a noisy pixel may be read off, if its film is within thickness_range. [um]"""
        low, high = self.thickness_range
        measured = self.curve.get("curve_thickness")
        return low, high if measured is None else max(high, float(measured.max()))

    @property
    def parameters(self) -> Array:
        """K [1], p and q [1/um]."""
        return np.array([self.ratio_at_zero, self.attenuation_camera1, self.attenuation_camera2])

    @property
    def standard_deviations(self) -> Array:
        """Of K, p and q."""
        return np.sqrt(np.diag(self.covariance))

    def predict(self, thickness: npt.ArrayLike) -> Array:
        """Ratio camera 2 / camera 1 of a film. `thickness` in um."""
        return np.exp(self.predict_log(thickness))

    def predict_log(self, thickness: npt.ArrayLike) -> Array:
        """Natural logarithm of the ratio of a film, the departure from the model included. `thickness` in um."""
        K, p, q = self.parameters
        modelled = np.asarray(
            log_band_ratio(thickness, ratio_at_zero=K, attenuation_camera1=p, attenuation_camera2=q)
        )
        return modelled if self.departure is None else modelled + self.departure.predict(thickness)

    def slope(self, thickness: npt.ArrayLike) -> Array:
        """Derivative of the logarithm of the ratio by thickness. [1/um]"""
        _, p, q = self.parameters
        modelled = np.asarray(
            log_band_ratio_slope(thickness, attenuation_camera1=p, attenuation_camera2=q)
        )
        return modelled if self.departure is None else modelled + self.departure.slope(thickness)

    def parameter_gradient(self, thickness: npt.ArrayLike) -> Array:
        """Derivatives of the logarithm of the ratio by K, p and q, (3, ...)."""
        K, p, q = self.parameters
        return log_band_ratio_gradient(
            thickness, ratio_at_zero=K, attenuation_camera1=p, attenuation_camera2=q
        )

    def gradient(self, thickness: npt.ArrayLike) -> Array:
        """Derivatives of the logarithm of the ratio by all that was fitted, (n, ...): K, p, q, and the departure's coefficients."""
        modelled = self.parameter_gradient(thickness)
        return (
            modelled
            if self.departure is None
            else np.concatenate([modelled, self.departure.basis(thickness)])
        )

    @property
    def full_covariance(self) -> Array:
        """Covariance of all that was fitted, (n, n), in the order of `gradient`."""
        return (
            self.covariance
            if self.departure is None
            else block_diag(self.covariance, self.departure.covariance)
        )

    def log_ratio_std(self, thickness: npt.ArrayLike) -> Array:
        """Standard deviation that the calibration leaves in the logarithm of the ratio."""
        gradient = self.gradient(thickness)
        variance: Array = np.einsum("i...,ij,j...->...", gradient, self.full_covariance, gradient)
        return np.sqrt(np.maximum(variance, 0.0))

    def thickness_std(self, thickness: npt.ArrayLike) -> Array:
        """Standard deviation that the calibration alone leaves in a thickness. [um]"""
        return np.asarray(self.log_ratio_std(thickness) / self.slope(thickness))

    @cached_property
    def inverse(self) -> InverseTable:
        """Table from the logarithm of the ratio to thickness, for whole images."""
        return InverseTable.of(self)

    def invert(self, log_ratio: npt.ArrayLike) -> Array:
        """Thickness at which the model has this logarithm of the ratio, by root finding; NaN beyond the range. [um]"""
        low, high = self.thickness_range
        values = np.asarray(log_ratio, float)
        limits = self.predict_log([low, high])
        found = [
            brentq(lambda t, goal=goal: float(self.predict_log(t)) - goal, low, high, xtol=1e-10)
            if limits[0] <= goal <= limits[1]
            else math.nan
            for goal in values.ravel()
        ]
        return np.array(found).reshape(values.shape)

    def to_dataset(self) -> xr.Dataset:
        """The calibration as it is stored in ``calibration.nc``."""
        K, p, q = self.parameters
        low, high = self.thickness_range
        dataset = self.curve.copy()
        scalars = {
            "ratio_at_zero": (K, "1", "ratio of a vanishing film, K"),
            "attenuation_camera1": (p, "um-1", "attenuation in the band of camera 1, p"),
            "attenuation_camera2": (q, "um-1", "attenuation in the band of camera 2, q"),
            "reduced_chi_square": (self.reduced_chi_square, "1", "of the fit"),
        }
        for name, (value, unit, meaning) in scalars.items():
            dataset[name] = ((), value, {"units": unit, "long_name": meaning})
        dataset["covariance"] = (
            ("parameter", "parameter2"),
            self.covariance,
            {
                "long_name": "covariance of K, p, q",
                "comment": "both dimensions in the order of parameter",
            },
        )
        dataset["thickness_range"] = (
            "bound",
            [low, high],
            {"units": "um", "long_name": "where the calibration answers"},
        )
        if self.departure is not None:
            self.departure.describe(dataset)
        dataset["parameter"] = (
            "parameter",
            ["ratio_at_zero", "attenuation_camera1", "attenuation_camera2"],
        )
        return dataset

    @property
    def attributes(self) -> dict[str, Any]:
        """Global attributes of ``calibration.nc``."""
        return {
            "band_camera1_nm": self.bands[0],
            "band_camera2_nm": self.bands[1],
            "ratio_direction": DIRECTION,
            "fixture": self.fixture,
            "notes": "\n".join(self.notes),
            "input_hashes": json.dumps(self.input_hashes, sort_keys=True),
            "date": self.date,
            **({} if self.pose is None else {"pose": json.dumps(self.pose.to_record())}),
        }

    @classmethod
    def from_dataset(cls, dataset: xr.Dataset) -> Calibration:
        """Rebuild a calibration from its file.

        Raises
        ------
        CalibrationError
            If a variable or attribute is missing, or the ratio is the other way round.
        """
        try:
            if dataset.attrs["ratio_direction"] != DIRECTION:
                raise CalibrationError(
                    f"Expected a calibration of the ratio {DIRECTION}; this one is of {dataset.attrs['ratio_direction']}. "
                    "Calibrate again with erlif, with the reabsorbed band on camera 1."
                )
            names = [name for name in dataset.variables if str(name).startswith("curve_")]
            low, high = (float(bound) for bound in dataset.thickness_range.values)
            return cls(
                ratio_at_zero=float(dataset.ratio_at_zero),
                attenuation_camera1=float(dataset.attenuation_camera1),
                attenuation_camera2=float(dataset.attenuation_camera2),
                covariance=np.asarray(dataset.covariance.values, float),
                thickness_range=(low, high),
                bands=(
                    float(dataset.attrs["band_camera1_nm"]),
                    float(dataset.attrs["band_camera2_nm"]),
                ),
                curve=dataset[names].reset_coords(drop=True).drop_attrs(deep=False),
                reduced_chi_square=float(dataset.reduced_chi_square),
                fixture=str(dataset.attrs["fixture"]),
                notes=tuple(
                    note for note in str(dataset.attrs.get("notes", "")).split("\n") if note
                ),
                input_hashes=json.loads(dataset.attrs.get("input_hashes", "{}")),
                date=str(dataset.attrs.get("date", "")),
                departure=Departure.from_dataset(dataset),
                pose=FoundPose.from_record(json.loads(dataset.attrs["pose"]))
                if "pose" in dataset.attrs
                else None,
            )
        except (KeyError, AttributeError) as error:
            raise CalibrationError(
                f"Expected a calibration as erlif calibrate writes it; {error} is missing from this file."
            ) from error


@dataclass(frozen=True)
class InverseTable:
    """Thickness, slope and calibration error on an even grid of the logarithm of the ratio.

    Attributes
    ----------
    start, step : float
        Logarithm of the ratio at the first entry, and the distance of entries.
    thickness : array, (entry,)
        [um]
    per_log_ratio : array, (entry,)
        Derivative of thickness by the logarithm of the ratio. [um]
    calibration_std : array, (entry,)
        Standard deviation that the calibration leaves in the thickness. [um]
    """

    start: float
    step: float
    thickness: Array
    per_log_ratio: Array
    calibration_std: Array

    @classmethod
    def of(cls, calibration: Calibration, entries: int = 20001) -> InverseTable:
        """Tabulate the inverse over what the fixture covers; linear interpolation is good to 1e-5 um."""
        low, high = calibration.covered_range
        first, last = calibration.predict_log([low, high])
        grid = np.linspace(first, last, entries)
        # Newton's steps from a dense direct table: the curve is monotonic and smooth
        dense = np.linspace(low, high, entries)
        thickness = np.interp(grid, calibration.predict_log(dense), dense)
        for _ in range(3):
            thickness -= (calibration.predict_log(thickness) - grid) / calibration.slope(thickness)
        thickness = np.clip(thickness, low, high)
        return cls(
            float(first),
            float(grid[1] - grid[0]),
            thickness,
            1 / calibration.slope(thickness),
            calibration.thickness_std(thickness),
        )


def share_bands(bands: tuple[float, float], others: tuple[float, float]) -> bool:
    """Whether the filter bands of camera 1 and 2 are the same to 1 nm. [nm]"""
    return bool(np.allclose(bands, others, rtol=0.0, atol=1.0))


def check_bands(calibration: Calibration, bands: tuple[float, float]) -> None:
    """Refuse a calibration of other filter bands.

    Raises
    ------
    CalibrationError
        If a band differs by more than 1 nm, recognising exchanged cameras.
    """
    if share_bands(calibration.bands, bands):
        return
    swapped = (
        " The bands are exchanged: the cameras look swapped."
        if share_bands(calibration.bands, bands[::-1])
        else ""
    )
    raise CalibrationError(
        f"Expected a calibration of the bands of the run, {bands[0]:g} and {bands[1]:g} nm; got one of {calibration.bands[0]:g} and "
        f"{calibration.bands[1]:g} nm.{swapped} Calibrate with the filters of the run."
    )
