"""Errors whose texts stand in a table."""

import pytest

from erlif.core.errors import ConfigError, OutputError
from erlif.core.refusals import refusal_writer


def test_the_caller_may_choose_the_class():
    write = refusal_writer("erlif.show")
    assert type(write("few_positions", positions=1)) is OutputError
    assert type(write("few_positions", ConfigError, positions=1)) is ConfigError
    with pytest.raises(KeyError, match="positions"):
        write("few_positions")
