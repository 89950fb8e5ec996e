"""Write the list of promised names in docs/stability.md: ``python docs/make_stability.py``."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path

PAGE = Path(__file__).with_name("stability.md")

PROMISED = (
    "erlif",
    "erlif.plots",
    "erlif.rig",
    *(f"erlif.models.{name}" for name in ("contact", "film", "fluorescence", "mechanism", "oil")),
)
"""Modules whose names are promised."""

ROWS = re.compile(r"(?<=\| module \| names \|\n\| --- \| --- \|\n)(\|.*\n)+")


def public_names(module: str) -> list[str]:
    """What a module exports, or its own names where it has no list."""
    found = import_module(module)
    own = [name for name, thing in vars(found).items() if getattr(thing, "__module__", 0) == module]
    names = getattr(found, "__all__", own)
    return sorted((name for name in names if not name.startswith("_")), key=str.lower)


def rows() -> str:
    """Rows of the table, a module each."""
    listed = {module: public_names(module) for module in PROMISED}
    return "".join(
        f"| `{module}` | {' '.join(f'`{name}`' for name in names)} |\n"
        for module, names in listed.items()
    )


def render() -> str:
    """The page with the rows of today."""
    return ROWS.sub(lambda _: rows(), PAGE.read_text(encoding="utf-8"))


if __name__ == "__main__":
    PAGE.write_text(render(), encoding="utf-8")
