"""The worn bushing: load and volume."""

import numpy as np
import numpy.testing as npt
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from erlif.models.wear import (
    steady_bushing_wear,
)


@given(
    st.floats(1.0, 1e5),
    st.floats(1e-3, 0.1),
    st.floats(1e-3, 0.2),
    st.floats(1e-3, 1e4),
    st.floats(1e-16, 1e-12),
)
def test_steady_bushing_conserves_load_and_volume(load, radius, width, distance, specific):
    found = steady_bushing_wear(
        load, shaft_radius=radius, width=width, sliding_distance=distance, specific_wear=specific
    )
    carried = quad(
        lambda t: found.pressure * np.cos(t) * np.cos(t) * radius * width, -np.pi / 2, np.pi / 2
    )[0]
    removed = quad(lambda t: found.depth * np.cos(t) * radius * width, -np.pi / 2, np.pi / 2)[0]
    npt.assert_allclose(carried, load, rtol=1e-9)
    npt.assert_allclose(removed, found.volume, rtol=1e-9)
    # Archard for the whole: the friction path carries int P dA = T* F with T* = 4/pi
    npt.assert_allclose(found.volume, specific * 4 / np.pi * load * distance, rtol=1e-9)
