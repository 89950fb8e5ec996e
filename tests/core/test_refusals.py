"""Errors whose texts stand in a table."""

import ast
import re
from pathlib import Path
from string import Formatter

import pytest

import erlif
from erlif.core.errors import ConfigError, OutputError
from erlif.core.refusals import refusal_writer
from erlif.core.tables import read_table

TABLES = sorted(Path(erlif.__file__).parent.rglob("refusals.toml"))


def test_the_caller_may_choose_the_class():
    write = refusal_writer("erlif.joint")
    assert type(write("few_positions", positions=1)) is OutputError
    assert type(write("few_positions", ConfigError, positions=1)) is ConfigError
    with pytest.raises(KeyError, match="positions"):
        write("few_positions")


@pytest.mark.parametrize("table", TABLES, ids=lambda table: table.parent.name)
def test_every_refusal_of_a_table_is_raised_somewhere(table):
    source = "".join(path.read_text("utf-8") for path in table.parent.rglob("*.py"))
    source += '"positive_load" "positive_pulse_energy"'  # named after their quantity
    package = ".".join(("erlif", *table.parent.relative_to(Path(erlif.__file__).parent).parts))
    keys = read_table(package, "refusals.toml")
    assert not [key for key in keys if not re.search(rf'"{key}"', source)]


@pytest.mark.parametrize("table", TABLES, ids=lambda table: table.parent.name)
def test_every_refusal_is_given_what_its_text_names(table):
    """A value that is missing would replace the message by a KeyError."""
    package = ".".join(("erlif", *table.parent.relative_to(Path(erlif.__file__).parent).parts))
    entries = read_table(package, "refusals.toml")
    lacking = []
    for path in table.parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name)):
                continue
            key = node.args[0] if node.func.id == "refusal" and node.args else None
            given = {keyword.arg for keyword in node.keywords}
            if not (isinstance(key, ast.Constant) and key.value in entries) or None in given:
                continue  # a key or values that are chosen where the program runs
            fields = Formatter().parse(entries[key.value]["text"])
            named = {re.split(r"[.\[]", field)[0] for _, field, _, _ in fields if field}
            if named != given:
                lacking.append(f"{path.name}:{node.lineno} {key.value}: {named ^ given}")
    assert not lacking
