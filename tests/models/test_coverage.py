"""docs/coverage.md names functions and tests that exist, and leaves no row without a reason."""

from importlib import import_module
from pathlib import Path

import pytest

from erlif.models.coverage import coverage_rows, render_coverage
from erlif.models.sources import TITLES

ROOT = Path(__file__).parents[2]
ROWS = coverage_rows()


def test_committed_document_is_the_rendering():
    assert (ROOT / "docs" / "coverage.md").read_text(encoding="utf-8") == render_coverage()


@pytest.mark.parametrize("row", ROWS, ids=[f"{row.source} {row.item}" for row in ROWS])
def test_a_row_is_held_and_checked_or_has_a_reason(row):
    assert row.source in TITLES
    assert bool(row.models) == bool(row.tests) == bool(row.against)
    assert row.models or row.note
    for name in row.models:
        found = import_module("erlif")
        for part in name.split("."):
            found = getattr(found, part)
    for name in row.tests:
        assert (ROOT / "tests" / name).is_file(), name

    # each function is used by name in one of the tests
    used = "".join((ROOT / "tests" / name).read_text(encoding="utf-8") for name in row.tests)
    assert not [name for name in row.models if name.rpartition(".")[2] not in used]


def test_every_numbered_equation_has_a_row():
    """The numbers as printed, counted in the sources."""
    text = {source: " ".join(row.item for row in ROWS if row.source == source) for source in TITLES}
    for number in [*range(1, 9), *range(10, 16)]:
        assert f"{number}" in text["S"]
    spans = {"T": ["2.1", "2.8", "3.1 to 3.13", "3.14 to 3.19", "5.7", "A.1", "B.7 to B.11"]}
    spans |= {"M": ["1 to 3", "4, 5", "6 to 9", "10", "11", "12, 13", "14", "15 to 19", "20"]}
    spans |= {"C": ["1", "2 to 4", "A1 to A5", "A6", "B1, B2, B4 to B10", "B3"]}
    for source, items in spans.items():
        for item in items:
            assert item in text[source]
