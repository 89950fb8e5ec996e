"""truth.nc: the true film and the inputs of the simulation."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import xarray as xr
from scenes.rig import QUICK

from erlif.rig import simulate


def test_truth_holds_the_inputs_of_the_simulation(truth):
    assert dict(truth.film.sizes) == {"trigger": 50, "y": 80, "x": 96}
    assert dict(truth.bubble.sizes) == {"frame": 50, "y": 80, "x": 96}
    assert dict(truth.expected_electrons.sizes) == {"camera": 2, "trigger": 50, "y": 80, "x": 96}
    assert all("units" in variable.attrs for variable in truth.data_vars.values())
    assert truth.attrs["seed"] == 5
    assert truth.attrs["rig_exponent"] == 0.62
    npt.assert_allclose([truth.drift_x.mean(), truth.drift_y.mean()], 0, atol=1e-14)
    assert 0.2 < truth.drift_x.std() < 0.4
    npt.assert_allclose(
        [truth.fixture_drift_x.mean(), truth.fixture_drift_y.mean()], [0.6, -0.4], atol=1e-14
    )
    npt.assert_allclose(truth.pulse_energy.std(), 0.03, rtol=0.35)


def test_film_in_the_truth_is_gap_and_marks(truth):
    smooth = truth.film.median("y").isel(trigger=13)
    curvature = np.polyfit(truth.x, smooth, 2)[0] * 2
    off = 230.0 - float(truth.film_min[13])  # um, between the axes
    npt.assert_allclose(curvature, off / (33.36 * 33.59), rtol=0.02)  # um/mm2
    # the marks stay where they are; the pin moves towards the load, at 0.8 mm from the middle
    change = truth.film.isel(trigger=13) - truth.film.isel(trigger=0)
    cosine = np.cos((truth.x - truth.x.mean() - 0.8) / 33.475)
    expected = (truth.film_min[13] - truth.film_min[0]) * cosine
    npt.assert_allclose(change, expected.broadcast_like(change), atol=3e-4)


def test_settings_are_attributes_and_absent_ones_are_left_out(truth, tmp_path):
    assert truth.attrs["rig_width"] == 96
    assert truth.attrs["rig_write_zero"] == 1
    npt.assert_array_equal(truth.attrs["rig_shift"], [4.0, -3.0])
    npt.assert_allclose(truth.attrs["rig_pixel_pitch"], 19.2 / 96)
    assert "rig_film_table" not in truth.attrs
    films = (3.0, 4.0, 5.0, 5.0, 4.0, 3.0)
    out = simulate(tmp_path, rig=replace(QUICK, film_table=films))
    with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as again:
        npt.assert_array_equal(again.attrs["rig_film_table"], films)
        npt.assert_array_equal(again.film_min, films)


def test_values_are_rounded_below_what_a_camera_resolves(truth):
    """Film to 1/4096 um, signal to 1/2048 of its binary mantissa."""
    film = truth.film.to_numpy().astype(float)
    npt.assert_array_equal(film * 4096, np.rint(film * 4096))
    mantissa, _ = np.frexp(truth.expected_electrons.to_numpy().astype(float))
    npt.assert_array_equal(mantissa * 2048, np.rint(mantissa * 2048))


def test_the_film_of_theory_is_given_for_every_frame_with_the_place_of_the_pin(tmp_path):
    rig = replace(QUICK, film="reynolds", tilt=0.0, cycles=2, marks=0.0, viscosity=0.11)
    out = simulate(tmp_path, rig=rig)
    with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as truth:
        assert dict(truth.film.sizes) == {"frame": 12, "y": 48, "x": 64}
        assert dict(truth.expected_electrons.sizes) == {"camera": 2, "frame": 12, "y": 48, "x": 64}
        phi = (truth.x - truth.load_line) / np.sqrt(33.36 * 33.59)
        gap = 230 - truth.pin_displacement_load * np.cos(phi)
        gap = gap - truth.pin_displacement_side * np.sin(phi)
        npt.assert_allclose(truth.film, gap.broadcast_like(truth.film), atol=2e-4)
        film_min = 230 * (1 - truth.eccentricity)
        npt.assert_allclose(truth.film_min, film_min, rtol=1e-9)
        npt.assert_array_equal(truth.viscosity, 0.11)
        npt.assert_allclose(truth.time_since_loading - truth.time, 24 * 60 / 114)
        assert "rig_exponent" not in truth.attrs
        log = np.genfromtxt(out / "run" / "encoder.csv", delimiter=",", names=True)
        npt.assert_allclose(log["time_s"], truth.time, atol=1e-6)
        npt.assert_allclose(log["load_N"], truth.frame_load, atol=1e-3)
