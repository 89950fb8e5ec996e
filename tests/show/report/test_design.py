"""A design in sentences and tables."""

import tomllib

from erlif.io.settings import DesignSettings
from erlif.joint.sizing import read_materials
from erlif.joint.sizing.design import design, example_design, example_joint_file
from erlif.show.report import list_materials, summarise_design


def changed(*changes):
    text = example_joint_file()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return design(DesignSettings.model_validate(tomllib.loads(text)))


def test_a_sound_design_names_its_weakest_margin():
    text = summarise_design(example_design())
    assert "All limits hold; the weakest is:" in text
    assert "rounded up to R20" in text
    assert "pressure limit of the bushing (section 2.1.13): give largest_pressure" in text
    assert "* temperature of the surface: margin of the rise over the outside" in text
    assert "Note: Fatigue is not checked at 2.2e+06 swings" in text
    assert max(len(line) for line in text.splitlines()) <= 120


def test_an_unsound_design_names_what_to_change():
    text = summarise_design(changed(('# diameter = "80 mm"', 'diameter = "20 mm"')))
    assert "limits are exceeded; the worst is:" in text
    assert "pin diameter of at least" in text


def test_numbers_are_written_as_a_reader_expects():
    comment = "# Name in the table of materials. Default: none, all values are given here.\n"
    text = summarise_design(
        changed(
            ('interference = "60 um"', 'interference = "0 um"'),
            ('period = "8 s"', 'period = "1 s"'),
            (f'[seat]\n\n{comment}material = "S355"\n', ""),
        )
    )
    assert "-0 um" not in text
    assert "holds (doubtful)" in text
    assert "(doubtful): outside of the validity" in text
    assert "seat S355 (assumed), housing S355" in text
    assert "bent pin: slope, 1 where it folds" in text
    assert "friction moment" in text


def test_a_housing_that_is_too_small_has_no_infinite_stress():
    text = summarise_design(changed(('# diameter = "200 mm"', 'diameter = "20 mm"')))
    assert "does not fit into a housing of 20 mm" in text
    assert "no section left" in text
    assert "inf " not in text


def test_a_design_without_motion_lists_what_is_missing():
    text = example_joint_file()
    start, end = text.index("[motion]"), text.index("[life]")
    text = text[:start] + text[end:]
    found = summarise_design(design(DesignSettings.model_validate(tomllib.loads(text))))
    assert "give [motion] half_swing and period" in found
    assert "speed not known" in found


def test_values_without_a_source_are_named():
    text = summarise_design(changed(("CuAl10Ni5Fe4", "CuNi15Sn8 hardened")))
    assert "CuNi15Sn8 hardened: all other values" in text
    assert "without a source" not in summarise_design(example_design())


def test_the_list_of_materials_has_all_of_them_with_their_sources():
    lines = list_materials(read_materials()).splitlines()
    assert len(lines) == len(read_materials()) + 1
    assert "EN 1982:2017" in "\n".join(lines)
