"""Positions taken from a film keep what repeats apart from what is new at every trigger."""

from dataclasses import replace
from functools import cache

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.gap import LOAD_LINE, VIEW, WHOLE, X, Y, circle_gap, known_calibration, noisy_ratios

from erlif.core.errors import ConfigError, ErlifError
from erlif.prediction import measured_minima, measured_positions
from erlif.prediction.measured import _share_marks
from erlif.rig import RigSettings
from erlif.rig.film import draw_marks
from erlif.show.plots import example_film
from erlif.trend import find_pin_position

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


def test_a_trigger_that_sees_nothing_of_its_film_keeps_its_covariance():
    covariances = np.array([np.diag([1e-16, 4e-16])] * 3)
    seen = np.array([[-1.0, 1.0], [-0.5, 0.8], [1.0, 1.0]])
    shared = _share_marks(covariances, seen)
    npt.assert_allclose(shared @ np.swapaxes(shared, 1, 2), covariances, rtol=0.02, atol=2e-18)


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


SWING = np.linspace(-3.5, 3.5, 5)  # mm, places of the thin line


@cache
def film_of_marks(seed):
    """Depth of the marks of turned surfaces at the pixels. [um]"""
    columns, rows = np.meshgrid(np.arange(X.size, dtype=float), np.arange(Y.size, dtype=float))
    rig = RigSettings(width=X.size, height=Y.size)
    return draw_marks(rig, np.random.default_rng(seed))(columns, rows)


def errors_by_marks(highest, seeds):
    """Errors of both displacements by the marks of turned surfaces, (seed, place, axis). [um]"""
    calibration = replace(known_calibration(), thickness_range=(0.2, highest))
    angle = SWING / VIEW.radius
    gaps = [circle_gap(224 * np.cos(one), 224 * np.sin(one)) for one in angle]

    def place(film):
        ratios = noisy_ratios(film, 1e-9, np.random.default_rng(0))
        return find_pin_position(ratios, calibration, region=WHOLE, view=VIEW).value[:2]

    smooth = np.array([place(gap) for gap in gaps])
    found = [[place(gap + film_of_marks(seed)) for gap in gaps] - smooth for seed in range(seeds)]
    # scratches lie deeper than waves are high: the mean of the errors is not zero
    return np.array(found) - np.mean(found, axis=0)


def stated_sources(highest, errors):
    """Sources of the errors that a film with these errors states, (place, axis, source). [um]"""
    angle = SWING / VIEW.radius
    film = example_film().isel(trigger=np.zeros(SWING.size, dtype=int))
    marks = np.zeros((SWING.size, 4, 4))
    marks[:, :2, :2] = np.einsum("kpa,kpb->pab", errors, errors) / len(errors)
    film["pin_displacement"] = film.pin_displacement.copy(
        data=224 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    )
    film["pin_displacement"].attrs["load_line"] = LOAD_LINE
    film["pin_position_cov"] = film.pin_position_cov_random + marks
    region = f"x = [{X[0]}, {X[-1]}]"
    film.attrs["settings"] = film.attrs["settings"].replace("x = [2.0, 14.0]", region)
    film.attrs["calibration"] = film.attrs["calibration"].replace(
        '"thickness_range": [0.3, 16.0]', f'"thickness_range": [0.3, {highest}]'
    )
    return measured_positions(film).shared * 1e6


@pytest.mark.parametrize(("highest", "alike"), [(25.0, True), (9.0, False)])
def test_marks_are_shared_as_far_as_the_same_ones_are_seen(highest, alike):
    """Pixels above the range do not count; the thin line moves by 7 mm over 12 mm."""
    errors = errors_by_marks(highest, 20)
    sources = stated_sources(highest, errors)
    for axis in range(2):
        seen = np.corrcoef(errors[:, :, axis].T)
        covariance = sources[:, axis] @ sources[:, axis].T
        std = np.sqrt(np.diag(covariance))
        npt.assert_allclose(std, np.sqrt(np.mean(errors[:, :, axis] ** 2, axis=0)), rtol=0.02)
        stated = covariance / np.outer(std, std)
        assert np.abs(stated - seen).max() < (0.001 if alike else 0.45)
        assert (stated.min() > 0.95) == alike
        assert (seen.min() > 0.95) == alike


def test_minima_share_their_calibration():
    found = measured_minima(
        np.array([5e-6, np.nan]), np.array([1e-8, 1e-8]), clearance=230e-6, std_shared=5e-8
    )
    assert found.known.tolist() == [True, False]
    npt.assert_allclose(found.shared[:, 0, 0], 5e-8)


def test_displacements_change_with_the_clearance_as_those_of_the_fit_to_ratios():
    """The ratios of one film, fitted with two clearances; the thin line moves by 7 mm over 12."""
    angle = SWING / VIEW.radius
    place = 224 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    found = example_film().isel(trigger=np.zeros(SWING.size, dtype=int))
    found["pin_displacement"] = found.pin_displacement.copy(data=place)
    found["pin_displacement"].attrs |= {"load_line": LOAD_LINE, "clearance": VIEW.clearance}
    region = f"x = [{X[0]}, {X[-1]}]"
    found.attrs["settings"] = found.attrs["settings"].replace("x = [2.0, 14.0]", region)
    widening = measured_positions(found).widening
    calibration = replace(known_calibration(), thickness_range=(0.2, 16.0))
    wider = replace(VIEW, bushing_radius=VIEW.bushing_radius + 5e-6)
    for one, stated in zip(place, widening, strict=True):
        ratios = noisy_ratios(circle_gap(*one), 1e-4, np.random.default_rng(0))
        before, after = (
            find_pin_position(ratios, calibration, region=WHOLE, view=view).value[:2]
            for view in (VIEW, wider)
        )
        npt.assert_allclose((after - before) / 5.0, stated, atol=0.02)
