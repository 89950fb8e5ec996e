"""docs/stability.md: what is promised is there."""

import re
from importlib import import_module
from pathlib import Path

from scenes.scripts import load_script

from erlif.core.format import FORMAT_VERSION

DOCS = Path(__file__).parents[2] / "docs"
TEXT = (DOCS / "stability.md").read_text(encoding="utf-8")
ROW = re.compile(r"^\| `(erlif[\w.]*)` \| (.*) \|$", re.MULTILINE)


def test_every_promised_name_can_be_imported():
    rows = {module: re.findall("`([^`]+)`", names) for module, names in ROW.findall(TEXT)}
    assert tuple(rows) == load_script(DOCS / "make_stability.py").PROMISED
    missing = [
        f"{module}.{name}"
        for module, names in rows.items()
        for name in names
        if not hasattr(import_module(module), name)
    ]
    assert not missing
    assert {"process", "calibrate", "open_film"} <= set(rows["erlif"])


def test_the_page_states_the_version_of_the_files():
    assert f"`format_version`, one number for all, today {FORMAT_VERSION}." in TEXT
