"""The joint and its dimensions."""

import pytest
from scenes.joints import altered

from erlif.core.errors import ModelError, UnitWarning
from erlif.joint.sizing import assess_joint, size_joint


def test_a_dimension_that_is_not_known_is_named():
    with pytest.raises(ModelError, match="wall must be known"):
        assess_joint(altered(wall=None))


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"force": 1e11}, "force = 1e"),
        ({"half_swing": 30.0}, "half_swing = 30 rad"),
        ({"play": 160.0}, "play = 160 m .* mm or um"),
        ({"pin": {"youngs_modulus": 210.0}}, r"pin\.youngs_modulus = 210 Pa"),
        ({"housing": {"expansion": 12.0}}, r"housing\.expansion = 12 1/K"),
        ({"lock": {"lever": 80.0}}, r"lock\.lever = 80 m"),
    ],
)
def test_a_slip_of_units_is_named(changed, named):
    with pytest.warns(UnitWarning, match=named) as caught:
        size_joint(altered(**changed))
    assert caught[0].filename == __file__


def test_strengths_are_looked_at_in_an_assessment_too():
    with pytest.warns(UnitWarning, match=r"seat\.yield_stress = 335 Pa"):
        assess_joint(altered(seat={"yield_stress": 335.0}))
