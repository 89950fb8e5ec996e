"""Array types, one meaning each: the type of an element; shapes stand in the docstrings."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import numpy.typing as npt

# Double precision: physics, fits, statistics.
Array = npt.NDArray[np.float64]

# Single precision, (y, x): light, ratio, thickness and their variances.
Image = npt.NDArray[np.float32]

# Raw counts of a camera. [DN]
Counts = npt.NDArray[np.uint16]

# Bits of `erlif.core.flags.Flag`.
FlagImage = npt.NDArray[np.uint16]

# True for the elements that are meant.
Mask = npt.NDArray[np.bool_]

# An array in the precision of its input.
AnyArray = npt.NDArray[Any]

# Floating-point freedoms of a compiled loop that keep NaN a NaN.
FAST: Final = {"nsz", "arcp", "contract", "afn", "reassoc"}
