"""From counts to ratios with the map of a whole recording: stored maps, misfired pulses."""

import numpy as np
import numpy.testing as npt
import pytest
import tifffile
import xarray as xr

import erlif
from erlif.core.flags import Flag

REUSE = ("[thickness]", "[registration]\nreuse = true\n\n[thickness]")


def test_map_stored_with_the_calibration_is_used_for_a_run(lab):
    """Camera 2 has moved since the fixture; the map is as good as one of the run's own frames."""
    own = erlif.process(lab.run, output=lab.directory / "own.nc")
    lab.edit("run/run.toml", REUSE)
    reused = erlif.process(lab.run, output=lab.directory / "reused.nc")
    groups = [
        erlif.open_film(lab.directory / name, group="registration")
        for name in ("own.nc", "reused.nc")
    ]
    for name in ("displacement_x", "displacement_y"):
        npt.assert_allclose(
            groups[1][name].values[8:-8, 8:-8], groups[0][name].values[8:-8, 8:-8], atol=0.08
        )
    assert "stored with the calibration" in groups[1].attrs["registration_model"]
    npt.assert_allclose(reused.film_mean, own.film_mean, rtol=0.01)


def test_stored_map_that_no_longer_fits_is_refused(lab, refused):
    """Camera 2 has been turned by two degrees since, two pixels at the edge of its image."""
    lab.edit("run/run.toml", REUSE)
    y, x = np.indices((96, 128))
    angle = np.radians(2.0)
    for path in lab.frames(2):
        image = tifffile.imread(path).astype(float)
        away = x - 64, y - 48
        from_x = 64 + np.cos(angle) * away[0] - np.sin(angle) * away[1]
        from_y = 48 + np.sin(angle) * away[0] + np.cos(angle) * away[1]
        column, row = (
            np.clip(np.rint(from_x), 0, 127).astype(int),
            np.clip(np.rint(from_y), 0, 95).astype(int),
        )
        tifffile.imwrite(path, image[row, column].astype(np.uint16))
    message = refused("process", lab.run)
    assert "stored camera map fits no longer" in message or "no common texture" in message


def test_reuse_with_a_calibration_without_a_map_is_refused(lab, refused):
    lab.edit("run/run.toml", REUSE)
    calibration = erlif.open_calibration(lab.fixture / "calibration.nc")
    with xr.open_dataset(lab.fixture / "calibration.nc", engine="h5netcdf") as dataset:
        plain = dataset.load()
    assert calibration.camera_map is not None
    plain.to_netcdf(lab.fixture / "plain.nc", engine="h5netcdf")
    assert "Calibrate again" in refused(
        "process", lab.run, "--calibration", lab.fixture / "plain.nc"
    )


@pytest.mark.parametrize("camera", [1, 2])
def test_frame_of_a_misfired_pulse_is_flagged_and_has_a_note(lab, camera):
    """One frame shows nothing but room light, without the texture of the other camera."""
    rng = np.random.default_rng(1)
    path = lab.frames(camera)[2]
    tifffile.imwrite(path, rng.normal(900, 14, (96, 128)).astype(np.uint16))
    film = erlif.process(lab.run)
    assert np.all(film.flags.values[2] & Flag.POOR_REGISTRATION)
    assert np.isnan(film.thickness.values[2]).all()
    assert (film.flags.values[[0, 1, 3]] == 0).mean() > 0.7
    assert "frame pairs 2: no common texture" in film.attrs["notes"]
