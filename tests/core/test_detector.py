"""Properties that all cameras share."""

import numpy.testing as npt
from scipy.integrate import quad

from erlif.core.detector import QUANTISATION_VAR


def test_rounding_has_the_variance_of_a_uniform_error_of_one_count():
    npt.assert_allclose(QUANTISATION_VAR, quad(lambda error: error**2, -0.5, 0.5)[0], rtol=1e-12)
