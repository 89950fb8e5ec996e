"""The form of known gaps over many films, and the cause of a deviation."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.gap import (
    AXIAL_ORIGIN,
    BORE,
    VIEW,
    WHOLE,
    K,
    P,
    Q,
    Y,
    circle_gap,
    known_calibration,
    noisy_ratios,
)
from scenes.results import make_position

from erlif.trend import Cause, find_pin_position, judge_form

FILMS = (1.5, 2.5, 4.0, 7.0)
ROUNDED = 4.1  # um, of a clearance of two radii that are stated to 0.01 mm


def judge(gap, calibration=None, films=FILMS, **known):
    """Judge the gaps of some films, photographed with a calibration that may be wrong."""
    rng = np.random.default_rng(41)
    found = [
        find_pin_position(
            noisy_ratios(gap(film), 0.0135, rng),
            calibration or known_calibration(),
            region=WHOLE,
            view=VIEW,
        )
        for film in films
    ]
    return judge_form(found, VIEW, calibration_cov=known_calibration().full_covariance, **known)


def true_gap(film):
    return circle_gap(230 - film, 4.0)


def small_clearance(film):
    """A pin with 5 % less clearance than its settings have."""
    return circle_gap(0.95 * 230 - film, 4.0, pin=BORE - 0.95 * 0.230)


def bent(film):
    return true_gap(film) + 0.1 * ((Y - AXIAL_ORIGIN) / AXIAL_ORIGIN)[:, None] ** 2


def test_circles_of_the_settings_have_no_deviation():
    form = judge(true_gap, clearance_std=ROUNDED)
    assert form.cause is Cause.NONE
    assert abs(form.excess) < 2 * form.excess_std
    assert abs(form.bend) < 3 * form.bend_std
    npt.assert_allclose(form.films, (1.5, 7.0), atol=0.1)


@pytest.mark.parametrize(
    ("gap", "factors", "clearance_std", "cause", "excess"),
    [
        (small_clearance, (1, 1), ROUNDED, Cause.RADII, -0.05),
        # attenuations that are 5 % too small make every film 5 % too thick
        (true_gap, (1, 1.05), 0.4, Cause.CALIBRATION, 0.05),
        # as a background leaves it: 5 % of K move thick films more than thin ones
        (true_gap, (1.05, 1), 0.0, Cause.CALIBRATION, None),
        (true_gap, (1.05, 1), ROUNDED, Cause.CALIBRATION, None),
    ],
)
def test_wrong_radii_and_calibrations_are_recognised(gap, factors, clearance_std, cause, excess):
    """By the change with the film where the ratio has an offset."""
    calibration = known_calibration(factors[0] * K, P / factors[1], Q / factors[1])
    form = judge(gap, calibration, clearance_std=clearance_std)
    assert form.cause is cause
    assert (abs(form.excess_change) > 3 * form.excess_change_std) == (excess is None)
    if excess is not None:
        npt.assert_allclose(form.excess, excess, atol=0.01)


def test_bent_pin_is_recognised():
    """0.1 um over the half height: 2 x 0.1 / 4.77^2."""
    form = judge(bent, clearance_std=ROUNDED)
    assert form.cause is Cause.BENDING
    npt.assert_allclose(form.bend, 2 * 0.1 / AXIAL_ORIGIN**2, rtol=0.1)


def test_shared_errors_are_not_averaged_away():
    """Twenty triggers leave the error of the calibration, and of the scale, as it is."""
    calibration_cov = np.diag([0.02**2, 0.0, 0.0])
    positions = []
    for _ in range(20):
        one = make_position(std=0.02 * VIEW.curvature)
        one.form.gradient[0, 0] = VIEW.curvature
        positions.append(one)
    form = judge_form(positions, VIEW, calibration_cov=calibration_cov)
    expected = np.sqrt(0.02**2 + 0.02**2 / 20 + 0.01**2)
    npt.assert_allclose(form.excess_std, expected, rtol=1e-6)


def flattening_of_a_squeezed_film(film, depth):
    """Share by which the pressure of a squeezed film reduces the curvature in its middle.

    The pressure is (1 + s^2)^-2 with s = x / sqrt(2 R h). Two half-planes under it have the slope
    -2/(pi E*) times the integral of p(s)/(x - s) (Johnson 1985, section 2.5), taken here
    symmetrically about x, where its singularity cancels. With the line load q = p_max sqrt(2 R h)
    pi/2 and the depth 2 q/(pi E*), the curvature over 1/R is the depth over pi h times its change.
    """
    step = 1e-3
    away = step * (np.arange(60_000) + 0.5)

    def integral(x):
        before, after = ((1 + (x + sign * away) ** 2) ** -2.0 for sign in (-1, 1))
        return float(((before - after) / away).sum() * step)

    return -depth / (np.pi * film) * (integral(1e-3) - integral(-1e-3)) / 2e-3


def test_flattening_by_a_thin_film_is_recognised():
    """The same curvatures belong to the calibration where the bodies are rigid."""
    depth = 0.38  # um, the acrylic joint under 50 lbf
    positions = [
        make_position((flattening_of_a_squeezed_film(film, depth) * VIEW.curvature, 0.0), film=film)
        for film in (3.0, 5.0)
    ]
    known = {"calibration_cov": np.zeros((3, 3)), "clearance_std": ROUNDED}
    assert judge_form(positions, VIEW, flattening=depth, **known).cause is Cause.FLATTENING
    assert judge_form(positions, VIEW, **known).cause is Cause.CALIBRATION


def test_nothing_is_judged_without_a_position():
    missing = make_position((np.nan, np.nan))
    assert judge_form([missing], VIEW, calibration_cov=np.eye(3)) is None
    assert judge_form([], VIEW, calibration_cov=np.eye(3)) is None


def test_one_trigger_has_no_change_with_the_film():
    form = judge_form([make_position((0.02, 0.0))], VIEW, calibration_cov=np.zeros((3, 3)))
    assert np.isnan(form.excess_change)
    assert form.cause is Cause.CALIBRATION  # exact radii
