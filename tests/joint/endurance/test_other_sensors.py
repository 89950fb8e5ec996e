"""Temperature and vibration at the onset."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from erlif.joint.endurance import Onset, Stage, check_other_sensors
from erlif.joint.endurance.other_sensors import unusable_sensors

TIME = np.arange(0.0, 400.0, 2.0)
STAGE = Stage(1, 0, TIME.size - 1, 0.0, float(TIME[-1]), 36e3)
ONSET = Onset(300.0, 298.0, 302.0, 0, 0.1, 0.1, 0.01, np.array([300.0]), np.array([1.0]))


def test_of(slope, factor, *, seed):
    rng = np.random.default_rng(seed)
    warm = 25 + 6 * -np.expm1(-TIME / 500) + slope / 60 * np.maximum(TIME - 300, 0)
    level = 0.4 * np.where(TIME >= 300, factor, 1.0) * np.exp(0.1 * rng.standard_normal(TIME.size))
    columns = {"temperature": warm + 0.05 * rng.standard_normal(TIME.size), "vibration": level}
    return xr.Dataset({name: ("time", one) for name, one in columns.items()}, {"time": TIME})


test_of.__test__ = False


def test_a_rise_of_both_confirms_and_has_its_size():
    temperature, vibration = check_other_sensors(test_of(2.0, 2.5, seed=1), STAGE, ONSET)
    assert temperature.confirms
    assert temperature.low < 2.0 < temperature.high
    assert vibration.confirms
    assert vibration.low < 2.5 < vibration.high


def test_p_values_without_a_change_are_uniform():
    chances = [
        sensor.p_value
        for seed in range(8)
        for sensor in check_other_sensors(test_of(0.0, 1.0, seed=seed), STAGE, ONSET)
    ]
    assert np.mean(chances) == pytest.approx(0.5, abs=0.22)  # standard error 0.07
    assert sum(chance < 0.05 for chance in chances) <= 4  # of 16


def test_a_sensor_that_is_not_logged_shows_nothing():
    assert check_other_sensors(test_of(2.0, 2.5, seed=1).drop_vars(["temperature"]), STAGE, ONSET)[
        0
    ].name == ("vibration")
    signed = test_of(2.0, 2.5, seed=1) - 25
    assert [one.name for one in check_other_sensors(signed, STAGE, ONSET)] == ["temperature"]


def test_a_sensor_that_stands_still_shows_nothing():
    """Rounding must not confirm galling."""
    stuck = test_of(2.0, 2.5, seed=1)
    stuck["temperature"][:] = 30.0
    assert [one.name for one in check_other_sensors(stuck, STAGE, ONSET)] == ["vibration"]
    assert unusable_sensors(stuck, [STAGE], ONSET) == {"temperature": "reads 30 throughout"}


def test_a_sensor_that_sticks_in_the_stage_of_the_onset_or_has_no_level_is_named():
    longer = test_of(2.0, 2.5, seed=1)
    longer["temperature"][100:] = 30.0
    longer["vibration"][150] = 0.0
    stages = [replace(STAGE, last=99), replace(STAGE, number=2, first=100)]
    unusable = unusable_sensors(longer, stages, replace(ONSET, stage=1))
    assert unusable["temperature"] == "reads 30 throughout stage 2"
    assert unusable["vibration"].startswith("is not positive")
    assert unusable_sensors(longer, stages, None) == {}


def test_an_interval_as_long_as_the_stage_shows_nothing():
    wide = replace(ONSET, earliest=-1.0, latest=500.0)
    assert check_other_sensors(test_of(2.0, 2.5, seed=1), STAGE, wide) == ()


def test_an_onset_at_the_very_end_shows_nothing():
    late = Onset(397.0, 396.0, 398.0, 0, 0.1, 0.1, 0.01, np.array([397.0]), np.array([1.0]))
    assert check_other_sensors(test_of(2.0, 2.5, seed=1), STAGE, late) == ()
