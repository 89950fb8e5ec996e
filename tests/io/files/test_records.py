"""Numbers of a trigger as a line: exact, and damage is seen."""

import numpy as np
import numpy.testing as npt
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as drawn

from erlif.io.files.records import read_record, write_record

arrays = drawn.arrays(
    st.sampled_from([np.float64, np.float32, np.int64, np.uint8, np.bool_]),
    drawn.array_shapes(min_dims=0, max_dims=2, min_side=0, max_side=4),
)


@given(st.integers(0, 10**6), st.dictionaries(st.text(), arrays, max_size=4))
def test_numbers_come_back_exactly(trigger, numbers):
    line = write_record(trigger, numbers, {"flags": [2048, 117, 5]})
    found = read_record(line)
    assert line.count(b"\n") == 1
    assert found.trigger == trigger
    assert found.chunks == {"flags": [2048, 117, 5]}
    assert found.numbers.keys() == numbers.keys()
    for name, values in numbers.items():
        assert found.numbers[name].dtype == values.dtype
        npt.assert_array_equal(found.numbers[name], values)


LINE = write_record(12, {"mean": 4.25}, {"flags": [2048, 117, 5]})


def test_a_line_that_is_cut_off_or_changed_is_not_read():
    for place in range(len(LINE) - 1):
        changed = bytearray(LINE)
        changed[place] ^= 1
        assert read_record(bytes(changed)) is None
        assert read_record(LINE[: place + 1]) is None
