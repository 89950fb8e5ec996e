"""Array types, one meaning each: the type of an element; shapes stand in the docstrings."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
"""Double precision: physics, fits, statistics."""

Image = npt.NDArray[np.float32]
"""Single precision, (y, x): light, ratio, thickness and their variances."""

Counts = npt.NDArray[np.uint16]
"""Raw counts of a camera. [DN]"""

FlagImage = npt.NDArray[np.uint8]
"""Bits of `erlif.core.flags.Flag`."""

Mask = npt.NDArray[np.bool_]
"""True for the elements that are meant."""

AnyArray = npt.NDArray[Any]
"""An array in the precision of its input."""

FAST: Final = {"nsz", "arcp", "contract", "afn", "reassoc"}
"""Floating-point freedoms of a compiled loop that keep NaN a NaN."""
