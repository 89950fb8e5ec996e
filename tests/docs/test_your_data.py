"""The how-to: its settings are valid, and the messages it explains are those of the program."""

import ast
import re
import tomllib
from pathlib import Path

from erlif.io.settings import FixtureSettings, RunSettings

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "your_data.md").read_text(encoding="utf-8")
EXAMPLES = [tomllib.loads(block) for block in re.findall(r"```toml\n(.*?)```", TEXT, flags=re.S)]
ROWS = [line for line in TEXT.split("## What messages mean")[1].splitlines() if line[:3] == "| `"]
PHRASES = [
    phrase
    for row in ROWS
    for phrase in re.findall(r"`([^`]+)`", row.split("|")[1])
    if " " in phrase
]


def messages() -> str:
    """All text of the program, with a gap in the place of each inserted value."""
    found = []
    for path in sorted((ROOT / "erlif").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.JoinedStr):
                parts = [
                    part.value if isinstance(part, ast.Constant) else "…" for part in node.values
                ]
                found.append("".join(map(str, parts)))
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                found.append(node.value)
    # messages that stand in tables break their lines with a backslash
    tables = (path.read_text(encoding="utf-8") for path in (ROOT / "erlif").rglob("*.toml"))
    return "\n".join([*found, *(text.replace("\\\n", "") for text in tables)])


def test_examples_are_one_complete_fixture_and_one_complete_run():
    fixture, run = EXAMPLES
    assert FixtureSettings.model_validate(fixture).fixture.align
    assert RunSettings.model_validate(run).encoder.triggers_per_cycle == 50


def test_explained_messages_are_those_of_the_program():
    text = messages()
    assert not [phrase for phrase in PHRASES if phrase not in text]
