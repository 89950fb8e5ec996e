"""Array types: the precision of an element."""

from typing import get_args

import numpy as np
import pytest

from erlif.core import arrays
from erlif.core.flags import Flag


@pytest.mark.parametrize(
    ("alias", "element"),
    [
        (arrays.Array, np.float64),
        (arrays.Image, np.float32),
        (arrays.Counts, np.uint16),
        (arrays.FlagImage, np.uint8),
        (arrays.Mask, np.bool_),
    ],
)
def test_each_type_names_its_precision(alias, element):
    assert get_args(get_args(alias)[1])[0] is element


def test_counts_hold_sixteen_bits_and_flags_all_their_bits():
    assert np.iinfo(get_args(get_args(arrays.Counts)[1])[0]).max == 2**16 - 1
    assert sum(Flag) <= np.iinfo(get_args(get_args(arrays.FlagImage)[1])[0]).max
