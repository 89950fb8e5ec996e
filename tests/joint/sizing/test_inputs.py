"""Numbers of a joint that are in a wrong unit."""

from dataclasses import replace

import pytest

from erlif.core.errors import UnitWarning
from erlif.joint.sizing import example_joint, size_joint, walk_guide

JOINT = example_joint()


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"force": 1e11}, "force = 1e"),
        ({"half_swing": 30.0}, "half_swing = 30 rad"),
        ({"bushing_width": 100.0}, "bushing_width = 100 m"),
        ({"play": 160.0}, "play = 160 m .* mm or um"),
        ({"pin": replace(JOINT.pin, yield_stress=650.0)}, r"pin\.yield_stress = 650 Pa"),
        ({"pin": replace(JOINT.pin, youngs_modulus=210.0)}, r"pin\.youngs_modulus = 210 Pa"),
        ({"bushing": replace(JOINT.bushing, wear=5e-8)}, r"bushing\.wear = 5e-08 1/Pa"),
        ({"housing": replace(JOINT.housing, expansion=12.0)}, r"housing\.expansion = 12 1/K"),
        ({"lock": replace(JOINT.lock, lever=80.0)}, r"lock\.lever = 80 m"),
    ],
)
def test_a_slip_of_units_is_named(changed, named):
    with pytest.warns(UnitWarning, match=named) as caught:
        size_joint(replace(JOINT, **changed))
    assert caught[0].filename == __file__


def test_strengths_and_loads_are_looked_at_in_a_check_too():
    with pytest.warns(UnitWarning, match=r"seat\.yield_stress = 335 Pa"):
        walk_guide(replace(JOINT, seat=replace(JOINT.seat, yield_stress=335.0)))
