"""Values beside those of other rows."""

import numpy as np
import numpy.testing as npt

from erlif.pipeline.audit.rows import shifted


def test_a_shift_of_more_rows_than_there_are_leaves_nothing():
    values = np.arange(4.0)
    npt.assert_array_equal(shifted(values, 0), values)
    npt.assert_array_equal(shifted(values, -1), [np.nan, 0, 1, 2])
    assert np.isnan(shifted(values, 4)).all()
