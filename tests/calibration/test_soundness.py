"""A calibration file with numbers that no fit gives is refused when it is opened."""

import json

import h5netcdf
import h5py
import numpy as np
import pytest
from scenes.fixture import calibrate_wedge

from erlif.calibration import Systematics, open_calibration, save_calibration
from erlif.core.errors import CalibrationError


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """A calibration file as erlif writes it, never to be changed."""
    calibration = calibrate_wedge(np.random.default_rng(15))
    return save_calibration(calibration, tmp_path_factory.mktemp("saved") / "calibration.nc")


@pytest.fixture(scope="module")
def departing(tmp_path_factory):
    """The same with a spline."""
    calibration = calibrate_wedge(np.random.default_rng(1), noise=0.001, background=0.01)
    assert calibration.departure is not None
    return save_calibration(calibration, tmp_path_factory.mktemp("saved") / "calibration.nc")


def opened_after(saved, tmp_path, change):
    """Message with which a changed copy of a file is refused."""
    path = tmp_path / "calibration.nc"
    path.write_bytes(saved.read_bytes())
    with h5netcdf.File(path, "a") if change is swell else h5py.File(path, "r+") as file:
        change(file)
    with pytest.raises(CalibrationError) as refused:
        open_calibration(path)
    message = str(refused.value)
    assert message.startswith("Expected a calibration")
    assert "missing" in message or str(path) in message
    assert message.endswith("with: erlif calibrate FIXTURE_DIR")
    return message


def put(name, value, place=...):
    def change(file):
        file[name][place] = value

    return change


def attribute(name, value, of=None):
    def change(file):
        (file if of is None else file[of]).attrs[name] = value

    return change


def exchange_p_and_q(file):
    p, q = file["attenuation_camera1"][()], file["attenuation_camera2"][()]
    file["attenuation_camera1"][()], file["attenuation_camera2"][()] = q, p


def systematics(**changes):
    """Those of a fixture whose size is known to 0.5 %, changed."""
    sound = Systematics.of({"size": 0.005}, parameters=3).to_record()
    return attribute("systematics", json.dumps(sound | changes))


def mirror_one_element(file):
    file["covariance"][0, 1] = -file["covariance"][1, 0]


def correlate_beyond_one(file):
    found = file["covariance"][:]
    found[0, 1] = found[1, 0] = 1.5 * np.sqrt(found[0, 0] * found[1, 1])
    file["covariance"][:] = found


def swell(file):
    file.dimensions["row"], file.dimensions["column"] = 10**6, 10**4
    file.create_variable("curve_extra", ("row", "column"), "f8", chunks=(1, 10**4))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (put("ratio_at_zero", np.nan), "ratio_at_zero is nan, not a positive number"),
        (put("ratio_at_zero", 1e9), "ratio_at_zero is 1e+09, outside"),
        (put("attenuation_camera2", 0.0), "attenuation_camera2 is 0, not a positive number"),
        (exchange_p_and_q, "the two look exchanged"),
        (attribute("units", "mm-1", "attenuation_camera1"), "is in mm-1, not in um-1"),
        (attribute("units", "mm", "thickness_range"), "thickness_range is in mm, not in um"),
        (put("covariance", np.nan), "covariance has values that are not finite"),
        (put("covariance", -1e-6, (1, 1)), "covariance has a variance of -1e-06"),
        (mirror_one_element, "covariance is not symmetric"),
        (systematics(terms=["fog"]), "a term that this version does not know, fog"),
        (systematics(covariance=[[-1e-4]]), "systematics has values that no error has"),
        (systematics(cross=[0.0] * 6), "systematics has the shape"),
        (correlate_beyond_one, "covariance is not positive definite"),
        (put("thickness_range", [12.0, 0.1]), "thickness_range is 12 to 0.1 um"),
        (put("thickness_range", [0.1, 1e9]), "thickness_range is 0.1 to 1e+09 um"),
        (attribute("band_camera1_nm", 0.58), "a band is at 0.58 nm"),
        (put("curve_thickness", np.nan, 3), "curve_thickness has values that are not finite"),
        (put("curve_ratio", -1.0, 3), "curve_ratio has a value of -1"),
        (attribute("format_version", 99), "written by a later version of erlif"),
        (attribute("format_version", 1.5), "no whole number"),
        (lambda file: file.attrs.__delitem__("fixture"), "fixture"),
        (lambda file: file.__delitem__("covariance"), "covariance"),
        (lambda file: file.__delitem__("curve_ratio"), "'curve_ratio' is missing"),
        (lambda file: file.__delitem__("curve_residual"), "'curve_residual' is missing"),
    ],
)
def test_a_number_that_no_fit_gives_is_named(saved, tmp_path, change, words):
    assert words in opened_after(saved, tmp_path, change)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (put("departure_knots", np.nan, 5), "departure_knots are not in rising order"),
        (put("departure_coefficient", np.inf, 2), "departure_coefficient has values"),
        (put("departure_coefficient", -50.0, 2), "does not rise with thickness at"),
        (put("departure_covariance", np.nan, (0, 0)), "departure_covariance has values"),
    ],
)
def test_a_damaged_spline_is_named(departing, tmp_path, change, words):
    assert words in opened_after(departing, tmp_path, change)


def test_a_header_that_claims_more_than_a_memory_holds_is_refused_at_once(saved, tmp_path):
    assert "its header claims 80.0 GB" in opened_after(saved, tmp_path, swell)


def test_an_infinite_camera_map_is_refused(lab, tmp_path):
    message = opened_after(
        lab.fixture / "calibration.nc", tmp_path, put("registration/displacement_x", np.inf, (0, 0))
    )
    assert "its camera map has no finite displacements" in message


@pytest.mark.parametrize("unit", ["1/um", "um-1"])
def test_spellings_of_a_unit_are_accepted(saved, tmp_path, unit):
    path = tmp_path / "calibration.nc"
    path.write_bytes(saved.read_bytes())
    with h5py.File(path, "r+") as file:
        file["attenuation_camera1"].attrs["units"] = unit
    assert open_calibration(path).attenuation_camera1 > 0
