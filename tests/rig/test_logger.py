"""Encoders and logs of the virtual rig, against the geometry of its linkage."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.rig import QUICK

from erlif.rig import RigSettings, simulate
from erlif.rig.film import list_pictures, list_triggers, rocker_angle
from erlif.rig.logger import TICKS, frame_times, read_encoder, write_log_in_time


def pins(crank, rig):
    """Crank pin and rocker pin; the rocker turns about (ground, 0). [cm]"""
    psi = rocker_angle(crank, rig)
    one = rig.crank * np.exp(1j * crank)
    return one, rig.ground - rig.rocker * np.exp(-1j * psi)


@pytest.mark.parametrize("encoder", ["rocker", "coupler", "crank"])
def test_reading_and_zero_give_the_angle_of_the_link(encoder):
    rig = RigSettings(encoder=encoder)
    crank = np.linspace(0.1, 6.2, 50)
    reading = read_encoder(crank, list_triggers(rig), rig)
    one, two = pins(crank, rig)
    npt.assert_allclose(np.abs(two - one), rig.coupler)
    expected = {"rocker": rocker_angle(crank, rig), "coupler": np.angle(two - one), "crank": crank}
    found = np.radians(reading.values + reading.zero)
    npt.assert_allclose(np.exp(1j * found), np.exp(1j * expected[encoder]), atol=1e-9)


@pytest.mark.parametrize("encoder", ["rocker", "coupler", "crank"])
def test_the_rod_of_a_slider_crank_is_rocker_and_coupler(encoder):
    rig = RigSettings(mechanism="slider-crank", encoder=encoder)
    crank = np.linspace(0.1, 6.2, 50)
    reading = read_encoder(crank, list_pictures(rig), rig)
    rod = -np.arcsin(5.5 / 44 * np.sin(crank))
    found = np.radians(reading.values + reading.zero)
    expected = crank if encoder == "crank" else rod
    npt.assert_allclose(np.exp(1j * found), np.exp(1j * expected), atol=1e-9)


def test_readings_that_start_again_do_so_within_the_stroke():
    crank = np.linspace(0, 6.28, 400)
    plain, wrapped, ticks = (
        read_encoder(crank, list_triggers(rig), rig)
        for rig in (RigSettings(reading=kind) for kind in ("degrees", "wrapped", "ticks"))
    )
    assert np.ptp(wrapped.values) > 350
    angle = (wrapped.values + wrapped.zero + 180) % 360 - 180
    npt.assert_allclose(angle, plain.values + plain.zero)
    npt.assert_allclose(ticks.values * 360 / TICKS, wrapped.values, atol=0.5001 * 360 / TICKS)
    assert ticks.values.min() >= 0
    assert ticks.values.max() < TICKS


def test_pulses_of_a_divider_come_at_even_times_and_need_not_repeat():
    rig = RigSettings(pulses_per_cycle=7.3, cycles=3)
    triggers = list_triggers(rig)
    times = frame_times(triggers, rig)
    assert times.size == 21
    npt.assert_allclose(np.diff(times), 60 / 114 / 7.3)
    npt.assert_allclose(np.diff(triggers.crank_angle) % 360, 360 / 7.3)


def test_the_log_in_time_rises_at_each_frame(tmp_path):
    rig = RigSettings(log="continuous", pulses_per_cycle=7.3, cycles=2)
    triggers = list_triggers(rig)
    write_log_in_time(tmp_path / "log.csv", triggers, rig, 25.0)
    text = (tmp_path / "log.csv").read_text(encoding="utf-8").replace(",", ".")
    data = np.array([line.split(";") for line in text.splitlines()[2:]], float)
    npt.assert_allclose(np.diff(data[:, 0]), 1e-4, atol=1e-9)
    rises = data[1:, 0][(data[1:, 4] > 2) & (data[:-1, 4] < 2)]
    npt.assert_allclose(np.diff(rises), np.diff(frame_times(triggers, rig)), atol=1.01e-4)
    at_rise = np.interp(rises, data[:, 0], data[:, 1])
    npt.assert_allclose(at_rise, triggers.reading, atol=0.02)  # 0.1 ms at 146 degree/s


def test_a_run_with_a_divider_has_a_film_for_each_frame(tmp_path):
    out = simulate(tmp_path, rig=replace(QUICK, pulses_per_cycle=3.4, cycles=2, log="continuous"))
    with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as truth:
        assert truth.sizes["trigger"] == truth.sizes["frame"] == 6
        assert truth.attrs["rig_log"] == "continuous"
