"""plan.toml: what a plan may hold, and one message for each slip."""

import tomllib

import pytest

from erlif.core.errors import ConfigError
from erlif.io.settings import PlanSettings, read_plan_settings, to_toml
from erlif.planning.plan import example_plan

DYE1 = 'concentration = "0.008 mol/L"'
LIGHT1 = 'thick_film = "11000 electron"'


@pytest.fixture
def edited(tmp_path):
    """The message about the example plan after changes of its text."""

    def edit(*changes):
        text = example_plan()
        for old, new in changes:
            assert old in text
            text = text.replace(old, new, 1)
        path = tmp_path / "plan.toml"
        path.write_text(text, encoding="utf-8")
        return read_plan_settings(path)

    return edit


def test_the_example_is_a_plan(edited):
    settings = edited()
    assert settings.dye2.concentration == 0.024
    assert settings.covered == (0.1e-6, 18e-6)
    assert settings.tolerances.filter == 2.0


def test_a_plan_is_the_same_after_writing_and_reading(edited):
    settings = edited((DYE1, 'concentration = "8 mM"'))
    assert settings.dye1.concentration == 0.008
    again = PlanSettings.model_validate(tomllib.loads(to_toml(settings)))
    assert again == settings


def test_the_fixture_covers_the_films_by_default(edited):
    settings = edited(('thinnest = "0.1 um"', ""), ('thickest = "18 um"', ""))
    assert settings.covered == pytest.approx((0.1e-6, 15e-6))


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        # slips of the laboratory
        ([('thinnest = "2 um"', 'thinnest = "20 um"')], "Exchange them"),
        ([(DYE1, 'concentration = "0 mol/L"')], "greater than 0"),
        ([(DYE1, 'concentration = "8 mol/L"')], "Is it 8 mmol/L?"),
        ([(DYE1, "concentration = 0.008")], "with a unit in quotes"),
        ([(DYE1, 'concentration = "8 g/L"')], "cannot be converted"),
        (
            [('# full_well = "18000 electron"', 'full_well = "5 electron"')],
            "full well of at least ten times the read noise",
        ),
        ([('band = "580 nm"', 'band = "530 nm"')], "filters above the laser"),
        ([('# filter = "2 nm"', 'filter = "60 nm"')], "less than or equal to 20"),
        ([('thickest = "18 um"', 'thickest = "8 um"')], "a fixture that covers the films"),
        ([('band = "580 nm"', 'bandd = "580 nm"')], "did you mean 'band'"),
        ([("[film]", "[films]")], "did you mean 'film'"),
        ([('# offset = "64 DN"', 'offset = "5000 DN"')], "an offset below full scale"),
        ([("quantum_yield = 0.7", "quantum_yield = 70")], "less than or equal to 1"),
        # how a dye and its light are given
        ([('spectra = "synthetic 605"', "")], "give the dye once"),
        ([('# absorption = "dye1_absorption.csv"', 'absorption = "a.csv"')], "together"),
        ([(LIGHT1, "")], "give either thick_film"),
        ([(LIGHT1, "efficiency = 0.3")], "add them, or give thick_film of both cameras"),
    ],
)
def test_a_slip_has_one_clear_message(edited, changes, expected):
    with pytest.raises(ConfigError) as raised:
        edited(*changes)
    message = str(raised.value)
    assert expected in message
    assert len(message.splitlines()) <= 3
