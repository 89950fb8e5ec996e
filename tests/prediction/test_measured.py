"""Positions taken from a film keep what repeats apart from what is new at every trigger."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.core.errors import ConfigError, ErlifError
from erlif.prediction import measured_minima, measured_positions

TRIGGERS = 5
BOTH = ("trigger", "parameter", "parameter_other")


def film(surface=0.0):
    """Positions of a film with three numbers of the calibration, and their covariance."""
    rng = np.random.default_rng(4)
    gradient = rng.normal(size=(TRIGGERS, 4, 3))
    half = rng.normal(size=(3, 3))
    random = np.diag([1e-6, 4e-6, 1e-8, 1e-8]) * np.ones((TRIGGERS, 1, 1))
    marks = np.diag([surface**2, 0.0, 0.0, 0.0])
    whole = random + gradient @ (half @ half.T) @ np.swapaxes(gradient, 1, 2) + marks
    return half @ half.T, xr.Dataset(
        {
            "pin_displacement": (("trigger", "axis"), rng.normal(200, 1, (TRIGGERS, 2))),
            "pin_position_cov": (BOTH, whole),
            "pin_position_cov_random": (BOTH, random),
            "pin_position_gradient": (("trigger", "parameter", "number"), gradient),
        }
    )


def test_shared_errors_make_up_the_whole_covariance():
    calibration, positions = film(surface=0.3)
    found = measured_positions(positions, calibration)
    whole = found.random_cov + found.shared @ np.swapaxes(found.shared, 1, 2)
    npt.assert_allclose(whole * 1e12, positions.pin_position_cov[:, :2, :2], rtol=1e-9)


def test_triggers_share_errors_as_the_gradients_state():
    calibration, positions = film()
    found = measured_positions(positions, calibration)
    gradient = positions.pin_position_gradient.values[:, :2]
    between = found.shared[0] @ found.shared[3].T * 1e12
    npt.assert_allclose(between, gradient[0] @ calibration @ gradient[3].T, rtol=1e-6, atol=1e-9)


def test_another_calibration_is_refused():
    with pytest.raises(
        ConfigError, match="3 numbers of the calibration of this film, got one of 2"
    ):
        measured_positions(film()[1], np.eye(2))


def test_film_without_positions_is_refused():
    with pytest.raises(ErlifError, match="pin_displacement"):
        measured_positions(xr.Dataset())


def test_triggers_without_position_are_unknown():
    positions = film()[1]
    positions["pin_displacement"][2, 0] = np.nan
    assert measured_positions(positions).known.tolist() == [True, True, False, True, True]


def test_minima_share_their_calibration():
    found = measured_minima(
        np.array([5e-6, np.nan]), np.array([1e-8, 1e-8]), clearance=230e-6, std_shared=5e-8
    )
    assert found.known.tolist() == [True, False]
    npt.assert_allclose(found.shared[:, 0, 0], 5e-8)
