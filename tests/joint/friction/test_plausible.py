"""Friction coefficients that no bearing has."""

import pytest

from erlif.joint.friction.plausible import doubt_friction


@pytest.mark.parametrize("friction", [0.0001, 15.36, 120.0, float("nan")])
def test_what_no_bearing_has_is_doubted(friction):
    (line,) = doubt_friction(friction, radius=0.03336, arm=30.0)
    assert "implausible" in line
    assert "the arm of 30 m" in line


@pytest.mark.parametrize("friction", [0.01, 0.15, 1.0])
def test_a_bearing_from_lubricated_to_galled_is_not_doubted(friction):
    assert doubt_friction(friction, radius=0.03336, arm=0.3) == []
