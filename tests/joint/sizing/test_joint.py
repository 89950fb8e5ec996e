"""The joint and its dimensions."""

import math

import pytest
from scenes.joints import altered

from erlif.core.errors import ModelError
from erlif.joint.sizing import assess_joint, dimensions_of
from erlif.joint.sizing.design import example_joint


def test_derived_dimensions():
    size = dimensions_of(example_joint())
    assert size.fit == pytest.approx(0.1)  # 80 mm and twice 10 mm
    assert size.length == pytest.approx(0.18)  # 100 mm and twice 40 mm


def test_speed_of_the_rig_of_farzaneh():
    """Eq. 26: 24.426 degrees from end to end at 114 rpm on 66.72 mm, 54.04 mm/s."""
    joint = altered(half_swing=0.2131570, period=60 / 114)
    assert joint.speed(0.06672) == pytest.approx(0.05404, rel=1e-4)
    assert math.isnan(altered(joint, life=None).sliding_distance)
    assert math.isnan(altered(joint, period=None).speed(0.06672))


def test_a_dimension_that_is_not_known_is_named():
    with pytest.raises(ModelError, match="wall must be known"):
        assess_joint(altered(wall=None))
