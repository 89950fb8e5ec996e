"""docs/sources.md is the rendering of the models; its verdicts agree with a separate derivation."""

from pathlib import Path

import pytest
from scenes.scripts import load_script

ROOT = Path(__file__).parents[2]

REFERENCE = ROOT / "tests" / "reference" / "sources_differing.txt"
DIFFERING = {line for line in REFERENCE.read_text().splitlines() if line[0] != "#"}


@pytest.fixture(scope="module")
def page():
    return load_script(ROOT / "docs" / "make_sources.py")


@pytest.fixture(scope="module")
def numbers(page):
    return page.published_numbers()


def test_committed_document_is_the_rendering(page):
    committed = (ROOT / "docs" / "sources.md").read_text(encoding="utf-8")
    assert committed == page.render_sources(), "python docs/make_sources.py"


def test_only_the_known_numbers_differ(numbers):
    differing = {number.model for number in numbers if number.verdict == "**differs**"}
    assert differing == DIFFERING
    assert all((number.verdict == "not printed") == (not number.printed) for number in numbers)


def test_every_model_is_used_once(page, numbers):
    assert sorted(number.model for number in numbers) == sorted(page.MODELS)
    assert len(page.MODELS) > len(DIFFERING)
