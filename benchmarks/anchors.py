"""Figures of the source beside those of well-kept packages (verde, pvlib, photutils).

Run with ``python benchmarks/anchors.py`` for erlif, with directories for other packages, ``--list``
to see the places.
"""

from __future__ import annotations

import argparse
import ast
import functools
import importlib.util
import io
import re
import tokenize
from pathlib import Path
from statistics import median, quantiles

WALL = 25
"""Code lines from which on a body without blank line or comment is hard to read."""

WIDTH = 100

WORDS = re.compile(
    r"\b(tells?|told|telling|says?|said|saying|answer(?:s|ed|ing)?|gainsay\w*|feign\w*|least film|"
    r"deserves?|a word)\b",
    re.IGNORECASE,
)
"""Words that a laboratory does not write about pixels; docs/glossary.md has the terms."""


def code_lines(source: str) -> set[int]:
    """Numbers of the lines that hold code, docstrings left out."""
    lines: set[int] = set()
    skip = (tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT)
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type not in (*skip, tokenize.ENDMARKER):
            lines.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(ast.parse(source)):
        if not isinstance(node, ast.Expr) or not isinstance(node.value, ast.Constant):
            continue
        if isinstance(node.value.value, str):
            lines.difference_update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    return lines


def prose(source: str) -> list[tuple[int, str]]:
    """Comments and texts of a module, with their lines."""
    found = []
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type in (tokenize.COMMENT, tokenize.STRING) or token.type == getattr(
            tokenize, "FSTRING_MIDDLE", -1
        ):
            found += [(token.start[0] + n, text) for n, text in enumerate(token.string.split("\n"))]
    return found


def exported(package: Path) -> set[tuple[Path, str]]:
    """Exported functions of each folder, and the public ones of models."""
    found: set[tuple[Path, str]] = set()
    for init in package.rglob("__init__.py"):
        # a face that loads its modules when they are used has its names in a stub
        stub = init.with_suffix(".pyi")
        tree = ast.parse((stub if stub.exists() else init).read_text(encoding="utf-8"))
        names = {alias.asname for node in ast.walk(tree) for alias in getattr(node, "names", ())}
        names |= {
            element.value
            for node in tree.body
            if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__all__"
            for element in ast.walk(node.value)
            if isinstance(element, ast.Constant)
        }
        if stub.exists():
            names |= {
                alias.asname
                for node in tree.body
                if isinstance(node, ast.ImportFrom)
                for alias in node.names
                if alias.asname
            }
        for path in init.parent.glob("*.py"):
            public = init.parent.name == "models"
            for node in ast.parse(path.read_text(encoding="utf-8")).body:
                if not isinstance(node, ast.FunctionDef) or node.name.startswith("_"):
                    continue
                if node.name in names or public:
                    found.add((path, node.name))
    return found


@functools.cache
def syntax(path: Path) -> ast.Module:
    """Syntax tree of a module."""
    return ast.parse(path.read_text(encoding="utf-8"))


def find_undocumented(package: Path) -> list[str]:
    """Exported functions without a Returns section or an example that runs, with their lines."""
    found = []
    for path, name in sorted(exported(package)):
        for node in syntax(path).body:
            if not isinstance(node, ast.FunctionDef) or node.name != name:
                continue
            text = ast.get_docstring(node) or ""
            nothing = node.returns is None or ast.unparse(node.returns) in ("None", "NoReturn")
            if not nothing and not re.search(r"^(Returns|Yields)\n", text, re.MULTILINE):
                found.append(f"{path}:{node.lineno}: {name} has no Returns")
            if ">>> " not in text:
                found.append(f"{path}:{node.lineno}: {name} has no example")
    return found


def measure(package: Path, tests: Path | None, *, places: bool) -> None:
    """Print the figures of one package."""
    lengths, walls, wide, comments, code = [], [], [], 0, 0
    words: list[str] = []
    total_words = 0
    undocumented = find_undocumented(package)
    for path in sorted(package.rglob("*.py")):
        source = path.read_text(encoding="utf-8")
        lines = source.splitlines()
        coded = code_lines(source)
        code += len(coded)
        comments += sum(
            token.type == tokenize.COMMENT
            for token in tokenize.generate_tokens(io.StringIO(source).readline)
        )
        wide += [f"{path}:{n}" for n, line in enumerate(lines, 1) if len(line) > WIDTH]
        for number, text in prose(source):
            total_words += len(text.split())
            words += [f"{path}:{number}: {found}" for found in WORDS.findall(text)]
        for node in ast.walk(ast.parse(source)):
            if not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                continue
            first = node.body[1] if ast.get_docstring(node) and node.body[1:] else node.body[0]
            inside = range(first.lineno, (node.end_lineno or first.lineno) + 1)
            length = len(coded & set(range(node.lineno, (node.end_lineno or node.lineno) + 1)))
            lengths.append(length)
            if length >= WALL and not any(
                not lines[n - 1].strip() or "#" in lines[n - 1] for n in inside
            ):
                walls.append(f"{path}:{node.lineno}: {node.name}")
    long = sum(length >= WALL for length in lengths)
    ninth = quantiles(lengths, n=10)[-1] if len(lengths) > 1 else float("nan")
    print(f"{package.name}: {len(lengths)} functions, {code} lines of code")
    print(f"  code lines of a function: median {median(lengths):.0f}, 90th percentile {ninth:.0f}")
    print(f"  bodies of {WALL}+ lines without blank line or comment: {len(walls)} of {long}")
    print(f"  comments per 100 lines of code: {100 * comments / code:.1f}")
    print(f"  lines over {WIDTH} columns: {len(wide)}")
    print(f"  words a laboratory does not write: {1e4 * len(words) / total_words:.1f} per 10,000")
    returns = sum(place.endswith("Returns") for place in undocumented)
    print(f"  exported functions: {len(exported(package))}, without Returns {returns},", end="")
    print(f" without example {len(undocumented) - returns}")
    if tests is not None:
        untested = measure_tests(package, tests)
        print(f"  modules without a test file of their name: {len(untested)}")
    else:
        untested = []
    if places:
        for title, found in (
            ("walls", walls),
            ("wide", wide),
            ("words", words),
            ("undocumented", undocumented),
            ("no test file", untested),
        ):
            for place in found:
                print(f"{title}: {place}")


def measure_tests(package: Path, tests: Path) -> list[str]:
    """Print test-to-source lines of each folder; list modules without a test file."""
    untested = []
    for folder in sorted({path.parent for path in package.rglob("*.py")}):
        own = [path for path in folder.glob("*.py") if path.name != "__init__.py"]
        mirror = tests / folder.relative_to(package)
        if folder != package:
            have = sum(len(path.read_text().splitlines()) for path in mirror.glob("*.py"))
            size = sum(len(path.read_text().splitlines()) for path in folder.glob("*.py"))
            print(f"  tests of {folder.name}: {have / max(size, 1):.2f} lines a line of source")
        untested += [
            str(path)
            for path in own
            if not (mirror / f"test_{path.stem}.py").exists() and path.stem != "__main__"
        ]
    return untested


def main() -> None:
    """Measure erlif, or the packages named."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("packages", nargs="*", help="directories, or names of installed packages")
    parser.add_argument("--list", action="store_true", help="print every place")
    options = parser.parse_args()
    root = Path(__file__).resolve().parents[1]
    if not options.packages:
        measure(root / "erlif", root / "tests", places=options.list)
    for name in options.packages:
        spec = None if Path(name).is_dir() else importlib.util.find_spec(name)
        origin = Path(spec.origin).parent if spec is not None and spec.origin else Path(name)
        inside = (root / "erlif").resolve() in (origin.resolve(), *origin.resolve().parents)
        tests = root / "tests" / origin.name if inside and origin.name != "erlif" else None
        measure(origin, tests, places=options.list)


if __name__ == "__main__":
    main()
