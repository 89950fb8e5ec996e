"""A finished calibration: ratio against thickness and back, and its form in the file."""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Container, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy
import xarray as xr

from erlif.calibration.departure import Departure
from erlif.calibration.pose import FoundPose
from erlif.calibration.regression import BLACK, Reabsorption
from erlif.calibration.systematics import NO_SYSTEMATICS, Systematics
from erlif.core.arrays import Array
from erlif.core.errors import CalibrationError
from erlif.core.html import card, curve_picture, findings_list, rows_table
from erlif.core.notes import Level, Note, join_notes
from erlif.core.variables import CALIBRATION
from erlif.registration import CameraMap

# Direction of the ratio, the one that rises with thickness; the inverse is refused.
DIRECTION = "camera2/camera1"

# Variables of the fitted points, which every file has.
FITTED_POINTS = ("curve_thickness", "curve_ratio", "curve_ratio_std", "curve_residual")

# K, p and q by their names in the file, and before a reflecting wall a and R.
PARAMETERS = (
    "ratio_at_zero",
    "attenuation_camera1",
    "attenuation_camera2",
    "attenuation_laser",
    "reflectance",
)

# Films at which the end of a curve with a maximum is sought, and its slope there over that at the
# end of the calibrated range.
_BEYOND, _FLAT = 501, 0.1

# Entries of the table of the inverse.
_ENTRIES = 20001

# Films at which its error is computed, and the thinnest one where the range begins at 0. [um]
_FEW, _THINNEST = 1001, 0.02

# Points of the curve in a notebook.
_CURVE_POINTS = 60


class RatioCurve(ABC):
    """A curve from film thickness to the logarithm of the ratio, with its errors.

    Attributes
    ----------
    thickness_range : tuple[float, float]
        Calibrated range. [um]
    systematics : Systematics
        Errors that frames do not show.
    """

    thickness_range: tuple[float, float]
    systematics: Systematics

    @property
    @abstractmethod
    def covered_range(self) -> tuple[float, float]:
        """Thickness covered by the fixture. [um]"""

    @property
    @abstractmethod
    def model(self) -> Reabsorption:
        """The reabsorption model of the fixture."""

    @abstractmethod
    def predict_log(self, thickness: npt.ArrayLike) -> Array:
        """Natural logarithm of the ratio of a film. `thickness` in um."""

    @abstractmethod
    def slope(self, thickness: npt.ArrayLike) -> Array:
        """Derivative of the logarithm of the ratio by thickness. [1/um]"""

    @abstractmethod
    def fitted_gradient(self, thickness: npt.ArrayLike) -> Array:
        """Derivatives of the log ratio by what was fitted to the fixture, (n, ...)."""

    @property
    @abstractmethod
    def fitted_covariance(self) -> Array:
        """Covariance of what was fitted to the fixture, (n, n)."""

    @property
    def moves(self) -> bool:
        """Whether the curve itself changes during a run, not its errors alone."""
        return False

    @property
    def varies(self) -> bool:
        """Whether the curve or its errors change during a run."""
        return False

    def at(self, passed: float) -> RatioCurve:
        """The curve at the time when a share `passed` of the run is over."""
        return self

    def change(self, thickness: npt.ArrayLike) -> Array:
        """Change of the log ratio from the first to the last frame; 0 with one fixture. [1]"""
        return np.zeros(np.shape(thickness))

    def predict(self, thickness: npt.ArrayLike) -> Array:
        """Ratio camera 2 / camera 1 of a film. `thickness` in um."""
        return np.exp(self.predict_log(thickness))

    def gradient(self, thickness: npt.ArrayLike, **at: Any) -> Array:
        """Derivatives of the logarithm of the ratio by all parameters, (n, ...).

        They are those of `fitted_gradient`, then the systematics, with the keywords of
        `Systematics.gradient`.
        """
        fitted, systematics = self.fitted_gradient(thickness), self.systematics
        if not systematics:
            return fitted
        slope, change = self.slope(thickness), self.change(thickness)
        acts = systematics.gradient(thickness, self.model, slope, change, **at)
        return np.concatenate([fitted, acts])

    def by_wall(self, thickness: npt.ArrayLike, reflectance: float | None = None) -> Array:
        """Derivative of the logarithm of the ratio by the reflectance of the wall, 0 to 1. [1]

        `thickness` is in um. The default of `reflectance` is that of the fixture; a wall that it
        does not show is black.
        """
        wall = self.model.with_wall
        if reflectance is not None:
            wall = Reabsorption(np.append(wall.parameters[:-1], reflectance))
        return wall.ratio(np.asarray(thickness, float)).by_reflectance

    def film_gradient(self, thickness: npt.ArrayLike, **at: Any) -> Array:
        """Derivatives of the film of a measured ratio by all parameters, (n, ...).

        The keywords are those of `Systematics.gradient`. Without a place, `anywhere_covariance` is
        the covariance that belongs to them.
        """
        return np.asarray(-self.gradient(thickness, **at) / self.slope(thickness))

    @property
    def full_covariance(self) -> Array:
        """Covariance of all parameters, (n, n), in the order of `gradient`."""
        return self.systematics.extend(self.fitted_covariance)

    @property
    def anywhere_covariance(self) -> Array:
        """`full_covariance` of films whose place in the picture is not known, (n, n)."""
        return self.systematics.anywhere(self.full_covariance)

    def split_error(self, gradient: Array, *, anywhere: bool = False) -> dict[str, float]:
        """Standard deviation of a quantity by the fixture's frames and by each systematic term.

        Parameters
        ----------
        gradient : array, (parameter,)
            Change of the quantity with all fitted parameters.
        anywhere : bool
            Whether it is that of a film whose place in the picture is not known.

        Returns
        -------
        dict of str to float
            "calibration", then the terms that have an error: the root of their covariance with the
            whole error, 0 where they lower it, scaled to add up to it. [unit of the quantity]
        """
        return self.split_errors([gradient], anywhere=anywhere)[0]

    def split_errors(
        self, gradients: Sequence[Array], *, anywhere: bool = False
    ) -> list[dict[str, float]]:
        """Split the standard deviations of several quantities as `split_error` does."""
        whole = self.anywhere_covariance if anywhere else self.full_covariance
        own = ("calibration",) * (len(whole) - len(self.systematics.terms))
        terms = np.array([*own, *self.systematics.terms])
        found = []
        for gradient in gradients:
            parts = gradient * (whole @ gradient)
            names = dict.fromkeys([*own[:1], *terms[parts != 0].tolist()])
            split = {name: max(float(parts[terms == name].sum()), 0.0) for name in names}
            scale = float(parts.sum()) / max(sum(split.values()), np.finfo(float).tiny)
            found.append({name: float(np.sqrt(scale * part)) for name, part in split.items()})
        return found

    def log_ratio_std(self, thickness: npt.ArrayLike) -> Array:
        """Standard deviation of the predicted logarithm of the ratio. [1]"""
        gradient, covariance = self.gradient(thickness), self.anywhere_covariance
        variance: Array = (gradient * np.tensordot(covariance, gradient, 1)).sum(axis=0)
        return np.sqrt(np.maximum(variance, 0.0))

    def thickness_std(self, thickness: npt.ArrayLike) -> Array:
        """Standard deviation of a thickness due to the calibration alone. [um]"""
        return np.asarray(self.log_ratio_std(thickness) / self.slope(thickness))

    @cached_property
    def inverse(self) -> InverseTable:
        """Table from the logarithm of the ratio to thickness, for whole images."""
        return InverseTable.of(self)


@dataclass(frozen=True)
class InverseTable:
    """Thickness, slope and calibration error on an even grid of the logarithm of the ratio.

    Attributes
    ----------
    start : float
        Logarithm of the ratio at the first entry. [1]
    step : float
        Distance of the entries in the logarithm of the ratio. [1]
    thickness : Array
        Film thickness, (entry,). [um]
    per_log_ratio : Array
        Derivative of the thickness by the logarithm of the ratio, (entry,). [um]
    calibration_std : Array
        Standard deviation of the thickness due to the calibration, (entry,). [um]
    """

    start: float
    step: float
    thickness: Array
    per_log_ratio: Array
    calibration_std: Array

    @classmethod
    def of(cls, calibration: RatioCurve) -> InverseTable:
        """Tabulate the inverse over the range of the fixture.

        Linear interpolation in it is good to 1e-5 um.
        """
        low, high = calibration.covered_range
        first, last = calibration.predict_log([low, high])
        grid = np.linspace(first, last, _ENTRIES)

        # one step of Newton from a dense direct table, which is off by 1e-7 um, reaches rounding
        dense = np.linspace(low, high, _ENTRIES)
        thickness = np.interp(grid, calibration.predict_log(dense), dense)
        thickness -= (calibration.predict_log(thickness) - grid) / calibration.slope(thickness)
        thickness = np.clip(thickness, low, high)

        # the error of the ratio changes slowly with the film
        per_log_ratio = 1 / calibration.slope(thickness)
        few = np.geomspace(max(low, _THINNEST), high, _FEW)
        error = np.interp(thickness, few, calibration.log_ratio_std(few))
        return cls(
            start=float(first),
            step=float(grid[1] - grid[0]),
            thickness=thickness,
            per_log_ratio=per_log_ratio,
            calibration_std=per_log_ratio * error,
        )

    @cached_property
    def log_ratio(self) -> Array:
        """Logarithm of the ratio of each entry, (entry,). [1]"""
        return np.asarray(self.start + self.step * np.arange(self.thickness.size))

    def look_up(self, log_ratio: Array) -> Array:
        """Thickness by linear interpolation, that of the ends beyond them. [um]"""
        return np.interp(log_ratio, self.log_ratio, self.thickness)


@dataclass(frozen=True, repr=False)
class Calibration(RatioCurve):
    """The reabsorption model fitted to a fixture, with the departure from it where one was found.

    Made by `fit_calibration` and `open_calibration` only, so it is always complete.

    Attributes
    ----------
    ratio_at_zero : float
        K, ratio camera 2 / camera 1 of a vanishing film. [1]
    attenuation_camera1 : float
        p, attenuation in the band of camera 1. [1/um]
    attenuation_camera2 : float
        q, attenuation in the band of camera 2. [1/um]
    covariance : Array
        Covariance of the parameters, (parameter, parameter): K, p and q, and a and R before a
        reflecting wall.
    thickness_range : tuple[float, float]
        Calibrated range. [um]
    bands : tuple[float, float]
        Filter bands of camera 1 and 2. [nm]
    curve : xr.Dataset
        The fitted points: curve_thickness [um], curve_ratio, curve_ratio_std, curve_residual
        [1], curve_x and, for a surface, curve_y [mm]; each (bin).
    reduced_chi_square : float
        Scatter of the points in units of the stated variance. [1]
    fixture : str
        Name of the fixture.
    notes : tuple[Note, ...]
        What was found about fit, profile and cameras.
    input_hashes : dict[str, str]
        SHA-256 of every input by its name.
    date : str
        Day on which the fixture was photographed.
    camera_map : CameraMap | None
        Map from camera 1 to camera 2 on the fixture, for runs of the same rig.
    departure : Departure | None
        Spline added to the logarithm of the modelled ratio, where the data require one.
    pose : FoundPose | None
        Refined pose of the fixture, if it was refined.
    profile_file : str
        Name of the CMM profile among `input_hashes`; empty where it is not recorded.
    systematics : Systematics
        Errors of the fixture that its frames do not show.
    attenuation_laser : float | None
        a, attenuation of the laser alone; None where the wall behind the film is black. [1/um]
    reflectance : float | None
        R, share of laser and emission that the wall behind the film returns; None likewise. [1]
    temperature : float | None
        Of the oil of the fixture; None where it is not known. [degree_Celsius]
    pixel_pitch : float | None
        With which the profile was laid over the image; None where it is not known. [mm]
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
    notes: tuple[Note, ...] = ()
    input_hashes: dict[str, str] = field(default_factory=dict, repr=False)
    date: str = ""
    camera_map: CameraMap | None = field(default=None, repr=False)
    departure: Departure | None = field(default=None, repr=False)
    pose: FoundPose | None = field(default=None, repr=False)
    profile_file: str = field(default="", repr=False)
    systematics: Systematics = field(default=NO_SYSTEMATICS, repr=False)
    attenuation_laser: float | None = None
    reflectance: float | None = None
    temperature: float | None = None
    pixel_pitch: float | None = None

    def __repr__(self) -> str:
        lines = [f"calibration {self.fixture!r}"]
        lines += [f"  {name:<36}{value}" for name, value in self._describe()]
        warnings = [note for note in self.notes if note.level is not Level.NOTE]
        return "\n".join([*lines, *(f"  {note.level.value}: {note}" for note in warnings)])

    def _repr_html_(self) -> str:
        return card(
            f"calibration {self.fixture}",
            self.date,
            rows_table(self._describe()),
            self._draw(),
            findings_list([(note.level, str(note)) for note in self.notes]),
        )

    def _describe(self) -> list[tuple[str, str]]:
        """Parameters, ranges and quality by name and value."""
        values, std = self.parameters, self.standard_deviations
        low, high = self.thickness_range
        one, two = self.bands
        rows = [
            ("K, ratio of a vanishing film", f"{values[0]:.5f} ± {std[0]:.5f}"),
            ("p, attenuation camera 1", f"{values[1]:.5f} ± {std[1]:.5f} 1/um"),
            ("q, attenuation camera 2", f"{values[2]:.5f} ± {std[2]:.5f} 1/um"),
        ]
        if self.model.reflects:
            rows += [
                ("a, attenuation of the laser", f"{values[3]:.3f} ± {std[3]:.3f} 1/um"),
                ("R, reflectance of the wall", f"{values[4]:.3f} ± {std[4]:.3f}"),
            ]
        rows += [
            ("calibrated range", f"{low:.2f} to {high:.2f} um"),
            ("reduced chi-square", f"{self.reduced_chi_square:.2f}"),
            ("bands", f"{one:g} nm and {two:g} nm"),
        ]
        if "curve_ratio" in self.curve:
            rows.append(("fitted points", f"{self.curve.curve_ratio.size}"))
        if self.departure is not None:
            rows.append(("departure from the model", "spline"))
        return rows

    def _draw(self) -> str:
        """Ratio against thickness as a small picture; empty without fitted points."""
        if "curve_ratio" not in self.curve:
            return ""
        thickness = np.linspace(*self.covered_range, _CURVE_POINTS)
        return curve_picture(
            (thickness, self.predict(thickness)),
            (self.curve.curve_thickness.values, self.curve.curve_ratio.values),
            labels=("film thickness [um]", "ratio camera 2 / camera 1"),
        )

    @property
    def covered_range(self) -> tuple[float, float]:
        """Thickness covered by the fixture. [um]

        It may extend beyond `thickness_range`: a pixel whose film lies within that range may
        exceed it by its noise, and is then still measured.
        """
        return self.covered_by(self)

    def covered_by(self, curve: RatioCurve) -> tuple[float, float]:
        """Thickness that the fixture covers, by a curve made from this one. [um]"""
        low, high = curve.thickness_range
        measured = self.curve.get("curve_thickness")
        thickest = high if measured is None else max(high, float(measured.max()))

        # a ratio with a maximum has its inverse up to there alone
        films = np.linspace(high, thickest, _BEYOND)
        slope = curve.slope(films)
        if (slope > 0).all():
            return low, thickest
        flat = slope < _FLAT * slope[0]
        return low, float(films[max(int(np.argmax(flat)) - 1, 0)])

    @property
    def parameters(self) -> Array:
        """K [1], p and q [1/um]; before a reflecting wall also a [1/um] and R [1]."""
        values = (getattr(self, name) for name in PARAMETERS)
        return np.array([value for value in values if value is not None])

    @property
    def standard_deviations(self) -> Array:
        """Standard deviations of the parameters, (parameter,)."""
        return np.sqrt(np.diag(self.covariance))

    @cached_property
    def model(self) -> Reabsorption:
        """The reabsorption model alone."""
        return Reabsorption(self.parameters)

    def predict_log(self, thickness: npt.ArrayLike) -> Array:
        """Natural logarithm of the ratio of a film, departure included. `thickness` in um."""
        found = self.model.predict(thickness)
        return found if self.departure is None else found + self.departure.predict(thickness)

    def slope(self, thickness: npt.ArrayLike) -> Array:
        """Derivative of the logarithm of the ratio by thickness. [1/um]"""
        found = self.model.slope(thickness)
        return found if self.departure is None else found + self.departure.slope(thickness)

    def fitted_gradient(self, thickness: npt.ArrayLike) -> Array:
        """Derivatives of the log ratio by the parameters, then those of the departure, (n, ...)."""
        of_model = self.model.gradient(thickness)
        if self.departure is None:
            return of_model
        return np.concatenate([of_model, self.departure.basis(thickness)])

    @property
    def fitted_covariance(self) -> Array:
        """Covariance of parameters and departure, (n, n), in the order of `fitted_gradient`."""
        if self.departure is None:
            return self.covariance
        return np.asarray(scipy.linalg.block_diag(self.covariance, self.departure.covariance))

    def range_shared_with(self, other: Calibration) -> tuple[float, float]:
        """Lower and upper end of the films that another calibration covers as well. [um]"""
        (one, two), (three, four) = self.thickness_range, other.thickness_range
        low, high = max(one, three), min(two, four)
        if low >= high:
            raise CalibrationError(
                f"Expected calibrations that share a range of films; one covers {one:.2f} to "
                f"{two:.2f} um, the other {three:.2f} to {four:.2f} um. Compare calibrations of "
                "the same fixture."
            )
        return low, high

    def to_dataset(self) -> xr.Dataset:
        """Variables of ``calibration.nc``."""
        values: dict[str, npt.ArrayLike] = {
            **dict(zip(PARAMETERS, self.parameters, strict=False)),
            "reduced_chi_square": self.reduced_chi_square,
            "covariance": self.covariance,
            "thickness_range": list(self.thickness_range),
        }
        if self.departure is not None:
            values |= self.departure.variables()

        dataset = self.curve.assign({name: CALIBRATION[name].fill(values[name]) for name in values})
        names = list(PARAMETERS[: self.parameters.size])
        return dataset.assign_coords(parameter=("parameter", names))

    @property
    def attributes(self) -> dict[str, Any]:
        """Global attributes of ``calibration.nc``.

        ``notes`` are lines for the reader; ``note_records`` are the same notes with level and
        subject, as JSON. ``profile_file`` names the CMM profile among ``input_hashes``.
        ``systematics`` are the errors of the fixture that its frames do not show.
        """
        return {
            "band_camera1_nm": self.bands[0],
            "band_camera2_nm": self.bands[1],
            "ratio_direction": DIRECTION,
            "fixture": self.fixture,
            "notes": join_notes(self.notes),
            "note_records": json.dumps([[n.level.value, n.subject, n.text] for n in self.notes]),
            "input_hashes": json.dumps(self.input_hashes, sort_keys=True),
            "profile_file": self.profile_file,
            "date": self.date,
            **({} if self.temperature is None else {"temperature_degC": self.temperature}),
            **({} if self.pixel_pitch is None else {"pixel_pitch_mm": self.pixel_pitch}),
            **{
                name: json.dumps(part.to_record())
                for name, part in (("pose", self.pose), ("systematics", self.systematics))
                if part
            },
        }

    @classmethod
    def from_dataset(cls, dataset: xr.Dataset) -> Calibration:
        """Calibration from the variables and attributes of its file.

        Raises
        ------
        CalibrationError
            If a variable or attribute is missing, or the ratio is inverted.
        """
        attrs = dataset.attrs
        try:
            if attrs["ratio_direction"] != DIRECTION:
                raise CalibrationError(
                    f"Expected a calibration of the ratio {DIRECTION}; this one is of "
                    f"{attrs['ratio_direction']}. Calibrate again with erlif, with the reabsorbed "
                    "band on camera 1."
                )

            # figures and the comparison of two calibrations need the fitted points
            for name in FITTED_POINTS:
                if name not in dataset:
                    raise KeyError(name)
            names = [name for name in dataset.variables if str(name).startswith("curve_")]
            low, high = (float(bound) for bound in dataset.thickness_range.values)
            pose = FoundPose.from_record(json.loads(attrs["pose"])) if "pose" in attrs else None
            parameters: dict[str, Any] = {
                name: float(dataset[name]) for name in parameters_in(dataset)
            }
            return cls(
                **parameters,
                covariance=np.asarray(dataset.covariance.values, float),
                thickness_range=(low, high),
                bands=(float(attrs["band_camera1_nm"]), float(attrs["band_camera2_nm"])),
                curve=dataset[names].reset_coords(drop=True).drop_attrs(deep=False),
                reduced_chi_square=float(dataset.reduced_chi_square),
                fixture=str(attrs["fixture"]),
                notes=tuple(
                    Note(Level(level), subject, text)
                    for level, subject, text in json.loads(attrs["note_records"])
                ),
                input_hashes=json.loads(attrs["input_hashes"]),
                profile_file=str(attrs["profile_file"]),
                date=str(attrs["date"]),
                temperature=(
                    float(attrs["temperature_degC"]) if "temperature_degC" in attrs else None
                ),
                pixel_pitch=(float(attrs["pixel_pitch_mm"]) if "pixel_pitch_mm" in attrs else None),
                departure=Departure.from_dataset(dataset),
                pose=pose,
                systematics=(
                    Systematics.from_record(json.loads(attrs["systematics"]))
                    if "systematics" in attrs
                    else NO_SYSTEMATICS
                ),
            )
        except (KeyError, AttributeError) as error:
            raise foreign_file(f"{error} is missing from this file") from error


def foreign_file(reason: str) -> CalibrationError:
    """The error of a file that is no calibration."""
    return CalibrationError(
        f"Expected a calibration as erlif calibrate writes it; {reason}. Make one with: erlif "
        "calibrate FIXTURE_DIR"
    )


def parameters_in(names: Container[Any]) -> tuple[str, ...]:
    """Parameters of a calibration in a file or record: those of the wall only if it reflects.

    Parameters
    ----------
    names : container of str
        What the file or record holds.

    Returns
    -------
    tuple of str

    Examples
    --------
    >>> parameters_in({"reflectance"})[-1]
    'reflectance'
    >>> len(parameters_in({}))
    3
    """
    return PARAMETERS if PARAMETERS[-1] in names else PARAMETERS[:BLACK]
