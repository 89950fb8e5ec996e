"""The steps of the guide against a second calculation, for joints of every kind."""

import math

import numpy as np
import pytest
from scenes.guide import margins
from scenes.joints import random_joint

from erlif.core.errors import ModelError
from erlif.joint.sizing import (
    DIMENSIONS,
    Joint,
    example_joint,
    read_materials,
    size_joint,
    walk_guide,
)

SEED = 20051007  # any other number of cases and seeds has passed too


def check(joint):
    """Every margin is that of the second calculation, and none is left out."""
    walk, expected = walk_guide(joint), margins(joint)
    found = {step.key: step.margin for step in walk.steps if not math.isnan(step.margin)}
    assert found.keys() == expected.keys()
    for key, value in expected.items():
        # the fit of a nearly vanishing ring or contact loses digits
        assert math.isclose(found[key], value, rel_tol=1e-6, abs_tol=1e-6), key
    return walk


def test_all_margins_of_1000_random_joints_agree_with_a_second_calculation():
    rng = np.random.default_rng(SEED)
    series = ("none", "none", "R20", "R40")
    sound = failed = 0
    for n in range(1000):
        joint = random_joint(rng, sized=(0.0, 0.5)[n % 2])
        walk = check(size_joint(joint, series=series[n % 4]))
        sound += walk.sound
        failed += not walk.sound
    assert sound > 50
    assert failed > 50  # the cases have both


def test_the_example_agrees_too():
    check(example_joint())


def test_a_joint_without_its_dimensions_is_refused():
    steel = read_materials()["S355"]
    with pytest.raises(ModelError, match="pin_diameter must be known"):
        walk_guide(Joint(1e5, 2.0, steel, steel, steel, steel))
    assert DIMENSIONS[0] == "pin_diameter"
