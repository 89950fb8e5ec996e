"""Load at failure."""

import numpy as np
import pytest
import xarray as xr

from erlif.joint.endurance import Onset, Stage, failure_load

TIME = np.arange(200.0)
STAGES = (Stage(1, 0, 99, 0.0, 99.0, 36e3), Stage(2, 100, 199, 100.0, 199.0, 54e3))


def test_of(load):
    return xr.Dataset({"load": ("time", load)}, {"time": TIME})


test_of.__test__ = False


def onset(places):
    weights = np.full(len(places), 1 / len(places))
    return Onset(0, 0, 0, 1, 0.1, 0.1, 0.01, np.array(places, float), weights)


@pytest.mark.parametrize(
    ("places", "calibration", "std"), [([150.0], 0.01, 530), ([120.0, 180.0], 0.0, 600)]
)
def test_load_at_failure_is_that_of_the_onset_and_as_uncertain(places, calibration, std):
    load = np.where(TIME < 100, 36e3, 54e3 - 20 * (TIME - 100))
    found = failure_load(test_of(load), STAGES, onset(places), calibration=calibration)
    assert (found.load, found.std) == pytest.approx((53e3, std))
    assert (found.survived, found.failed, found.stage) == (36e3, True, 2)


def test_a_test_that_survives_is_censored_at_its_highest_load():
    found = failure_load(test_of(np.full(200, 54e3)), STAGES, None)
    assert (found.load, found.failed, found.survived) == (54e3, False, 54e3)
