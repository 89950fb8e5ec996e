"""A finished design."""

from erlif.joint.sizing.design import example_design


def test_sensitivities_and_substitutes_are_those_of_the_joint():
    designed = example_design()
    assert designed.sensitivities is designed.sensitivities  # computed once
    assert designed.sensitivities[0].name == "load"
    assert "CuNi15Sn8 hardened" in {one.material.name for one in designed.substitutes}
