"""docs/coverage.md names functions and tests that exist, and leaves no row without a reason."""

import re
from collections import Counter
from importlib import import_module
from pathlib import Path

import pytest
from scenes.scripts import load_script

from erlif.models.sources import TITLES

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def page():
    return load_script(ROOT / "docs" / "make_coverage.py")


def test_committed_document_is_the_rendering(page):
    committed = (ROOT / "docs" / "coverage.md").read_text(encoding="utf-8")
    assert committed == page.render_coverage(), "python docs/make_coverage.py"


def faults(row):
    """What a row names that does not exist, or leaves without a reason."""
    if row.source not in TITLES:
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
    found = [(row.source, row.item, list(faults(row))) for row in page.coverage_rows()]
    assert not [row for row in found if row[2]]


# the numbers as printed, counted in the sources; a number alone is an equation
PRINTED = {
    # Farzaneh (2002): its list of figures has as well
    "T": "2.1 to 2.8, 3.1 to 3.19, 5.1 to 5.7, A.1, B.1 to B.11, "
    "Fig. 1-1, 2-1, 3-1 to 3-10, 4-1 to 4-12, 5-1 to 5-10, A-1 to A-7, B-1",
    # Strand (2005): 3 is not printed, 21 twice; the appendix is the table of Persson's pressure
    "S": "1 to 20, 21 (first), 21 (second), 22 to 32, Figs. 1 to 38, appendix, Papers A to G",
    # Mukras et al. (2008)
    "M": "1 to 20, Figs. 1 to 12, 13a, 13b, 14a, 14b, 15, Tables 1 to 5",
    # Colbert et al. (2009)
    "C": "1 to 4, A1 to A6, B1 to B10, Figs. 1 to 8, A1, B1",
}

# results and procedures that have no number, one row for each
UNNUMBERED = {
    "T": "section 1.2, 2.2.2, 2.2.2, 2.2.3, 3.2, 3.3.3, 4.1, 5.1, 5.2, 5.2, A.2, A.2, A.3, A.3, "
    "A.4.1, A.4.1, A.4.1, A.4.2, appendix C",
    "S": "section 2.1.16, 2.2",
    "M": "",
    "C": "section 2, 3, 4.2, 5.2, Fig. 8",  # figure 8 has the 1.6 of an interference as well
}


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
    for source in TITLES:
        items = Counter(n for row in rows if row.source == source for n in expand(row.item))
        assert items == Counter(expand(PRINTED[source]) + expand(UNNUMBERED[source])), source
