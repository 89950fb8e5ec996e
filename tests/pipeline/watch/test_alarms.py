"""Alarms: limits that a person sets."""

import math

from erlif.pipeline.watch.alarms import Alarms
from erlif.pipeline.watch.live import LivePair


def pair(film=3.0, saturated=(0.0, 0.0)):
    return LivePair(7, "", 0.0, film, 0.1, film, 0.1, 1.0, (9.0, 9.0), saturated, (0.0, 0.0))


def test_no_limit_raises_no_alarm():
    assert Alarms().raised([pair(0.0, (1.0, 1.0))], silence=1e9) == {}


def test_each_limit_names_value_pair_and_camera():
    limits = Alarms(film_below=2.0, saturated_above=0.01, no_pulse_for=2.0)
    assert limits.raised([pair()], silence=1.9) == {}
    found = limits.raised([pair(1.96), pair(1.5, (0.002, 0.034))], silence=2.5)
    assert found == {
        "film": "minimum film 1.50 um in pair 7 (limit 2 um)",
        "saturated": "camera 2 saturates in 3.4 % of pair 7 (limit 1 %)",
        "no pulse": "no pulse for 2.5 s (limit 2 s)",
    }


def test_a_pair_without_a_film_raises_no_alarm_of_the_film():
    assert Alarms(film_below=2.0).raised([pair(math.nan)], silence=0.0) == {}


def test_a_limit_of_a_film_that_is_not_known_is_stated():
    unknown = pair(film=float("nan"))
    assert "pair 7" in Alarms(film_below=2.0).describe_unjudged(unknown)
    assert not Alarms(film_below=2.0).describe_unjudged(pair(film=1.0))
    assert not Alarms().describe_unjudged(unknown)
