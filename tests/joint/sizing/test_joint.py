"""The joint and its dimensions."""

from dataclasses import replace

import pytest

from erlif.core.errors import ModelError
from erlif.joint.sizing import dimensions_of, example_joint


def test_derived_dimensions():
    size = dimensions_of(example_joint())
    assert size.fit == pytest.approx(0.1)  # 80 mm and twice 10 mm
    assert size.length == pytest.approx(0.18)  # 100 mm and twice 40 mm


def test_speed_of_the_rig_of_farzaneh():
    """Eq. 26: 24.426 degrees from end to end at 114 rpm on 66.72 mm, 54.04 mm/s."""
    joint = replace(example_joint(), half_swing=0.2131570, period=60 / 114)
    assert joint.speed(0.06672) == pytest.approx(0.05404, rel=1e-4)
    assert replace(joint, life=None).sliding_distance is None
    assert replace(joint, period=None).speed(0.06672) is None


def test_a_dimension_that_is_not_known_is_named():
    with pytest.raises(ModelError, match="wall must be known"):
        dimensions_of(replace(example_joint(), wall=None))
