"""Properties that all cameras share."""

import numpy as np
import numpy.testing as npt
from scipy.integrate import quad

from erlif.core.detector import QUANTISATION_VAR


def test_rounding_has_the_variance_of_a_uniform_error_of_one_count():
    npt.assert_allclose(QUANTISATION_VAR, quad(lambda error: error**2, -0.5, 0.5)[0], rtol=1e-12)


def test_rounding_of_light_that_varies_by_many_counts_has_this_variance():
    light = np.random.default_rng(1).uniform(100, 900, 200_000)
    npt.assert_allclose(np.var(np.rint(light) - light), QUANTISATION_VAR, rtol=0.02)
