"""Links of the documents: every file they name exists."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
GENERATED = ("docs/auto_gallery/",)
"""Folders that only the build of the site makes."""

DOCUMENTS = sorted(
    path
    for path in [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *ROOT.glob("docs/*.ipynb")]
    if "auto_gallery" not in path.parts and "jupyter_execute" not in path.parts
)


def prose(path: Path) -> str:
    """Text of a document without its fenced code."""
    return re.sub(r"^ *```.*?^ *```", "", path.read_text(encoding="utf-8"), flags=re.M | re.S)


def test_relative_links_name_existing_files():
    links = [
        (path, target)
        for path in DOCUMENTS
        for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", prose(path))
        if not re.match(r"[a-z]+:", target)
    ]
    assert len(links) > 100
    files = {(path.name, target): (path.parent / target).resolve() for path, target in links}
    dead = [
        f"{name} links to {target}"
        for (name, target), file in files.items()
        if not file.exists() and not file.relative_to(ROOT).as_posix().startswith(GENERATED)
    ]
    assert not dead
