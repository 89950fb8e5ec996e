"""The joint of the examples."""

from erlif.joint.sizing import assess_joint, example_joint


def test_all_steps_but_those_that_need_a_test_are_computed():
    missing = {step.key for step in assess_joint(example_joint()).missing}
    assert missing == {"pressure_limit"}
