"""Literature: works that code and documents cite by author and year are in the bibliography."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
BIBLIOGRAPHY = (ROOT / "docs" / "bibliography.md").read_text(encoding="utf-8")
ENTRIES = BIBLIOGRAPHY.split("\n- ")
NAME = r"[A-Z][A-Za-zé]+"
AUTHORS = rf"({NAME})(?: et al\.|(?:, {NAME})*,?\s+and\s+{NAME})?"
CITATION = re.compile(rf"\b{AUTHORS}\s+\(((?:18|19|20)\d\d)|\({AUTHORS},?\s+((?:18|19|20)\d\d)\)")


def citations() -> set[tuple[str, str]]:
    """First author and year of every citation in the package and the documents."""
    pages = [path for path in (ROOT / "docs").rglob("*.md") if path.stem != "bibliography"]
    text = "\n".join(
        path.read_text(encoding="utf-8") for path in [*(ROOT / "erlif").rglob("*.py"), *pages]
    )
    return {(one or two, year or again) for one, year, two, again in CITATION.findall(text)}


def test_cited_works_are_in_the_bibliography():
    missing = [
        f"{author} ({year})"
        for author, year in sorted(citations())
        if not any(author in entry.split(",")[0] and f"({year})" in entry for entry in ENTRIES)
    ]
    assert not missing


def test_search_finds_the_works_that_are_known_to_be_cited():
    assert {("Martin", "1916"), ("Strand", "2005"), ("Newey", "1987")} <= citations()
