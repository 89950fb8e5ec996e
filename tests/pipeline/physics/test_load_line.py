"""The load line in the orbit of a pin that another solver follows, and positions about it."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.film import run_settings
from scenes.gap import VIEW, WHOLE, circle_gap, known_calibration, noisy_ratios
from scenes.orbits import CRANK, FRAMES, MOTION, STD, STEPS, free_orbit
from scenes.results import make_position

from erlif.calibration import RunCurve, record_calibration
from erlif.io.settings import to_toml
from erlif.pipeline.physics.load_line import (
    LoadLine,
    find_load_line,
    place_positions,
    turn_positions,
)
from erlif.pipeline.physics.position import describe_positions
from erlif.pipeline.plane import ObjectPlane
from erlif.prediction import measured_positions
from erlif.trend import find_pin_position

RADIUS = np.sqrt(33.36 * 33.59)  # mm
MIDDLE = 8.97  # mm, of 300 columns of 60 um
SHARED = np.array([0.3, 1.5])  # um, of both displacements by the calibration
CALIBRATION = known_calibration(valid=(0.2, 40.0), covariance=1e-6 * np.eye(3))


def plane(**options):
    optics = {"x_axis": "sliding", "pixel_pitch": "60 um"}
    return ObjectPlane(run_settings(optics=optics, prediction=options), (100, 300))


def frames():
    """Two cycles, of which every frame is a trigger."""
    columns = {
        "trigger": np.arange(FRAMES),
        "cycle": np.arange(FRAMES) // 50,
        "crank_angle": np.degrees(CRANK[STEPS]) % 360,
        "joint_load": np.full(FRAMES, 222.4),
        "time": MOTION.time[STEPS],
        "used": np.ones(FRAMES, bool),
    }
    return xr.Dataset({name: ("frame", column) for name, column in columns.items()})


def seen_by(orbit, line, rng=None):
    """Positions of an orbit [m] as an image shows them, whose middle is not the load line [mm].

    With a generator, noise of every trigger and an error that all share are added.
    """
    angle = (line - MIDDLE) / RADIUS
    about_middle = orbit @ [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
    gradient = np.zeros((4, 3))
    gradient[[0, 1], [0, 1]] = SHARED / 1e-3
    place = 1e6 * about_middle
    if rng is not None:
        place += rng.normal(size=place.shape) * 1e6 * STD + rng.normal(size=2) * SHARED
    random = np.diag([*(1e6 * STD) ** 2, 1e-8, 1e-8])
    like = replace(make_position(), surface_cov=np.zeros((4, 4)), gradient=gradient)
    positions = [replace(like, value=np.array([*one, 0, 0]), random_cov=random) for one in place]
    return describe_positions(positions, CALIBRATION, plane().view)


def placed(variables, **options):
    about = plane(**options)
    attrs = {
        "settings": to_toml(about.settings),
        "calibration": record_calibration(RunCurve.of(CALIBRATION)),
    }
    film = xr.Dataset(variables, {"x": about.x, "y": about.y}, attrs)
    return place_positions(about, film, frames())


def test_turned_positions_are_those_of_a_fit_about_the_other_line():
    ratios = noisy_ratios(circle_gap(224.0, 5.0, 0.01, 0.05), 0.01, np.random.default_rng(1))
    calibration, other = known_calibration(), replace(VIEW, load_line=VIEW.load_line + 1.5)
    there, about = (
        describe_positions(
            [find_pin_position(ratios, calibration, region=WHOLE, view=view)], calibration, view
        )
        for view in (VIEW, other)
    )
    line = LoadLine(other.load_line, None, "swing")
    turned = turn_positions(there, line, VIEW.radius)
    for name in ("pin_displacement", "pin_tilt", "pin_position_gradient"):
        npt.assert_allclose(turned[name].values, about[name].values, rtol=1e-3, atol=2e-4)
    for name in ("pin_position_cov", "pin_position_cov_random"):
        std, same = (np.sqrt(np.diag(one[name].values[0])) for one in (turned, about))
        npt.assert_allclose(std, same, rtol=0.01)
    assert turned["pin_displacement"].attrs["load_line"] == other.load_line


def test_sideways_displacements_about_a_fitted_line_are_within_their_errors():
    """Forty rigs, whose line is up to 2 mm from the middle; 68 and 95 % are expected.

    The orbit follows from another solver, and the pin starts off the load line.
    """
    pulls, lines = [], []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        orbit = free_orbit((212e-6, rng.uniform(-30e-6, 30e-6)))
        line = MIDDLE + rng.uniform(-2, 2)
        film, notes = placed(seen_by(orbit, line, rng))
        attrs = film.pin_displacement.attrs
        assert attrs["load_line_source"] == "fitted"
        assert "fitted to the orbit" in str(notes[0])
        lines.append((attrs["load_line"] - line) / attrs["load_line_std"])
        off = (film.pin_displacement.values[:, 1] - 1e6 * orbit[:, 1]).mean()
        pulls.append(off / np.sqrt(film.pin_position_cov.values[:, 1, 1].mean()))
    for each in (pulls, lines):
        assert np.abs(each).max() < 4
        assert 0.55 < np.mean(np.abs(each) < 1) < 0.9
        assert np.mean(np.abs(each) < 2) > 0.88


def test_the_error_of_the_line_counts_in_the_displacement_and_in_no_fit():
    film, _ = placed(seen_by(free_orbit((212e-6, 0.0)), 10.0))
    std = film.pin_displacement.attrs["load_line_std"]
    variance = film.pin_position_cov.values[0, 1, 1]
    by_line = (film.pin_displacement.values[0, 0] * std / RADIUS) ** 2
    npt.assert_allclose(variance, SHARED[1] ** 2 + (1e6 * STD[1]) ** 2 + by_line, rtol=0.02)

    found = measured_positions(film, CALIBRATION.full_covariance)
    whole = found.random_cov + found.shared @ np.swapaxes(found.shared, 1, 2)
    npt.assert_allclose(whole[0, 1, 1] * 1e12, variance - by_line, rtol=1e-6)


def swinging(directions):
    """Positions of a pin that is displaced by 220 um in these directions. [rad]"""
    return seen_by(220e-6 * np.stack([np.cos(directions), np.sin(directions)], axis=1), MIDDLE)


def test_the_line_of_an_orbit_that_no_squeeze_makes_is_the_middle_of_the_swing():
    """1 degree is 0.5843 mm of a radius of 33.4748 mm."""
    half = MOTION.angle[STEPS] / 2
    film, notes = placed(swinging(half + np.radians(2)))
    assert film.pin_displacement.attrs["load_line"] == pytest.approx(MIDDLE + 1.1685, abs=1e-3)
    assert film.pin_displacement.attrs["load_line_source"] == "swing"
    assert "the middle of the swing" in str(notes[0])

    film, _ = placed(swinging(np.full(FRAMES, np.radians(-1.5))), sideways="guided")
    assert film.pin_displacement.attrs["load_line"] == pytest.approx(MIDDLE - 0.8764, abs=1e-3)
    npt.assert_allclose(film.pin_displacement.values[:, 1], 0, atol=1e-9)


def test_a_given_line_and_joints_without_a_swing_keep_their_positions():
    seen = swinging(MOTION.angle[STEPS] / 2)
    film, notes = placed(seen, load_line="8.97 mm")
    npt.assert_array_equal(film.pin_displacement, seen["pin_displacement"])
    npt.assert_array_equal(film.pin_position_cov, seen["pin_position_cov"])
    assert (film.pin_displacement.attrs["load_line_source"], notes) == ("given", [])

    wide, _ = placed(seen, load_line="8.97 mm", load_line_std="0.2 mm")
    assert (wide.pin_position_cov.values[:, 1, 1] > film.pin_position_cov.values[:, 1, 1]).all()

    line = find_load_line(plane(), xr.Dataset(seen), frames().drop_vars("joint_load"))
    assert line == LoadLine(pytest.approx(MIDDLE), None, "middle")
    lost = swinging(np.full(FRAMES, np.nan))
    assert find_load_line(plane(), xr.Dataset(lost), frames()).source == "middle"
    film, notes = place_positions(plane(), xr.Dataset(), frames())
    assert not film
    assert notes == []
