"""The error of a background among the parameters of a calibration."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest

from erlif.calibration import BackgroundError
from erlif.show.plots import example_calibration

CALIBRATION = example_calibration()
FILMS = np.array([1.0, 3.0, 6.0, 10.0])


@pytest.fixture
def extended():
    """A brightness of 400 DN/um, units of 900 and 1100 DN."""
    parameters = len(CALIBRATION.full_covariance)
    cross = 1e-6 * np.arange(2 * parameters).reshape(parameters, 2)
    covariance = np.array([[4e-4, 3e-4], [3e-4, 5e-4]])
    error = BackgroundError(400.0, (900.0, 1100.0), covariance, cross)
    return replace(CALIBRATION, background=error)


def test_gradient_is_the_change_of_the_ratio_with_light_added(extended):
    """Light of camera 1 is 400 (1 - exp(-p h))/p, that of camera 2 the ratio times this."""
    p = CALIBRATION.attenuation_camera1
    one = 400 * (1 - np.exp(-p * FILMS)) / p
    two = one * CALIBRATION.predict(FILMS)

    def log_ratio(first, second):
        return np.log((two + second * 1100) / (one + first * 900))

    step = 1e-6
    expected = [
        (log_ratio(step, 0) - log_ratio(-step, 0)) / (2 * step),
        (log_ratio(0, step) - log_ratio(0, -step)) / (2 * step),
    ]
    npt.assert_allclose(extended.gradient(FILMS)[-2:], expected, rtol=1e-6)
    npt.assert_array_equal(extended.gradient(FILMS)[:-2], CALIBRATION.gradient(FILMS))


def test_scatter_of_both_is_the_standard_deviation_of_the_film(extended):
    rng = np.random.default_rng(3)
    covariance = extended.full_covariance
    npt.assert_array_equal(covariance, covariance.T)
    errors = rng.multivariate_normal(np.zeros(len(covariance)), covariance, 40000)
    scatter = (errors @ extended.gradient(FILMS) / extended.slope(FILMS)).std(axis=0)
    npt.assert_allclose(extended.thickness_std(FILMS), scatter, rtol=4 / np.sqrt(80000))
    assert (extended.thickness_std(FILMS) > CALIBRATION.thickness_std(FILMS)).all()


def test_the_file_of_a_calibration_holds_no_background_of_a_run(extended):
    assert extended.to_dataset().identical(CALIBRATION.to_dataset())
