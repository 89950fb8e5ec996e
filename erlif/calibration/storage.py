"""calibration.nc, written and read; and the calibration as film.nc records it."""

from __future__ import annotations

import json
import math
import warnings
from dataclasses import asdict, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from erlif.calibration.curve import (
    PARAMETERS,
    Calibration,
    RatioCurve,
    foreign_file,
    parameters_in,
)
from erlif.calibration.departure import Departure
from erlif.calibration.run_curve import RunCurve
from erlif.calibration.soundness import check_calibration, check_file
from erlif.calibration.systematics import NO_SYSTEMATICS, Systematics
from erlif.core.errors import (
    CalibrationError,
    ErlifError,
    OutputError,
    RegistrationError,
    reason_of,
)
from erlif.core.format import LaterVersionError, describe_origin, is_version_after
from erlif.core.notes import warn
from erlif.core.version import __version__
from erlif.io.files import (
    has_group,
    open_netcdf,
    refuse_existing,
    settings_of,
    takes,
    write_dataset,
)
from erlif.io.files.kinds import KINDS, kind_of
from erlif.io.settings import RunSettings
from erlif.registration import CameraMap

# Products whose files are no calibrations.
_OTHERS = ("film", "prediction", "pressure", "comparison", "budget")


@takes(calibration="calibration")
def save_calibration(
    calibration: Calibration, output: str | Path, *, overwrite: bool = False
) -> Path:
    """Write ``calibration.nc``, whole or not at all.

    Parameters
    ----------
    calibration : Calibration
        Result of `fit_calibration`.
    output, overwrite
        The file, as for `erlif.export`.

    Returns
    -------
    Path

    Raises
    ------
    OutputError
        If the file exists and `overwrite` is not set, or cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.show.plots import example_calibration
    >>> with TemporaryDirectory() as directory:
    ...     path = save_calibration(example_calibration(), Path(directory) / "calibration.nc")
    ...     open_calibration(path).parameters
    array([0.66 , 0.39 , 0.245])
    """
    output = Path(output)
    refuse_existing(output, overwrite=overwrite, holds="ratio_at_zero")
    dataset = calibration.to_dataset().assign_attrs(
        **describe_origin("ERLIF calibration", "calibrate"), **calibration.attributes
    )
    groups = {}
    if calibration.camera_map is not None:
        groups["registration"] = calibration.camera_map.to_dataset()
    write_dataset(dataset, output, groups=groups)
    return output


@takes(path="path")
def open_calibration(path: str | Path) -> Calibration:
    """Read ``calibration.nc``.

    Parameters
    ----------
    path : path
        File that `save_calibration` wrote, in this version of erlif or an earlier one.

    Returns
    -------
    Calibration
        With its notes and its camera map.

    Raises
    ------
    CalibrationError
        If the file is missing, damaged or no calibration.

    Examples
    --------
    >>> open_calibration("missing.nc")
    Traceback (most recent call last):
        ...
    erlif.core.errors.CalibrationError: Expected a calibration file; missing.nc does not exist. \
Make one with: erlif calibrate FIXTURE_DIR
    """
    path = Path(path)
    if path.is_dir():
        raise CalibrationError(
            f"Expected a calibration file; {path} is a directory. Name its file: "
            f"{path / 'calibration.nc'}"
        )
    if not path.is_file():
        raise CalibrationError(
            f"Expected a calibration file; {path} does not exist. Make one with: erlif calibrate "
            "FIXTURE_DIR"
        )

    try:
        with warnings.catch_warnings():
            # the file format allows covariance (parameter, parameter), about which xarray warns
            warnings.filterwarnings("ignore", "Duplicate dimension names", UserWarning)
            return _read(path)
    except ErlifError:
        raise
    except LaterVersionError as error:
        raise CalibrationError(
            f"Expected a calibration of erlif {__version__} or earlier in {path}; {error}. Install "
            "a later one, or calibrate again with: erlif calibrate FIXTURE_DIR"
        ) from error
    except Exception as error:  # damaged bytes make HDF5 raise errors of any kind
        reason = f"{path} is damaged or something else ({reason_of(error)})"
        raise foreign_file(reason) from error


def _read(path: Path) -> Calibration:
    """A calibration from its file, its numbers checked."""
    with open_netcdf(path) as dataset:
        kind = kind_of(dataset)
        if kind in _OTHERS:
            raise CalibrationError(
                f"Expected a calibration as erlif calibrate writes it; {path} holds "
                f"{KINDS[kind].words}. Name the calibration in its place; it is made with: erlif "
                "calibrate FIXTURE_DIR"
            )
        check_file(dataset)
        calibration = Calibration.from_dataset(dataset.load())
        written = str(dataset.attrs.get("erlif_version", ""))
    if is_version_after(written, __version__):
        note = warn(
            "",
            f"it was written by erlif {written[:40]}, this is {__version__}: what later versions "
            "add is not read. Update erlif, or calibrate again",
        )
        calibration = replace(calibration, notes=(note, *calibration.notes))
    check_calibration(calibration)
    if not has_group(path, "registration"):
        return calibration
    with open_netcdf(path, group="registration") as dataset:
        check_file(dataset)
        try:
            camera_map = CameraMap.from_dataset(dataset.load())
        except RegistrationError as error:
            reason, _, _ = str(error).partition(";")
            raise ValueError(reason) from error
    for component in (camera_map.displacement_x, camera_map.displacement_y):
        if np.isinf(component).any() or np.isnan(component).all():
            raise ValueError("its camera map has no finite displacements")
    return replace(calibration, camera_map=camera_map)


def record_calibration(curve: RunCurve) -> str:
    """The part of a calibration that determines a film, as JSON.

    Parameters
    ----------
    curve : RunCurve
        With which a run was measured.

    Returns
    -------
    str
        Parameters, covariance, ranges [um], departure, input hashes, and the same of the fixture
        after the run; `calibration_of` reads it.

    Examples
    --------
    >>> calibration = Calibration(
    ...     0.65, 0.40, 0.25, np.eye(3), (0.1, 12.0), (580.0, 610.0), xr.Dataset(), 1.0, "wedge"
    ... )
    >>> json.loads(record_calibration(RunCurve.of(calibration)))["thickness_range"]
    [0.1, 12.0]
    """
    kept = _record_of(curve.calibration, curve)
    if curve.systematics:
        kept["systematics"] = curve.systematics.to_record()
    if curve.later is not None:
        kept["later"] = _record_of(curve.later, curve.later)
    return json.dumps(kept, sort_keys=True)


def _record_of(calibration: Calibration, curve: RatioCurve) -> dict[str, Any]:
    """Parameters and origin of a calibration, and the ranges of a curve made from it."""
    kept = dict(zip(PARAMETERS, calibration.parameters, strict=False)) | {
        "fixture": calibration.fixture,
        "date": calibration.date,
        "covariance": calibration.covariance.tolist(),
        "thickness_range": list(curve.thickness_range),
        "covered_range": list(curve.covered_range),
        "input_hashes": calibration.input_hashes,
    }
    departure = calibration.departure
    if departure is not None:
        kept["departure"] = {name: each.tolist() for name, each in asdict(departure).items()}
    if calibration.temperature is not None:
        kept["temperature"] = calibration.temperature
    return kept


def calibration_of(film: xr.Dataset, trigger: int | None = None) -> RunCurve:
    """The calibration that a film was made with.

    Its curve holds the covered range alone: a film stores the parameters, not the fitted points.

    Parameters
    ----------
    film : xarray.Dataset
        film.nc, opened.
    trigger : int, optional
        At which what changes during the run is taken; default: as the record holds it.

    Returns
    -------
    RunCurve

    Raises
    ------
    OutputError
        If the film does not hold it, or holds numbers that no fit gives.

    Examples
    --------
    >>> calibration_of(xr.Dataset())
    Traceback (most recent call last):
        ...
    erlif.core.errors.OutputError: Expected the calibration among the attributes of the film, as \
erlif process writes it; there is none. Make the film again with: erlif process RUN_DIR
    """
    if "calibration" not in film.attrs:
        raise _no_record("there is none")
    try:
        curve = _read_record(json.loads(str(film.attrs["calibration"])), settings_of(film))
        check_calibration(curve.calibration, curve)
    except OutputError:
        raise
    except Exception as error:  # a damaged record has values of any type
        reason = f"it has no {error}" if isinstance(error, KeyError) else str(error).rstrip(".")
        raise _no_record(f"the one there cannot be used: {reason}") from error
    if trigger is None or "share_passed" not in film:
        return curve
    return curve.at(float(film.share_passed[trigger]))


def _no_record(reason: str) -> OutputError:
    return OutputError(
        "Expected the calibration among the attributes of the film, as erlif process writes it; "
        f"{reason}. Make the film again with: erlif process RUN_DIR"
    )


def _read_record(kept: dict[str, Any], settings: RunSettings) -> RunCurve:
    """The curve of the record that `record_calibration` writes."""
    calibration, later = _read_calibration(kept, settings), None
    if "later" in kept:
        later = _read_calibration(kept["later"], settings)
    systematics = NO_SYSTEMATICS
    if "systematics" in kept:
        systematics = Systematics.from_record(kept["systematics"])
    return RunCurve(calibration, calibration.thickness_range, systematics, later)


def _read_calibration(kept: dict[str, Any], settings: RunSettings) -> Calibration:
    """Parameters and origin of a calibration."""
    low, high = kept["thickness_range"]
    parameters: dict[str, Any] = {name: float(kept[name]) for name in parameters_in(kept)}
    departure = None
    if "departure" in kept:
        spline = kept["departure"]
        departure = Departure(*(np.asarray(spline[one.name], float) for one in fields(Departure)))

    return Calibration(
        **parameters,
        covariance=np.asarray(kept["covariance"], float),
        thickness_range=(float(low), float(high)),
        bands=(settings.camera1.band, settings.camera2.band),
        curve=xr.Dataset({"curve_thickness": ("bin", kept["covered_range"], {"units": "um"})}),
        reduced_chi_square=math.nan,
        fixture=str(kept["fixture"]),
        input_hashes=dict(kept["input_hashes"]),
        date=str(kept["date"]),
        temperature=float(kept["temperature"]) if "temperature" in kept else None,
        departure=departure,
    )
