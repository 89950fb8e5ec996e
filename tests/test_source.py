"""The source as text: plain English, documented functions, tests of each module."""

import ast
import re
from pathlib import Path

from scenes.scripts import load_script

ROOT = Path(__file__).parents[1]

anchors = load_script(ROOT / "benchmarks" / "anchors.py")

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


# one test for all files: a test of each file would take longer to report than to run


def test_docstrings_messages_and_comments_are_plain_english():
    """Words that give pixels and frames a voice are left out; docs/glossary.md has the terms."""
    found = [
        f"{short(path)}, line {number}: {word}"
        for path in SOURCES
        for number, text in anchors.prose(path.read_text(encoding="utf-8"))
        for word in anchors.WORDS.findall(text)
    ]
    assert not found


def test_pages_are_plain_english():
    found = {}
    for path in PAGES:
        text = re.sub(r"```.*?```", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
        found[short(path)] = anchors.WORDS.findall(text)
    assert not {path: words for path, words in found.items() if words}


def test_exported_functions_have_returns_and_an_example():
    missing = anchors.find_undocumented(ROOT / "erlif")
    assert not missing


def test_every_module_has_a_test_file_of_its_name():
    untested = [
        short(path)
        for path in SOURCES
        if path.stem not in ("__init__", "__main__")
        and path.parent != ROOT / "erlif"  # public names of folders
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


def records(path):
    """Public dataclasses and named tuples of a file."""
    return [
        node
        for node in anchors.syntax(path).body
        if isinstance(node, ast.ClassDef) and is_record(node)
    ]


def test_help_shows_every_field_of_a_public_record():
    missing = [
        f"{short(path)}, {node.name}: {name}"
        for path in SOURCES
        for node in records(path)
        for name in fields_of(node)
        # alone, or in one line with others of its kind
        if not re.search(rf"^(\w+, )*{name}(, \w+)* : ", ast.get_docstring(node) or "", re.M)
    ]
    assert not missing


def test_no_kernel_is_compiled_as_parallel():
    """docs/decisions/kernels.md: threads run over frames."""
    parallel = [path for path in SOURCES if "parallel=True" in path.read_text(encoding="utf-8")]
    assert not parallel
