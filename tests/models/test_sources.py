"""docs/sources.md is the rendering of the models; its verdicts agree with a separate derivation."""

from pathlib import Path

from erlif.models.sources import MODELS, published_numbers, render_sources

NUMBERS = published_numbers()

# found by deriving each equation again apart from this code; all other numbers were reproduced
DIFFERING = {
    "thesis_bore",
    "thesis_clearance",
    "klbf_100",
    "film_standard",
    "film_parameter",
    "lobe_pressure_exact",
    "lobe_a_exact",
    "lobe_b_exact",
    "lobe_pressure_quarter",  # 751.2 of Hertz beside the 756 of finite elements
    "swing",
    "crank_for_26",
    "speed_rise",  # 2.5521, beyond the rounding of 2.5
    "crank_speed_for_24",
    "torque_true",
    "link_force_worst",
    "life_4",
    "life_8",
    "rod",
    "rod_safety",
    "thread_safety",
    "power_exact",
    "hole_least",
    "hole_largest",
    "cosine_safe",
    "double_safe",
    "hardness",
    "persson_closed",
    "crank_rpm",
    "mass_slack",
    "mass_2",
    "mass_local_slack",
    "mass_local_2",
    "depth_local_2",
    "depth_2",
    "error_mass_2",
    "steady_wear",
}


def test_committed_document_is_the_rendering():
    committed = Path(__file__).parents[2] / "docs" / "sources.md"
    assert committed.read_text(encoding="utf-8") == render_sources()


def test_only_the_known_numbers_differ():
    differing = {number.model for number in NUMBERS if number.verdict == "**differs**"}
    assert differing == DIFFERING
    assert all((number.verdict == "not printed") == (not number.printed) for number in NUMBERS)


def test_every_model_is_used_once():
    assert sorted(number.model for number in NUMBERS) == sorted(MODELS)
    assert len(MODELS) > len(DIFFERING)
