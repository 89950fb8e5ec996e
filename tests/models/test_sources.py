"""docs/sources.md is the rendering of the models; its verdicts agree with a separate derivation."""

from pathlib import Path

from erlif.models.sources import MODELS, published_numbers, render_sources

NUMBERS = published_numbers()

REFERENCE = Path(__file__).parents[1] / "reference" / "sources_differing.txt"
DIFFERING = {line for line in REFERENCE.read_text().splitlines() if line[0] != "#"}


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
