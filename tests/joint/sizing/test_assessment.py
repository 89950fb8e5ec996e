"""The steps of the guide against a second calculation, for random joints."""

import math

import numpy as np
from scenes.guide import margins
from scenes.joints import random_joint

from conftest import FULL
from erlif.joint.sizing import assess_joint, size_joint
from erlif.joint.sizing.design import example_joint

SEED = 20051007  # any other number of cases and seeds has passed too


def check(joint):
    """Every margin is that of the second calculation, and none is left out."""
    assessment, expected = assess_joint(joint), margins(joint)
    steps = {step.key: step.margin for step in assessment.steps if not math.isnan(step.margin)}
    assert steps.keys() == expected.keys()
    for key, value in expected.items():
        # the fit of a nearly vanishing ring or contact loses digits
        assert math.isclose(steps[key], value, rel_tol=1e-6, abs_tol=1e-6), key
    return assessment


def test_all_margins_of_random_joints_agree_with_a_second_calculation():
    rng = np.random.default_rng(SEED)
    check(example_joint())
    series = ("none", "none", "R20", "R40")
    sound = failed = 0
    for n in range(200 if FULL else 100):
        joint = random_joint(rng, sized=(0.0, 0.5)[n % 2])
        assessment = check(size_joint(joint, series=series[n % 4]))
        sound += assessment.sound
        failed += not assessment.sound
    assert sound > 20
    assert failed > 20  # the cases have both
