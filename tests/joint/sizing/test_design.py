"""joint.toml to a design."""

import math
import tomllib

import pytest

import erlif
from erlif.core.errors import ConfigError
from erlif.joint.settings import DesignSettings
from erlif.joint.sizing import assess_joint
from erlif.joint.sizing.design import design, example_design, example_joint, example_joint_file


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "joint.toml"
    path.write_text(example_joint_file(), encoding="utf-8")
    return path


def test_the_example_is_sound_and_complete_and_sized_gives_itself_again(path):
    first = erlif.joint.design(path)
    assert first.sound
    assert not first.assessment.doubtful
    assert first.assessment.steps == example_design().assessment.steps
    for assessment in (first.assessment, assess_joint(example_joint())):
        assert {step.key for step in assessment.missing} == {"pressure_limit"}

    again = design(DesignSettings.model_validate(tomllib.loads(first.settings)))
    assert again.chosen == ()
    for one, two in zip(first.assessment.steps, again.assessment.steps, strict=True):
        assert two.margin == pytest.approx(one.margin, rel=1e-9, abs=1e-9, nan_ok=True)


def test_all_unknown_materials_are_refused_at_once_with_the_nearest(path):
    text = example_joint_file().replace("CuAl10Ni5Fe4", "CuSn12").replace('"S355"', '"St52"')
    path.write_text(text, encoding="utf-8")
    nearest = r"\[bushing\] material.*did you mean 'CuSn12Ni2'.*\[seat\].*\[lock\]"
    with pytest.raises(ConfigError, match=nearest):
        design(path)


def test_a_table_of_the_user_is_found_beside_the_file(path):
    table = path.parent / "own.csv"
    table.write_text("name,yield_MPa,youngs_modulus_GPa\nown bronze,300,105\n", encoding="utf-8")
    text = example_joint_file().replace('# materials = "materials.csv"', 'materials = "own.csv"')
    path.write_text(text.replace('"CuAl10Ni5Fe4"', '"own bronze"'), encoding="utf-8")
    designed = design(path)
    assert designed.joint.bushing.yield_stress == 300e6
    assert "hardness of [bushing]" in {step.missing for step in designed.assessment.missing}


def test_values_of_joint_toml_replace_those_of_the_table(path):
    text = example_joint_file().replace('# hardness = "200 HB"', 'hardness = "150 HB"', 2)
    path.write_text(text, encoding="utf-8")
    ring = design(path).joint.bushing
    assert (ring.name, ring.hardness_high) == ("CuAl10Ni5Fe4, changed", 150.0)


def test_sensitivities_and_substitutes_are_those_of_the_joint():
    designed = example_design()
    assert designed.sensitivities is designed.sensitivities  # computed once
    assert designed.sensitivities[0].name == "load"
    assert "CuNi15Sn8 hardened" in {one.material.name for one in designed.substitutes}


def test_a_pin_that_is_only_supported_has_twice_the_stress():
    """A beam on two supports with F l / 4, where one with clamped ends has F l / 8."""
    joint = example_design().joint
    free, d = joint.bushing_width + joint.lateral_play, joint.pin_diameter
    stress = joint.force * free / 4 / (math.pi * d**3 / 32)
    margin = joint.pin.yield_stress / joint.safety / stress - 1
    assert f"a margin of {100 * margin:+.0f} %." in example_design().notes[0]


def test_a_design_is_shown_by_its_sizes_and_its_weakest_limit():
    assert "pin 31.5 mm, bushing 40 mm; all limits that are checked hold; weakest" in repr(
        example_design()
    )
