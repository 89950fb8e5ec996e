"""The predicted film, against the orbit of a pin in an infinitely long joint full of oil.

The orbit, with K = 12 pi eta L R^3 / c^2, is an ordinary differential equation:
2 dphi/dt = omega - W sin phi (2 + e^2) sqrt(1 - e^2) / (K e) and
de/dt = W cos phi (1 - e^2)^1.5 / K.
"""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.orbits import RIG, SPEED, STATED
from scipy.integrate import solve_ivp

from erlif.core.errors import ModelError
from erlif.models.reynolds import Journal, Motion, lobe_shape, solve_journal
from erlif.prediction import (
    FrameMotion,
    ImageLine,
    average_triggers,
    follow_motion,
    gap_in_view,
    predict_frames,
    predict_triggers,
    summarise_gap,
)

LOAD = 222.4
LONG = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, long=True)
VIEW = ImageLine(np.linspace(-0.009, 0.009, 301), slice(301))


def motion(count=25, cycles=1, viscosity=0.12):
    turned = 40 + np.arange(count * cycles) * (360 / count)
    cycle = np.arange(count * cycles) // count
    frames = xr.Dataset(
        {
            "crank_angle": ("frame", turned % 360),
            "cycle": ("frame", cycle),
            "joint_load": ("frame", np.full(turned.size, LOAD)),
        }
    )
    return follow_motion(frames, RIG, crank_speed=SPEED, viscosity=viscosity), turned


def minima(minimum, std):
    """Measured minima. [um]"""
    values = {"film_min": minimum, "film_min_std": np.full(minimum.size, std)}
    return xr.Dataset({name: ("trigger", value) for name, value in values.items()})


def orbit(start_film, turned):
    """Eccentricity and attitude [degree] of the orbit at these crank angles [degree]."""
    clearance, radius = 230e-6, np.sqrt(0.03336 * 0.03359)
    stiffness = 12 * np.pi * 0.12 * 0.237 * radius**3 / clearance**2

    def rates(time, state):
        e, phi = state
        crank = np.radians(turned[0]) + SPEED * time
        omega = float(RIG.rocker_speed(crank, crank_speed=SPEED))
        slip = LOAD * np.sin(phi) * (2 + e**2) * np.sqrt(1 - e**2) / (stiffness * e)
        return LOAD * np.cos(phi) * (1 - e**2) ** 1.5 / stiffness, (omega - slip) / 2

    low, high = RIG.limits()
    toward = (float(RIG.rocker_angle(np.radians(turned[0]))) - (low + high) / 2) / 2
    time = np.radians(turned - turned[0]) / SPEED
    start = [1 - start_film / clearance, toward]
    found = solve_ivp(rates, (0, time[-1]), start, t_eval=time, rtol=1e-9, atol=1e-12)
    return found.y[0], np.degrees(found.y[1])


@pytest.mark.parametrize("start_film", [5e-6, 60e-6])
def test_the_free_pin_follows_the_orbit(start_film):
    moved, turned = motion()
    eccentricity, attitude = orbit(start_film, turned)
    found = predict_triggers(
        xr.Dataset(), LONG, moved, trigger=np.arange(25), view=VIEW, start_film=start_film
    )
    film = 230 * (1 - found.eccentricity.values)
    npt.assert_allclose(film, 230 * (1 - eccentricity), rtol=1e-4)
    npt.assert_allclose(found.attitude, attitude, atol=0.01)
    npt.assert_allclose(found.film_predicted_min, film, rtol=1e-9)


def test_frames_of_several_cycles_stand_for_themselves_and_are_averaged():
    moved, turned = motion(count=10, cycles=3)
    eccentricity, _ = orbit(20e-6, turned)
    trigger = np.arange(30) % 10
    found = predict_triggers(
        xr.Dataset(), LONG, moved, trigger=trigger, view=VIEW, start_film=20e-6
    )
    film = 230 * (1 - eccentricity)
    npt.assert_allclose(found.film_predicted_min_frame, film, rtol=1e-4)
    npt.assert_allclose(found.elapsed_cycles, np.arange(30) / 10, atol=1e-12)
    mean = film.reshape(3, 10).mean(axis=0)
    npt.assert_allclose(found.film_predicted_min, mean, rtol=1e-4)


def test_frames_that_were_left_out_do_not_count():
    frames = xr.Dataset({"displacement_load": ("frame", [1.0, 3.0, 5.0, 7.0])})
    trigger, used = np.array([0, 1, 0, 1]), np.array([True, False, False, False])
    found = average_triggers(frames, trigger, used=used)
    npt.assert_array_equal(found.displacement_load, [1.0, 5.0])


def test_the_start_film_is_found_from_noisy_minima():
    moved, turned = motion()
    eccentricity, _ = orbit(12e-6, turned)
    minimum = 230 * (1 - eccentricity) + 0.05 * np.random.default_rng(2).standard_normal(25)
    film = minima(minimum, 0.05)
    found = predict_triggers(film, LONG, moved, trigger=np.arange(25), view=VIEW)
    attrs = found.film_predicted_min.attrs
    assert attrs["start_film_fitted"] == 1
    assert attrs["start_film"] == pytest.approx(12.0, abs=0.05)


@pytest.mark.parametrize(
    "limit", [{"pressure_viscosity": 2e-7}, {"cavitation_pressure": 0.0}, {"foundation": 1e13}]
)
def test_a_film_that_is_not_full_is_solved_in_cells(limit):
    """The oil thickens under its pressure, air enters, or the wall yields."""
    moved, _ = motion()
    given = {"trigger": np.arange(25), "view": VIEW, "start_film": 12e-6, "cells": (64, 1)}
    plain, other = (
        predict_triggers(xr.Dataset(), joint, moved, **given)
        for joint in (LONG, replace(LONG, **limit))
    )
    for found, joint, cells in ((plain, LONG, None), (other, replace(LONG, **limit), (64, 1))):
        frames = predict_frames(joint, moved, start_film=12e-6, cells=cells)
        far = np.hypot(frames.displacement_load, frames.displacement_side)
        npt.assert_allclose(found.eccentricity, far / 230e-6, rtol=1e-9)


def test_the_lead_of_a_held_pin_is_the_turn_before_its_first_frame():
    """The second of two equal turns is that of a recording of one turn with its lead."""
    both, _ = motion(count=25, cycles=2)
    one, _ = motion(count=25)
    twice = predict_frames(LONG, both, start_film=12e-6, sideways="guided")
    led = predict_frames(LONG, one.with_lead(), start_film=12e-6, sideways="guided")
    second = twice.displacement_load.values[25:]
    npt.assert_allclose(led.displacement_load, second, atol=1e-9)
    cold = predict_frames(LONG, one, start_film=float(230e-6 - second[0]), sideways="guided")
    assert np.abs(cold.displacement_load.values - second).max() > 0.1e-6


def test_a_fitted_guided_film_is_led_in():
    both, _ = motion(count=25, cycles=2)
    twice = predict_frames(LONG, both, start_film=12e-6, sideways="guided")
    minimum = 1e6 * (230e-6 - twice.displacement_load.values[25:])
    film = minima(minimum, 0.02)
    one, _ = motion(count=25)
    found = predict_triggers(film, LONG, one, trigger=np.arange(25), view=VIEW, sideways="guided")
    npt.assert_allclose(found.film_predicted_min, minimum, atol=0.02)
    assert found.film_predicted_min.attrs["start_film"] == pytest.approx(minimum[0], abs=0.02)
    npt.assert_allclose(found.elapsed_cycles, np.arange(25) / 25, atol=1e-12)


PLACE = np.linspace(-0.01, 0.012, 2001)


def circles(load, side):
    """Distance between the circles along the radius of the bore at each place."""
    angle = PLACE / np.sqrt(0.03336 * 0.03359)
    along = load * np.cos(angle) + side * np.sin(angle)
    across = load * np.sin(angle) - side * np.cos(angle)
    return 0.03359 - along - np.sqrt(0.03336**2 - across**2)


def test_the_gap_is_the_distance_of_two_circles():
    """To second order in clearance over radius: some hundredths of a micrometre."""
    found = gap_in_view(np.array([220e-6, 150e-6]), np.array([20e-6, -90e-6]), STATED, PLACE)
    npt.assert_allclose(found[0], circles(220e-6, 20e-6), atol=0.15e-6)
    npt.assert_allclose(found[1], circles(150e-6, -90e-6), atol=0.3e-6)


def test_minimum_and_mean_are_those_of_the_region():
    """The thinnest place of the second position lies outside the region, on its right."""
    region = slice(300, 1700)
    load, side = np.array([224e-6, 200e-6]), np.array([10e-6, 105e-6])
    minimum, mean = summarise_gap(load, side, STATED, ImageLine(PLACE, region))
    gap = gap_in_view(load, side, STATED, PLACE[region])
    npt.assert_allclose(minimum, gap.min(axis=1), atol=1e-11)
    npt.assert_allclose(mean, gap.mean(axis=1), rtol=1e-12)

    clear = 230e-6 - np.hypot(load, side)
    npt.assert_allclose(minimum[0], clear[0], rtol=1e-6)
    assert minimum[1] > clear[1] + 1e-6


def test_a_liner_yields_by_its_pressure_over_its_stiffness():
    """Winkler: where the film is thinnest it is the gap of the radii and p / k."""
    joint = Journal(0.03336, 0.03359, length=0.05, viscosity=0.12, foundation=2e11)
    time = np.linspace(0.0, 0.05, 21)
    motion = Motion(time, 0 * time, 400.0)
    moved = FrameMotion(motion, np.array([10, 20]), time, 0.12)
    cells, view = (192, 8), ImageLine(np.linspace(-0.01, 0.01, 501), slice(501))
    found = predict_triggers(
        xr.Dataset(), joint, moved, trigger=np.array([0, 1]), view=view, start_film=20e-6,
        cells=cells,
    )  # fmt: skip
    solved = solve_journal(
        joint, motion, start=(joint.clearance - 20e-6, 0.0), cells=cells, maps=[10, 20]
    )
    rigid = joint.clearance - solved.displacement_load.values[[10, 20]]
    expected = rigid + solved.pressure.max(["circumference", "axial"]).values / joint.foundation
    npt.assert_allclose(found.film_predicted_min, 1e6 * expected, rtol=0.01)
    assert (found.film_predicted_min > 1e6 * rigid * 1.1).all()


def test_a_pin_that_reaches_the_crest_of_a_lobe_is_refused():
    """Its crest, which no cell has at its middle, is lower by 0.2 um than the film of the cells."""
    axial = np.arange(-1000, 1001) * 15e-6
    shape = lobe_shape(axial, centres=[1e-3], radius=0.2, height=20e-6)
    joint = Journal(0.03336, 0.03359, length=0.03, viscosity=0.12, axial_shape=shape)
    time = np.linspace(0.0, 1.0, 51)
    moved = FrameMotion(Motion(time, 0 * time, 60.0), np.array([25, 50]), time, 0.12)
    with pytest.raises(ModelError, match="No film carries the load"):
        predict_frames(joint, moved, start_film=2e-6, cells=(64, 2))
