"""Errors whose texts stand in a table."""

import re
from pathlib import Path

import pytest

import erlif
from erlif.core.errors import ConfigError, OutputError
from erlif.core.refusals import refusal_writer
from erlif.core.tables import read_table

TABLES = sorted(Path(erlif.__file__).parent.rglob("refusals.toml"))


def test_the_caller_may_choose_the_class():
    write = refusal_writer("erlif.show")
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
