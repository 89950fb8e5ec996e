"""calibration.nc of the rig's fixture, as documented."""

import json

import h5netcdf
import numpy as np
import xarray as xr

import erlif

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
