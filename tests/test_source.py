"""The source as text: plain English, documented functions, tests of each module, 100 columns."""

from __future__ import annotations

import ast
import importlib.util
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

spec = importlib.util.spec_from_file_location("anchors", ROOT / "benchmarks" / "anchors.py")
assert spec is not None
assert spec.loader is not None
anchors = importlib.util.module_from_spec(spec)
sys.modules["anchors"] = anchors
spec.loader.exec_module(anchors)

SOURCES = sorted((ROOT / "erlif").rglob("*.py"))
PAGES = [
    ROOT / "README.md",
    ROOT / "CHANGELOG.md",
    ROOT / "CONTRIBUTING.md",
    *sorted((ROOT / "docs").rglob("*.md")),
    *sorted((ROOT / "docs" / "gallery").glob("*.py")),
]


def short(path):
    return str(path.relative_to(ROOT))


@pytest.mark.parametrize("path", SOURCES, ids=short)
def test_docstrings_messages_and_comments_are_plain_english(path):
    """Words that give pixels and frames a voice are left out; docs/glossary.md has the terms."""
    found = [
        f"line {number}: {word}"
        for number, text in anchors.prose(path.read_text(encoding="utf-8"))
        for word in anchors.WORDS.findall(text)
    ]
    assert not found


@pytest.mark.parametrize("path", PAGES, ids=short)
def test_pages_are_plain_english(path):
    text = path.read_text(encoding="utf-8")
    text = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    assert not anchors.WORDS.findall(text)


@pytest.mark.parametrize("path", SOURCES, ids=short)
def test_no_line_is_wider_than_100_columns(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    assert not [n for n, line in enumerate(lines, 1) if len(line) > anchors.WIDTH]


def test_exported_functions_have_returns_and_an_example():
    missing = anchors.find_undocumented(ROOT / "erlif")
    assert not missing


def test_every_module_has_a_test_file_of_its_name():
    untested = [
        short(path)
        for path in SOURCES
        if path.stem not in ("__init__", "__main__")
        and not (
            ROOT / "tests" / path.relative_to(ROOT / "erlif").parent / f"test_{path.stem}.py"
        ).exists()
    ]
    assert not untested


def fields_of(node):
    return [
        entry.target.id
        for entry in node.body
        if isinstance(entry, ast.AnnAssign) and not entry.target.id.startswith("_")
    ]


def is_record(node):
    """Whether a class is a public dataclass or named tuple."""
    kinds = [ast.unparse(entry) for entry in (*node.decorator_list, *node.bases)]
    record = any("dataclass" in kind or kind == "NamedTuple" for kind in kinds)
    return record and not node.name.startswith("_")


@pytest.mark.parametrize("path", SOURCES, ids=short)
def test_help_shows_every_field_of_a_public_record(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef) and is_record(node):
            text = ast.get_docstring(node) or ""
            missing = [name for name in fields_of(node) if f"\n{name} : " not in text]
            assert not missing, f"{node.name} has no description of {', '.join(missing)}"
