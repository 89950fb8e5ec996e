"""Laws of wear: volumes by hand."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.models.wear import (
    abrasive_wear,
    adhesive_wear,
    fatigue_wear,
    wear_depth,
)


def test_archard_by_load_and_by_pressure_agree():
    volume = adhesive_wear(1e3, sliding_distance=50.0, hardness=2e9, coefficient=1e-4)
    depth = wear_depth(1e3 / 4e-4, sliding_distance=50.0, specific_wear=1e-4 / 2e9)
    npt.assert_allclose(volume, depth * 4e-4)


def test_volumes_by_hand():  # Farzaneh (2002), eqs. 2.1 to 2.3
    case = {"sliding_distance": 50.0, "hardness": 2e9}
    npt.assert_allclose(adhesive_wear(1e3, coefficient=1e-4, **case), 2.5e-9)
    slope = np.arctan(0.3)
    npt.assert_allclose(abrasive_wear(1e3, asperity_slope=slope, **case), 4.7746483e-6, rtol=1e-7)
    shape = {"asperity_distribution": 2.0, "particle_size": 3.0, "failure_strain": 0.5}
    npt.assert_allclose(fatigue_wear(1e3, coefficient=0.1, **shape, **case), 6e-5)


def test_slope_of_an_asperity_lies_below_a_right_angle():
    for slope in (-0.1, 2.0):
        with pytest.raises(ModelError, match=rf"^asperity_slope must lie .* got {slope:g} rad"):
            abrasive_wear(1.0, sliding_distance=1.0, hardness=1e9, asperity_slope=slope)
