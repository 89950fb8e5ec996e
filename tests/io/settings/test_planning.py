"""plan.toml: what a plan may hold, and one message for each slip."""

import tomllib
from pathlib import Path

import pytest

from erlif.core.errors import ConfigError
from erlif.io.settings import PlanSettings, read_plan_settings, to_toml
from erlif.planning.plan import example_plan

FAULTS = tomllib.loads(Path(__file__).with_name("faults.toml").read_text(encoding="utf-8"))
DYE1 = 'concentration = "0.008 mol/L"'


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


def test_a_plan_is_the_same_after_writing_and_reading(edited):
    settings = edited((DYE1, 'concentration = "8 mM"'))
    assert settings.dye1.concentration == 0.008
    again = PlanSettings.model_validate(tomllib.loads(to_toml(settings)))
    assert again == settings


def test_the_fixture_covers_the_films_by_default(edited):
    settings = edited(('thinnest = "0.1 um"', ""), ('thickest = "18 um"', ""))
    assert settings.covered == pytest.approx((0.1e-6, 15e-6))


def test_a_slip_has_one_clear_message(edited):
    for old, new, expected in FAULTS["plan"]:
        with pytest.raises(ConfigError) as raised:
            edited((old, new))
        message = str(raised.value)
        assert expected in message
        assert len(message.splitlines()) <= 3
