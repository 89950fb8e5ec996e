"""Values within the reach of a linkage."""

import pytest

from erlif.core.errors import ModelError
from erlif.models.mechanism.reach import within_reach


def test_values_further_out_are_refused_in_their_unit():
    with pytest.raises(ModelError, match=r"crank_angle .* 0 rad \(0\.0000 degrees\) to .* 2 rad"):
        within_reach([0.5, 2.0], (0.0, 1.0), 1e-9, "crank_angle")
    with pytest.raises(ModelError, match=r"slider_position .* 0 m to 1 m, got -1 m"):
        within_reach(-1.0, (0.0, 1.0), 1e-9, "slider_position")
