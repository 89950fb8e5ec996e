"""The test of the examples."""

from erlif.show.plots.endurance_example import example_test


def test_one_fails_and_one_survives():
    assert example_test().failure.failed
    assert not example_test(galls=False).failure.failed
