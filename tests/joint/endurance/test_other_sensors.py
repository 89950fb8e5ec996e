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


def test_sensors_that_show_nothing_are_left_out():
    """Not logged, of either sign, or standing still, where rounding must not confirm galling."""
    test = test_of(2.0, 2.5, seed=1)
    stuck = test.assign(temperature=0 * test.temperature + 30.0)
    for changed, kept in (
        (test.drop_vars(["temperature"]), ["vibration"]),
        (test - 25, ["temperature"]),
        (stuck, ["vibration"]),
    ):
        assert [one.name for one in check_other_sensors(changed, STAGE, ONSET)] == kept
    assert unusable_sensors(stuck, [STAGE], ONSET) == {"temperature": "reads 30 throughout"}

    # an interval as long as the stage, and an onset at its very end
    wide = replace(ONSET, earliest=-1.0, latest=500.0)
    late = replace(ONSET, time=397.0, earliest=396.0, latest=398.0)
    assert check_other_sensors(test, STAGE, wide) == check_other_sensors(test, STAGE, late) == ()


def test_a_sensor_that_sticks_in_the_stage_of_the_onset_or_has_no_level_is_named():
    longer = test_of(2.0, 2.5, seed=1)
    longer["temperature"][100:] = 30.0
    longer["vibration"][150] = 0.0
    stages = [replace(STAGE, last=99), replace(STAGE, number=2, first=100)]
    unusable = unusable_sensors(longer, stages, replace(ONSET, stage=1))
    assert unusable["temperature"] == "reads 30 throughout stage 2"
    assert unusable["vibration"].startswith("is not positive")
    assert unusable_sensors(longer, stages, None) == {}
