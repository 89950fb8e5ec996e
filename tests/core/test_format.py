"""Format version of the files that erlif writes."""

import pytest

from erlif.core.format import ATTRIBUTE, is_later


@pytest.mark.parametrize("found", [0, -1, 1.5, "two", float("nan")])
def test_a_version_that_is_no_whole_number_is_damage(found):
    with pytest.raises(ValueError, match=r"version|invalid|NaN"):
        is_later({ATTRIBUTE: found})
