"""The path of a guided pin through a gap of its triggers, against that of the virtual rig."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.kept import kept_orbit, name_of
from scenes.orbits import RIG, SPEED, STATED
from scenes.pin import RIG as RIG_OF_PIN
from scenes.pin import follow_true_pin
from scipy.interpolate import CubicSpline

from erlif.prediction import follow_motion
from erlif.prediction.gaps import MOST_FILLED, find_motion_in_gaps
from erlif.rig.film import crank_at
from erlif.rig.journal import follow_pin

PERIOD = 2 * np.pi / SPEED
NOISE = np.diag([4e-9, 4e-8, 1e-9, 1e-8]) ** 2
COUNT = 50
CLOSING = np.arange(39, 44)
"""Triggers about which a cavity closes and another opens: the pin turns within two of them."""


GUIDED = replace(RIG_OF_PIN, sideways="guided", elapsed=6.0, load=2000.0)


@pytest.fixture(scope="module")
def path():
    """Displacements of the guided pin [m] as a function of time."""
    time = np.linspace(0.0, 1.01 * PERIOD, 4001)
    place = kept_orbit(f"1.01 turns, {name_of(GUIDED)}", lambda: follow_pin(time, GUIDED))
    return CubicSpline(time, place)


@pytest.fixture(scope="module")
def free_pin():
    return follow_true_pin(COUNT)


@pytest.fixture(scope="module")
def guided_pin(path, free_pin):
    return replace(free_pin, rig=GUIDED, position=np.pad(path(free_pin.time), ((0, 0), (0, 2))))


@pytest.fixture(scope="module")
def along(path):
    return lambda time: path(time)[..., 0]


def fill(pin, missing):
    """The path without some triggers."""
    kept = np.setdiff1d(np.arange(COUNT), missing)
    time = np.append(pin.time[kept], pin.time[kept[0]] + PERIOD)
    frames = {
        "time": time,
        "crank_angle": np.degrees(crank_at(time, pin.rig)) % 360,
        "cycle": np.zeros(time.size, int),
        "joint_load": np.full(time.size, pin.rig.load),
    }
    frames = xr.Dataset({name: ("frame", values) for name, values in frames.items()})
    noise = np.random.default_rng(2).multivariate_normal(np.zeros(4), NOISE, COUNT)
    return find_motion_in_gaps(
        replace(STATED, cavitation_pressure=1e3 * pin.rig.cavitation_pressure),
        follow_motion(frames, RIG, crank_speed=SPEED, viscosity=STATED.viscosity),
        time=time,
        turning=pin.turning[kept],
        position=(pin.position + noise)[kept],
        random_cov=np.tile(NOISE, (kept.size, 1, 1)),
        surface_cov=np.tile(0.1 * NOISE, (kept.size, 1, 1)),
        gradient=np.zeros((kept.size, 4, 1)),
        calibration_cov=np.zeros((1, 1)),
        load_line_std=0.0,
    )


def missed(along, found):
    """Errors of the path between triggers with and without the prediction, [m], and its std."""
    between = ~found.recorded
    true = along(found.time[between])
    paths = (path.position[between, 0] - true for path in (found, found.otherwise))
    return *paths, np.sqrt(found.random_cov[between, 0, 0])


def test_a_gap_that_closes_the_turn_is_crossed_as_the_rig_crosses_it(guided_pin, along):
    """By the prediction to a third of what the smooth path is off, and within its errors."""
    found = fill(guided_pin, np.arange(45, 50))
    filled, smooth, std = missed(along, found)
    assert np.abs(filled).max() < 0.5 * np.abs(smooth).max()
    assert np.abs(filled / std).max() < 3
    assert found.widest_gap < 0.03


def test_a_corner_in_a_gap_is_cut_by_no_more_than_without_a_prediction(guided_pin, along):
    found = fill(guided_pin, CLOSING)
    filled, smooth, _ = missed(along, found)
    assert filled.size >= CLOSING.size
    assert found.recorded.sum() == COUNT - CLOSING.size
    assert np.abs(filled).max() < 1.1 * np.abs(smooth).max()
    # away from it the path is that of the triggers
    far = found.recorded & (np.abs(found.time - guided_pin.time[41]) > 0.2 * PERIOD)
    npt.assert_allclose(found.position[far, 0], along(found.time[far]), atol=3e-8)


def test_no_gap_is_filled_that_is_too_long_or_by_a_pin_that_is_not_guided(guided_pin, free_pin):
    assert fill(guided_pin, np.arange(20, 20 + int(MOST_FILLED * COUNT) + 1)) is None
    assert fill(free_pin, CLOSING) is None
