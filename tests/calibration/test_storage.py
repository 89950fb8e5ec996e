"""calibration.nc and the record in film.nc: everything comes back, damage is recognised."""

from dataclasses import replace

import h5netcdf
import h5py
import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes import film as film_scene
from scenes.fixture import (
    PITCH,
    WEDGE,
    calibrate,
    calibrate_wedge,
    image,
    log_ratio,
    through_filters,
    wedge_profile,
)

from erlif.calibration import (
    RunCurve,
    Systematics,
    calibration_of,
    open_calibration,
    record_calibration,
    save_calibration,
)
from erlif.core.errors import CalibrationError, OutputError
from erlif.io.files import open_film


@pytest.fixture(scope="module")
def wedge():
    return calibrate_wedge(np.random.default_rng(15))


@pytest.fixture(scope="module")
def departing():
    return calibrate_wedge(np.random.default_rng(1), noise=0.001, background=0.01)


@pytest.fixture(scope="module")
def placed():
    rng = np.random.default_rng(5)
    return calibrate(image(rng, log_ratio(WEDGE)), wedge_profile(rng), align=True)


@pytest.fixture(scope="module")
def walled():
    return calibrate_wedge(np.random.default_rng(6), true=through_filters(0.4))


@pytest.mark.parametrize("name", ["wedge", "departing", "placed", "walled"])
def test_file_round_trip_keeps_everything(name, request, tmp_path):
    """Numbers, fitted points, notes, and where there is one the spline or the refined pose."""
    calibration = request.getfixturevalue(name)
    back = open_calibration(save_calibration(calibration, tmp_path / "calibration.nc"))
    xr.testing.assert_equal(back.to_dataset(), calibration.to_dataset())
    assert back.attributes == calibration.attributes
    assert back.pixel_pitch == calibration.pixel_pitch == PITCH
    npt.assert_array_equal(back.full_covariance, calibration.full_covariance)
    assert (back.reflectance is None) == (name != "walled")
    npt.assert_array_equal(back.parameters, calibration.parameters)
    assert (back.departure is None, back.pose is None) == (name != "departing", name != "placed")


@pytest.mark.parametrize(("version", "warned"), [("99.0.0", True), ("99", True), ("0.0.1", False)])
def test_a_file_of_a_later_erlif_is_read_with_a_warning(version, warned, wedge, tmp_path):
    path = save_calibration(wedge, tmp_path / "calibration.nc")
    with h5py.File(path, "r+") as file:
        file.attrs["erlif_version"] = version
    notes = open_calibration(path).notes
    assert any(f"written by erlif {version}" in note.text for note in notes) == warned
    assert notes[-len(wedge.notes) :] == wedge.notes or not wedge.notes


def test_existing_file_is_replaced_on_request_only(wedge, departing, tmp_path):
    path = save_calibration(wedge, tmp_path / "calibration.nc")
    with pytest.raises(OutputError, match=r"calibration\.nc"):
        save_calibration(departing, path)
    npt.assert_array_equal(open_calibration(path).parameters, wedge.parameters)
    save_calibration(departing, path, overwrite=True)
    npt.assert_array_equal(open_calibration(path).parameters, departing.parameters)


def test_film_keeps_the_whole_curve_it_was_measured_with(departing, tmp_path):
    """The figures of a film need departure and covered range of its calibration."""
    with open_film(film_scene.make_film(tmp_path)) as film:
        film.attrs["calibration"] = record_calibration(RunCurve.of(departing))
        again = calibration_of(film)
    films = np.linspace(*departing.thickness_range, 50)
    npt.assert_array_equal(again.predict_log(films), departing.predict_log(films))
    npt.assert_allclose(again.thickness_std(films), departing.thickness_std(films), rtol=1e-12)
    assert again.covered_range == departing.covered_range


def test_at_a_trigger_the_calibration_has_the_errors_of_its_share_of_the_run(departing, tmp_path):
    """A temperature of 1 % at first and another 1 % at the last frame: w sqrt(1 + t2)."""
    width = 0.01
    systematics = Systematics.of({"temperature": width}, parameters=len(departing.full_covariance))
    run = RunCurve.of(replace(departing, systematics=systematics))
    with open_film(film_scene.make_film(tmp_path)) as film:
        film.attrs["calibration"] = record_calibration(run)
        film["share_passed"] = ("trigger", np.linspace(0, 1, film.sizes["trigger"]))
        for trigger in (0, 1, film.sizes["trigger"] - 1):
            share = float(film.share_passed[trigger])
            whole = calibration_of(film, trigger).log_ratio_std(5.0)
            added = np.sqrt(whole**2 - departing.log_ratio_std(5.0) ** 2)
            npt.assert_allclose(added, width * np.sqrt(1 + share**2), rtol=1e-9)


def test_a_film_without_calibration_is_refused():
    with pytest.raises(OutputError, match="there is none"):
        calibration_of(xr.Dataset())


def test_a_long_text_in_place_of_a_number_is_shown_in_part(wedge, tmp_path):
    path = save_calibration(wedge, tmp_path / "calibration.nc")
    with h5py.File(path, "r+") as file:
        file.attrs["band_camera1_nm"] = "x" * 60_000
    with pytest.raises(CalibrationError, match=r"calibration\.nc is damaged") as refused:
        open_calibration(path)
    assert len(str(refused.value)) < 1000


def test_a_calibration_with_one_dimension_twice_is_read(small_rig, tmp_path):
    """Other programs may write covariance (parameter, parameter), which xarray warns of."""
    path = tmp_path / "calibration.nc"
    path.write_bytes((small_rig.fixture / "calibration.nc").read_bytes())
    with h5netcdf.File(path, "a") as file:
        values = np.asarray(file["covariance"])
        del file._h5group["covariance"]
    with h5netcdf.File(path, "a") as file:
        file.create_variable("covariance", ("parameter", "parameter"), data=values)
    read = open_calibration(path)
    npt.assert_array_equal(read.covariance, values)


@pytest.mark.parametrize("noise", [1e-6, 0.15])
def test_a_calibration_that_was_made_can_be_opened(noise, tmp_path):
    """A step of the ratio no model has, on profiles without and with noise. [um]"""
    made = calibrate_wedge(
        np.random.default_rng(4), noise=noise, true=lambda film: log_ratio(film) + 0.02 * (film > 9)
    )
    assert made.departure is not None
    opened = open_calibration(save_calibration(made, tmp_path / "calibration.nc"))
    npt.assert_array_equal(opened.departure.covariance, made.departure.covariance)
