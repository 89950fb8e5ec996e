"""Faults of a recording in words, from numbers that a test makes up."""

from erlif.pipeline.watch.faults import describe_fall, describe_missing
from erlif.pipeline.watch.live import LivePair


def pairs(lights):
    zero = (0.0, 0.0)
    return [
        LivePair(n, "", 0.0, 2.0, 0.1, 2.0, 0.1, 1.0, (900.0, light), zero, zero)
        for n, light in enumerate(lights)
    ]


def test_a_fall_to_three_quarters_is_stated_for_its_camera():
    assert describe_fall(pairs([1000.0] * 20 + [760.0] * 20)) == ""
    assert "camera 2 falls: at most 740 DN" in describe_fall(pairs([1000.0] * 20 + [740.0] * 20))


def test_the_start_is_that_of_the_recording_and_not_of_the_measurement():
    """The newest pair is measured first: after a delay the first ones come last."""
    fallen = pairs([1000.0] * 20 + [740.0] * 20)
    assert describe_fall(fallen[::-1]) == describe_fall(fallen)
    assert describe_fall(pairs([740.0] * 20 + [1000.0] * 20)[::-1]) == ""


def test_a_film_that_darkens_single_pairs_is_no_fall():
    assert describe_fall(pairs([1000.0, 300.0] * 30)) == ""


def test_names_beyond_three_are_counted():
    found = describe_missing({f"f_{n}.tif": 1 for n in range(5)} | {"g.tif": 2})
    assert found["frames of camera 1"].endswith("f_0.tif, f_1.tif, f_2.tif and of 2 more")
    assert found["frames of camera 2"] == "camera 2 lacks the partner of g.tif"
