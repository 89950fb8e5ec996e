"""The test of the documentation galls where the rig made it gall, or survives."""

from erlif.joint.plots.example import example_test


def test_the_example_galls_in_the_sixth_stage_or_survives():
    assert example_test().failure.stage == 6
    assert example_test(galls=False).onset is None
