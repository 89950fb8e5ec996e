"""Bad samples and bursts of noise, against where they were put."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.joint.endurance.disturbances import local_scale, replace_spikes


@pytest.mark.parametrize("width", [1, 2, 3])
def test_spikes_of_up_to_three_samples_go_and_a_step_stays(width):
    values = 0.01 * np.random.default_rng(1).standard_normal(200)
    values[120:] += 1.0
    known = values.copy()
    values[60 : 60 + width] += 0.5
    found = replace_spikes(values)
    npt.assert_array_less(np.abs(found[60 : 60 + width]), 0.05)
    npt.assert_allclose(found[[0, 119, 120, 199]], known[[0, 119, 120, 199]], atol=0.03)


def test_a_burst_of_noise_is_no_row_of_spikes():
    """Its medians would be correlated noise, which looks like a rise."""
    values = np.random.default_rng(2).standard_normal(200)
    values[150:180] *= 6
    assert np.mean(replace_spikes(values)[150:180] == values[150:180]) > 0.9


def test_scatter_is_found_where_it_is_larger_and_nowhere_else():
    residuals = np.random.default_rng(3).standard_normal(300)
    quiet = local_scale(residuals)
    assert np.mean(quiet == 1.0) > 0.9
    residuals[200:220] *= 6
    found = local_scale(residuals)
    npt.assert_allclose(np.median(found[200:220]), 6, rtol=0.35)
    npt.assert_array_equal(found[:150], 1.0)
