"""docs/sources.md is what the models say, and says of each published number whether they agree."""

from pathlib import Path

import pytest

from erlif.models.sources import MODELS, published_numbers, render_sources

NUMBERS = published_numbers()

DIFFERING = {  # found by deriving each equation again, apart from this code; the other numbers were reproduced
    "thesis_bore",
    "thesis_clearance",
    "klbf_100",
    "film_standard",
    "film_parameter",
    "lobe_pressure_exact",
    "lobe_a_exact",
    "lobe_b_exact",
    "swing",
    "crank_for_26",
    "speed_rise",  # 2.5521, beyond the rounding of 2.5
    "torque_true",
    "link_force_worst",
    "life_4",
    "life_8",
    "rod",
    "rod_safety",
    "hole_least",
    "hole_largest",
    "cosine_safe",
    "double_safe",
    "hardness",
    "persson_closed",
    "crank_rpm",
    "mass_slack",
    "mass_2",
    "depth_2",
    "error_mass_2",
    "steady_wear",
}


def test_committed_document_is_the_rendering():
    committed = Path(__file__).parents[2] / "docs" / "sources.md"
    assert committed.read_text(encoding="utf-8") == render_sources()


@pytest.mark.parametrize("number", NUMBERS, ids=[f"{n.source} {n.model}" for n in NUMBERS])
def test_verdict(number):
    expected = "**differs**" if number.model in DIFFERING else "agrees"
    assert number.verdict == (expected if number.printed else "not printed")


def test_every_model_is_used_once():
    assert sorted(number.model for number in NUMBERS) == sorted(MODELS)
    assert len(MODELS) > len(DIFFERING)


def test_every_row_fills_its_table():
    rows = [line for line in render_sources().splitlines() if line.startswith("| ")]
    assert {row.count(" | ") for row in rows} == {3, 6}
