"""Array types: the precision of an element."""

from typing import get_args

import numpy as np

from erlif.core import arrays
from erlif.core.flags import Flag


def test_counts_hold_sixteen_bits_and_flags_all_their_bits():
    assert np.iinfo(get_args(get_args(arrays.Counts)[1])[0]).max == 2**16 - 1
    assert sum(Flag) <= np.iinfo(get_args(get_args(arrays.FlagImage)[1])[0]).max
