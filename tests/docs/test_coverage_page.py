"""docs/coverage.md names functions and tests that exist, and leaves no row without a reason."""

import re
import tomllib
from collections import Counter
from importlib import import_module
from pathlib import Path

import pytest
from scenes.scripts import load_script

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def page():
    return load_script(ROOT / "docs" / "make_coverage.py")


def test_committed_document_is_the_rendering(page):
    committed = (ROOT / "docs" / "coverage.md").read_text(encoding="utf-8")
    assert committed == page.render_coverage(), "python docs/make_coverage.py"


def faults(row, sources):
    """What a row names that does not exist, or leaves without a reason."""
    if row.source not in sources:
        yield "source"
    if not (bool(row.models) == bool(row.tests) == bool(row.against)) or not (
        row.models or row.note
    ):
        yield "neither held and checked nor with a reason"
    for name in row.models:
        part = import_module("erlif")
        for step in name.split("."):
            part = getattr(part, step, None)
        if part is None:
            yield name
    yield from (name for name in row.tests if not (ROOT / "tests" / name).is_file())

    # each function is used by name in one of the tests
    used = "".join((ROOT / "tests" / name).read_text(encoding="utf-8") for name in row.tests)
    yield from (name for name in row.models if name.rpartition(".")[2] not in used)


def test_each_row_is_held_and_checked_or_has_a_reason(page):
    # a list: several rows may have one item
    found = [
        (row.source, row.item, list(faults(row, page.SOURCES))) for row in page.coverage_rows()
    ]
    assert not [row for row in found if row[2]]


# for each source its numbers as printed, and its results without a number
PRINTED = tomllib.loads(Path(__file__).with_name("printed.toml").read_text(encoding="utf-8"))


def expand(items: str) -> list[str]:
    """Each number of a list such as "9, Figs. 3-6 to 3-8, Tables 4, 5", behind its kind."""
    kind, numbers = "", []
    for part in filter(None, items.split(", ")):
        word = re.match(r"(Fig|Table|Paper|section|appendix)s?\.? ?", part)
        if word:
            kind, part = word[1], part[word.end() :]
        first, _, last = part.partition(" to ")
        numbers += [f"{kind} {number}".strip() for number in _span(first, last or first)]
    return numbers


def _span(first: str, last: str) -> list[str]:
    if first == last:
        return [first]
    start, end = (re.fullmatch(r"(.*?)(\d+|[A-Z])", number) for number in (first, last))
    assert start[1] == end[1], f"{first} to {last}"
    if start[2].isdigit():
        return [f"{start[1]}{n}" for n in range(int(start[2]), int(end[2]) + 1)]
    return [chr(n) for n in range(ord(start[2]), ord(end[2]) + 1)]


def test_every_number_of_a_source_has_its_row(page):
    rows = page.coverage_rows()
    for source in page.SOURCES:
        items = Counter(n for row in rows if row.source == source for n in expand(row.item))
        assert items == Counter(expand(", ".join(PRINTED[source]))), source
