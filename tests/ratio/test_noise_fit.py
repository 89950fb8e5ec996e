"""The variance of differences split into its causes, on variances written out."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.pair import references_of, unknown

from erlif.ratio.noise_fit import BLOCKS, NoiseCells, NoiseFit, fit_pixel_noise, weigh_gains

CELLS = 1500
GAIN = np.array([4.4, 2.2])  # [electron/DN]
READ = np.array([9.0, 6.0])  # [electron]
ROUNDING = 1 / 12  # variance of counting in whole DN [DN2]


def cells(*, gain=GAIN, dark=(0.0, 0.0), pattern=0.0, constant=0.0, pixels=1e10):
    """Cells in light of 100 to 3000 DN, each with the scatter of a number of pixels."""
    rng = np.random.default_rng(1)
    light = rng.uniform(100, 3000, (CELLS, 2))
    shot, read = 1 / light, 1 / light**2
    moves = rng.uniform(0, 1, CELLS)
    variance = shot @ (1 / np.asarray(gain)) + read @ (np.asarray(dark) + ROUNDING)
    variance = variance + pattern * moves + constant
    variance = variance * (1 + np.sqrt(2 / pixels) * rng.standard_normal(CELLS))
    return NoiseCells(
        np.full(CELLS, float(pixels)),
        rng.integers(0, BLOCKS**2, CELLS),
        variance,
        shot,
        read,
        moves,
    )


def fit(given, what, *, pattern=False, flat_var=0.0):
    known = references_of((3, 4), gain=GAIN, read_noise=READ, flat=0.5, flat_var=flat_var)
    return fit_pixel_noise(given, known, what, one_gain=False, pattern=pattern)


DARK = (READ / GAIN) ** 2  # [DN2]


def test_two_gains_follow_from_the_light_of_each_camera():
    found = fit(cells(dark=DARK), unknown(gain=(True, True)))
    npt.assert_allclose(found.slope, 1 / GAIN, rtol=1e-4)
    assert np.isnan(found.response)
    assert found.dark == 0


@pytest.mark.parametrize("camera", [0, 1])
def test_dark_variance_of_one_camera_is_found_beside_the_known_one(camera):
    dark = DARK.copy()
    dark[camera] = 7.0
    found = fit(cells(dark=dark), unknown(read_noise=(camera == 0, camera == 1)))
    npt.assert_allclose(found.dark, 7.0, rtol=1e-3)


def test_response_follows_from_the_pattern():
    found = fit(cells(dark=DARK, pattern=1e-4), unknown(response=(True, True)), pattern=True)
    npt.assert_allclose(found.response, 1e-4, rtol=1e-4)
    assert found.determines_response


def test_the_noise_of_a_flat_is_subtracted():
    """Relative variance 1e-4: 0.25e-4 of a flat of 0.5."""
    given = cells(dark=DARK, pattern=1e-4)
    found = fit(given, unknown(gain=(True, True)), flat_var=0.25e-4)
    npt.assert_allclose(found.slope, 1 / GAIN, rtol=1e-4)


def test_outliers_are_left_out():
    given = cells(dark=DARK, pixels=64)
    clean = fit(given, unknown(gain=(True, True)))
    given.variance[::50] *= 1000
    found = fit(given, unknown(gain=(True, True)))
    std = np.sqrt(np.diag(found.slope_covariance))
    assert np.all(np.abs(found.slope - clean.slope) < std)
    assert np.all(np.abs(found.slope - 1 / GAIN) < 4 * std)


def noise_fit(slope, variance):
    return NoiseFit(np.array(slope), variance * np.eye(2), 0.0, 0.0, np.nan, np.nan)


SAME = noise_fit([0.25, 0.25], 1e-8)


def test_without_information_the_prior_stays():
    """Standard deviations far above the spread of unequal gains; 5 % are unequal."""
    _, alike = weigh_gains(SAME, noise_fit([0.2, 0.3], 1e6))
    npt.assert_allclose(alike, 0.95, rtol=1e-3)


def test_undecided_gains_have_the_variance_of_the_mixture():
    """At least that between both results, p (1 - p) d^2."""
    apart = noise_fit([0.235, 0.265], 2e-5)
    weighed, p = weigh_gains(SAME, apart)
    assert 0.05 < p < 0.995
    moved = (weighed.slope - SAME.slope) / (1 - p)
    between = p * (1 - p) * moved**2
    assert np.all(np.diag(weighed.slope_covariance) >= between)
    assert np.all(np.abs(weighed.slope - 0.25) < np.abs(apart.slope - 0.25))


@pytest.mark.parametrize(
    ("response", "std", "expected"),
    [(0.0, 1e-5, True), (1e-4, 3e-5, True), (1e-4, 5e-5, False), (1e-3, 2e-4, False)],
)
def test_a_response_is_determined_by_a_small_error_or_a_clear_value(response, std, expected):
    found = NoiseFit(np.zeros(2), np.zeros((2, 2)), 0.0, 0.0, response, std)
    assert found.determines_response is expected


def test_fits_without_scatter_are_not_averaged():
    """Frames of formulas, or none with noise: there is no error with which to compare."""
    for same, apart in ((0.0, (0.0, 0.0)), (0.25, (0.25, 0.25)), (0.25, (0.2, 0.3))):
        found, alike = weigh_gains(noise_fit((same, same), 0.0), noise_fit(apart, 0.0))
        assert alike == (apart[0] == apart[1])
        npt.assert_array_equal(found.slope, apart)
