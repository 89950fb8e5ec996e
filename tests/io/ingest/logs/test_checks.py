"""Numbers that no rig can have logged."""

import numpy as np
import pytest

from erlif.core.errors import EncoderError
from erlif.io.ingest.logs.checks import leave_out_bad_rows
from erlif.io.ingest.logs.table import LogColumn, LogTable

LOAD = LogColumn("load", "N", np.array([1.0, np.nan, 3.0, np.nan]), {1: "", 3: "broken"})
NOTE = LogColumn("note", "", np.full(4, np.nan), {0: "a", 1: "b", 2: "c", 3: "d"})
TABLE = LogTable("run.csv", (LOAD, NOTE), [2, 3, 4, 5])


def test_rows_are_left_out_of_all_columns():
    kept, note = leave_out_bad_rows(TABLE, [LOAD], skip=True)
    assert kept.columns[0].values.tolist() == [1.0, 3.0]
    assert kept.columns[1].texts == {0: "a", 1: "c"}
    assert list(kept.rows) == [2, 4]
    assert note.startswith("2 rows of 4 without a number")


def test_columns_that_are_not_used_may_hold_text():
    whole = LogColumn("load", "N", np.arange(4.0))
    table = LogTable("run.csv", (whole, NOTE), [2, 3, 4, 5])
    assert leave_out_bad_rows(table, [whole], skip=False) == (table, "")


def test_a_column_without_any_number_is_not_to_be_skipped():
    with pytest.raises(EncoderError, match="Choose another column"):
        leave_out_bad_rows(TABLE, [LOAD, NOTE], skip=False)
