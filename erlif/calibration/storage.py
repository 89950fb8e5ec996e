"""calibration.nc, written and read."""

from __future__ import annotations

import json
import math
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.calibration.curve import Calibration
from erlif.calibration.departure import Departure
from erlif.core.errors import CalibrationError, ErlifError, OutputError
from erlif.core.version import __version__
from erlif.files import has_group, open_netcdf, refuse_existing, settings_of, write_dataset
from erlif.registration import CameraMap
from erlif.registration.camera_map import describe_map


def save_calibration(
    calibration: Calibration, output: str | Path, *, overwrite: bool = False
) -> Path:
    """Write ``calibration.nc``, whole or not at all; raises OutputError if it exists and `overwrite` is not set."""
    output = Path(output)
    refuse_existing(output, overwrite=overwrite)
    dataset = calibration.to_dataset().assign_attrs(
        Conventions="CF-1.11",
        title="ERLIF calibration",
        erlif_version=__version__,
        **calibration.attributes,
    )
    groups = (
        {}
        if calibration.camera_map is None
        else {"registration": describe_map(calibration.camera_map)}
    )
    write_dataset(dataset, output, groups=groups)
    return output


def open_calibration(path: str | Path) -> Calibration:
    """Read ``calibration.nc``; raises CalibrationError if it is none."""
    path = Path(path)
    if path.is_dir():
        raise CalibrationError(
            f"Expected a calibration file; {path} is a directory. Name its file: {path / 'calibration.nc'}"
        )
    if not path.is_file():
        raise CalibrationError(
            f"Expected a calibration file; {path} does not exist. Make one with: erlif calibrate FIXTURE_DIR"
        )
    try:
        with warnings.catch_warnings():
            # the file format allows covariance (parameter, parameter), which xarray reads with a warning
            warnings.filterwarnings("ignore", "Duplicate dimension names", UserWarning)
            with open_netcdf(path) as dataset:
                calibration = Calibration.from_dataset(dataset.load())
        if not has_group(path, "registration"):
            return calibration
        with open_netcdf(path, group="registration") as dataset:
            return replace(calibration, camera_map=CameraMap.from_dataset(dataset.load()))
    except ErlifError:
        raise
    except Exception as error:  # HDF5 raises whatever the damaged bytes lead it to
        raise CalibrationError(
            f"Expected a calibration as erlif calibrate writes it; {path} is damaged or something else ({error}). Make one with: erlif "
            "calibrate FIXTURE_DIR"
        ) from error


def record_calibration(calibration: Calibration) -> str:
    """All of a calibration that decides a film, as JSON."""
    K, p, q = calibration.parameters
    kept = {
        "fixture": calibration.fixture,
        "date": calibration.date,
        "ratio_at_zero": K,
        "attenuation_camera1": p,
        "attenuation_camera2": q,
        "covariance": calibration.covariance.tolist(),
        "thickness_range": list(calibration.thickness_range),
        "covered_range": list(calibration.covered_range),
        "input_hashes": calibration.input_hashes,
    }
    if calibration.departure is not None:
        kept["departure"] = {
            name: values.tolist() for name, values in vars(calibration.departure).items()
        }
    return json.dumps(kept, sort_keys=True)


def calibration_of(film: xr.Dataset) -> Calibration:
    """The calibration that a film was made with. Its curve is empty: a film keeps the parameters, not what was fitted.

    Raises
    ------
    OutputError
        If the film does not hold it.
    """
    if "calibration" not in film.attrs:
        raise OutputError(
            "Expected the calibration among the attributes of the film, as erlif process writes it; there is none."
        )
    kept = json.loads(str(film.attrs["calibration"]))
    settings = settings_of(film)
    low, high = kept["thickness_range"]
    covered = kept.get("covered_range", [low, high])
    departure = {
        name: np.asarray(values, float) for name, values in kept.get("departure", {}).items()
    }
    return Calibration(
        ratio_at_zero=float(kept["ratio_at_zero"]),
        attenuation_camera1=float(kept["attenuation_camera1"]),
        attenuation_camera2=float(kept["attenuation_camera2"]),
        covariance=np.asarray(kept["covariance"], float),
        thickness_range=(float(low), float(high)),
        bands=(settings.camera1.band, settings.camera2.band),
        curve=xr.Dataset({"curve_thickness": ("bin", covered, {"units": "um"})}),
        reduced_chi_square=math.nan,
        fixture=str(kept["fixture"]),
        input_hashes=dict(kept.get("input_hashes", {})),
        date=str(kept.get("date", "")),
        departure=Departure(**departure) if departure else None,
    )
