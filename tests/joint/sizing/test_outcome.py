"""A finished design."""

from erlif.joint.sizing.design import example_design


def test_sensitivities_and_substitutes_are_those_of_the_joint():
    designed = example_design()
    assert designed.sensitivities is designed.sensitivities  # computed once
    assert designed.sensitivities[0].name == "load"
    assert "CuNi15Sn8 hardened" in {one.material.name for one in designed.substitutes}


def test_a_design_is_shown_by_its_sizes_and_its_weakest_limit():
    assert "pin 31.5 mm, bushing 40 mm; all limits hold; weakest" in repr(example_design())
