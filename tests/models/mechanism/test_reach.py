"""Values within the reach of a linkage."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.models.mechanism.reach import sign, within_reach


def test_values_beyond_an_end_by_rounding_are_taken_as_the_end():
    npt.assert_array_equal(
        within_reach([-1e-10, 0.5, 1 + 1e-10], (0.0, 1.0), 1e-9, "x"), [0, 0.5, 1]
    )
    assert np.isnan(within_reach(np.nan, (0.0, 1.0), 1e-9, "x"))


def test_values_further_out_are_refused_in_their_unit():
    with pytest.raises(ModelError, match=r"crank_angle .* 0 rad \(0\.0000 degrees\) to .* 2 rad"):
        within_reach([0.5, 2.0], (0.0, 1.0), 1e-9, "crank_angle")
    with pytest.raises(ModelError, match=r"slider_position .* 0 m to 1 m, got -1 m"):
        within_reach(-1.0, (0.0, 1.0), 1e-9, "slider_position")


def test_sign_of_a_stroke():
    npt.assert_array_equal(sign(np.array([True, False])), [1, -1])
