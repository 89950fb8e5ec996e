"""Products to files: names, dims and units as documented, the same bytes however they are made."""

import json
import tomllib

import h5netcdf
import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as drawn

import erlif
from erlif.core.errors import CalibrationError, OutputError
from erlif.files import PartialFilm, compress, decompress, replacing, round_bits
from erlif.settings import RunSettings, read_run_settings

# film.nc as documented: dims and unit of each variable
MAPS = ("trigger", "y", "x")
ROOT = {
    "thickness": (MAPS, "um"),
    "thickness_std": (MAPS, "um"),
    "thickness_std_shared": (MAPS, "um"),
    "flags": (MAPS, "1"),
    "frames_used": (("trigger",), "1"),
    "encoder_angle": (("trigger",), "degree"),
    "stroke": (("trigger",), "1"),
    "crank_angle": (("trigger",), "degree"),
    "rocker_speed": (("trigger",), "rad s-1"),
    "sliding_speed": (("trigger",), "m s-1"),
    "load": (("trigger",), "N"),
    "temperature": (("trigger",), "degree_Celsius"),
    "film_mean": (("trigger",), "um"),
    "film_mean_std": (("trigger",), "um"),
    "film_min": (("trigger",), "um"),
    "film_min_std": (("trigger",), "um"),
    "film_hamrock_dowson": (("trigger",), "um"),
    "film_theory": (("trigger",), "um"),
    "film_parameter": (("trigger",), "1"),
    "speed_exponent": ((), "1"),
    "speed_exponent_std": ((), "1"),
    "speed_exponent_mean": ((), "1"),
    "speed_exponent_mean_std": ((), "1"),
    "x": (("x",), "mm"),
    "y": (("y",), "mm"),
    "trigger": (("trigger",), None),
}
FRAMES = {
    "frame": None,
    "trigger": "1",
    "cycle": "1",
    "time": "s",
    "drift_x": "px",
    "drift_y": "px",
    "pulse_energy": "1",
    "file_camera1": None,
    "file_camera2": None,
}
REGISTRATION = {"displacement_x": "px", "displacement_y": "px", "displacement_std": "px"}
CALIBRATION = {
    "ratio_at_zero": ((), "1"),
    "attenuation_camera1": ((), "um-1"),
    "attenuation_camera2": ((), "um-1"),
    "covariance": (("parameter", "parameter2"), None),
    "thickness_range": (("bound",), "um"),
    "curve_x": (("bin",), "mm"),
    "curve_thickness": (("bin",), "um"),
    "curve_ratio": (("bin",), "1"),
    "curve_ratio_std": (("bin",), "1"),
    "curve_residual": (("bin",), "1"),
    "reduced_chi_square": ((), "1"),
    "parameter": (("parameter",), None),
}


@pytest.fixture(scope="module")
def opened(film):
    with erlif.open_film(film) as dataset:
        return dataset.load()


def test_film_has_the_documented_variables(opened):
    assert set(opened.variables) == {*ROOT, "laser_mJ"}  # the log's own column travels along
    for name, (dims, unit) in ROOT.items():
        assert opened[name].dims == dims, name
        assert opened[name].attrs.get("units") == unit, name
    assert opened.thickness.dtype == np.float32
    assert opened.flags.dtype == np.uint8
    assert dict(opened.sizes) == {"trigger": 6, "y": 96, "x": 128}


def test_names_of_the_film_are_reserved_in_the_log(opened):
    from erlif.ingest.encoder_log import _RESERVED

    assert set(map(str, opened.variables)) - {"laser_mJ"} <= _RESERVED


def test_film_has_the_documented_groups(film):
    with erlif.open_film(film, group="frames") as frames:
        assert {name: frames[name].attrs.get("units") for name in frames.variables} == FRAMES
        assert all(frames[name].dims == ("frame",) for name in frames.variables)
        assert frames.file_camera1.values.tolist() == [f"frame_{k:04d}.tif" for k in range(6)]
    with erlif.open_film(film, group="registration") as registration:
        for name, unit in REGISTRATION.items():
            assert registration[name].dims == ("y", "x")
            assert registration[name].attrs["units"] == unit
    with h5netcdf.File(film, "r") as file:
        assert set(file.groups) == {"frames", "registration"}


def test_flags_explain_themselves(opened):
    attrs = opened.flags.attrs
    assert attrs["flag_masks"].tolist() == [1, 2, 4, 8, 16, 32, 64, 128]
    assert attrs["flag_masks"].dtype == np.uint8
    assert attrs["flag_meanings"] == (
        "saturated dim bad_pixel outside_overlap below_range above_range poor_registration no_film"
    )


def test_thickness_is_nan_exactly_where_flags_are_set(opened):
    flagged = opened.flags.values != 0
    assert flagged.any()
    assert not flagged.all()
    for name in ("thickness", "thickness_std", "thickness_std_shared"):
        np.testing.assert_array_equal(np.isnan(opened[name].values), flagged)


def test_film_tells_its_history(small_rig, opened):
    attrs = opened.attrs
    assert attrs["Conventions"] == "CF-1.11"
    assert attrs["erlif_version"] == erlif.__version__
    assert attrs["history"]
    assert RunSettings.model_validate(tomllib.loads(attrs["settings"])) == read_run_settings(
        small_rig.run
    )
    hashes = json.loads(attrs["input_hashes"])
    assert {
        "run.toml",
        "encoder.csv",
        "camera1/*.tif",
        "camera2/*.tif",
        "camera1_dark.tif",
        "camera2_flat.tif",
    } <= set(hashes)
    assert all(len(value) == 64 for value in hashes.values())
    assert {"regime", "reason"} <= set(opened.film_theory.attrs)
    assert not any(str(small_rig.directory) in str(value) for value in attrs.values())


def test_places_of_pixels_follow_from_the_pitch(opened):
    np.testing.assert_allclose(opened.x, np.arange(128) * 19.2 / 128)
    np.testing.assert_allclose(opened.y, np.arange(96) * 19.2 / 128)


def test_calibration_has_the_documented_variables(small_rig):
    with xr.open_dataset(small_rig.fixture / "calibration.nc", engine="h5netcdf") as dataset:
        assert {name: variable.dims for name, variable in dataset.variables.items()} == {
            name: dims for name, (dims, _) in CALIBRATION.items()
        }
        for name, (_, unit) in CALIBRATION.items():
            assert dataset[name].attrs.get("units") == unit, name
        assert dataset.parameter.values.tolist() == [
            "ratio_at_zero",
            "attenuation_camera1",
            "attenuation_camera2",
        ]
        assert dataset.covariance.shape == (3, 3)
        assert dataset.attrs["ratio_direction"] == "camera2/camera1"
        assert (dataset.attrs["band_camera1_nm"], dataset.attrs["band_camera2_nm"]) == (580, 610)
        assert dataset.attrs["fixture"] == "virtual wedge"
        assert dataset.attrs["erlif_version"] == erlif.__version__
        assert len(dataset.attrs["date"]) == 10
        hashes = json.loads(dataset.attrs["input_hashes"])
    assert {"fixture.toml", "profile.csv", "camera1/*.tif"} <= set(hashes)
    assert not any(name.startswith("/") for name in hashes)


def test_a_calibration_comes_back_as_it_was_saved(small_rig, tmp_path):
    first = erlif.open_calibration(small_rig.fixture / "calibration.nc")
    erlif.save_calibration(first, tmp_path / "a" / "again.nc")
    again = erlif.open_calibration(tmp_path / "a" / "again.nc")
    np.testing.assert_array_equal(again.parameters, first.parameters)
    np.testing.assert_array_equal(again.covariance, first.covariance)
    assert again.notes == first.notes
    assert again.input_hashes == first.input_hashes
    xr.testing.assert_identical(again.curve, first.curve)
    with pytest.raises(OutputError, match="--overwrite"):
        erlif.save_calibration(first, tmp_path / "a" / "again.nc")
    erlif.save_calibration(first, tmp_path / "a" / "again.nc", overwrite=True)


def test_a_calibration_with_one_dimension_twice_is_read(small_rig, tmp_path):
    """Other programs may write covariance (parameter, parameter), which xarray warns of."""
    path = tmp_path / "calibration.nc"
    path.write_bytes((small_rig.fixture / "calibration.nc").read_bytes())
    with h5netcdf.File(path, "a") as file:
        values = np.asarray(file["covariance"])
        del file._h5group["covariance"]
    with h5netcdf.File(path, "a") as file:
        file.create_variable("covariance", ("parameter", "parameter"), data=values)
    read = erlif.open_calibration(path)
    np.testing.assert_array_equal(read.covariance, values)


def test_the_film_does_not_depend_on_threads_repetition_or_place(small_rig, film, tmp_path):
    path = tmp_path / "elsewhere" / "film.nc"
    erlif.process(small_rig.run, output=path, workers=3).close()
    assert path.read_bytes() == film.read_bytes()


def test_zarr_holds_the_same_as_netcdf(small_rig, film, tmp_path):
    path = tmp_path / "film.zarr"
    returned = erlif.process(small_rig.run, output=path)
    xr.testing.assert_identical(returned.load(), erlif.open_film(path).load())
    for group in (None, "frames", "registration"):
        with erlif.open_film(film, group=group) as expected:
            xr.testing.assert_identical(erlif.open_film(path, group=group).load(), expected.load())
    returned.close()
    erlif.process(small_rig.run, output=path, overwrite=True).close()
    with erlif.open_film(film) as expected:
        xr.testing.assert_identical(erlif.open_film(path).load(), expected.load())
    assert [entry.name for entry in tmp_path.iterdir()] == ["film.zarr"]


def test_a_film_that_is_not_written_is_the_same(small_rig, opened):
    xr.testing.assert_identical(erlif.process(small_rig.run), opened)


@pytest.mark.parametrize(
    "name",
    [
        "none.nc",
        "none.zarr",
        "text.nc",
        "text.zarr",
        "empty.nc",
        "directory.nc",
        "hollow.zarr",
        "other.nc",
    ],
)
def test_what_is_no_film_is_refused(tmp_path, small_rig, name):
    path = tmp_path / name
    if name.startswith("text"):
        path.write_text("film")
    elif name.startswith("empty"):
        path.write_bytes(b"")
    elif name.startswith(("directory", "hollow")):
        path.mkdir()
    elif name.startswith("other"):
        path.write_bytes((small_rig.fixture / "calibration.nc").read_bytes())
    with pytest.raises(OutputError, match=name):
        erlif.open_film(path)


def test_a_missing_group_is_refused(film):
    with pytest.raises(OutputError, match=r"film\.nc"):
        erlif.open_film(film, group="friction")


@pytest.mark.parametrize("name", ["none.nc", "text.nc", "directory.nc"])
def test_what_is_no_calibration_is_refused(tmp_path, name):
    path = tmp_path / name
    if name == "text.nc":
        path.write_text("calibration")
    elif name == "directory.nc":
        path.mkdir()
    with pytest.raises(CalibrationError, match=name):
        erlif.open_calibration(path)


@settings(deadline=None, database=None)
@given(
    drawn.arrays(np.float32, 30, elements=st.floats(width=32, allow_nan=True)), st.integers(4, 23)
)
def test_rounded_values_are_as_near_as_their_bits_allow(values, bits):
    rounded = round_bits(values, bits)
    finite = np.isfinite(values) & (np.abs(values) < 1e38) & (np.abs(values) > 1e-37)
    error = np.abs(rounded[finite].astype(float) - values[finite])
    assert (error <= np.abs(values[finite].astype(float)) * 2.0 ** -(bits + 1) * (1 + 1e-6)).all()
    np.testing.assert_array_equal(
        np.isnan(rounded), ~np.isfinite(values) if bits < 23 else np.isnan(values)
    )


@settings(deadline=None, database=None)
@given(drawn.arrays(st.sampled_from([np.float32, np.uint8]), (5, 7)))
def test_compressed_maps_come_back(values):
    np.testing.assert_array_equal(decompress(compress(values), values.dtype.name, (5, 7)), values)


def test_a_failure_while_writing_leaves_the_old_file(tmp_path):
    path = tmp_path / "film.nc"
    path.write_text("old")

    def write_half():
        with replacing(path) as scratch:
            scratch.write_text("half")
            raise OSError(28, "No space left on device")

    with pytest.raises(OutputError, match="No space left on device"):
        write_half()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_directory_is_exchanged_as_a_whole(tmp_path):
    path = tmp_path / "film.zarr"
    for content in ("first", "second"):
        with replacing(path) as scratch:
            scratch.mkdir()
            (scratch / "value").write_text(content)
    assert (path / "value").read_text() == "second"
    assert list(tmp_path.iterdir()) == [path]


def test_a_partial_film_forgets_what_was_half_written(tmp_path):
    partial = PartialFilm(tmp_path / "film.nc", "key")
    (partial.directory / "trigger_00001.npz").write_bytes(b"")  # as after a loss of power
    (partial.directory / "trigger_00002.unfinished").write_bytes(b"half")
    partial.lock.release()  # as the end of its process does
    again = PartialFilm(tmp_path / "film.nc", "key")
    assert not again.has(1)
    assert not again.has(2)
    assert not list(again.directory.glob("*.unfinished"))
    again.lock.release()
