"""Calibration against films whose ratio was integrated independently of the fitted model."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import SHAPE, WEDGE, K, P, Q, calibrate, has_note, log_ratio, wedge_profile
from scenes.fixture import image as make_image

from erlif.calibration import Profile
from erlif.core.errors import CalibrationError

RATIO = np.exp(log_ratio(WEDGE))


def ratio_image(rng, *, noise=0.004, ratio=RATIO, shape=SHAPE):
    return make_image(rng, np.log(ratio), noise=noise, shape=shape)


def fit(rng, *, image=None, profile=None, **options):
    image = ratio_image(rng) if image is None else image
    return calibrate(image, wedge_profile(rng) if profile is None else profile, **options)


def assert_true(calibration):
    """K, p and q lie within four standard deviations."""
    assert np.all(np.abs(calibration.parameters - [K, P, Q]) < 4 * calibration.standard_deviations)


def test_exact_fixture_gives_the_parameters():
    calibration = fit(
        np.random.default_rng(1), profile=wedge_profile(np.random.default_rng(1), noise=1e-3)
    )
    npt.assert_allclose(calibration.parameters, [K, P, Q], rtol=4e-3)
    npt.assert_allclose(calibration.predict(WEDGE), RATIO, rtol=3e-4)


def test_range_ends_where_the_noise_of_a_pixel_is_a_quarter_of_its_film():
    """Noise s of a single pixel is an error s/slope of its film; the limit is a quarter of it."""
    noise = 0.0135
    rng = np.random.default_rng(4)
    image = ratio_image(rng, noise=noise / np.sqrt(12))
    calibration = fit(rng, image=image)
    low, high = calibration.thickness_range
    assert 0 <= low < 0.3
    slope = Q / np.expm1(Q * high) - P / np.expm1(P * high)
    npt.assert_allclose(noise / slope, 0.25 * high, rtol=0.05)


def test_dim_light_leaves_a_range():
    """With a fifteenth of the light no pixel is good to a quarter of its thickness.

    Averages are, so films of 1 to 10 um stay in the range, which ends where a pixel is a quarter
    worse than the best.
    """
    noise = 0.055
    calibration = fit(
        np.random.default_rng(4),
        image=ratio_image(np.random.default_rng(4), noise=noise / np.sqrt(12)),
    )
    low, high = calibration.thickness_range
    slope = Q / np.expm1(Q * WEDGE) - P / np.expm1(P * WEDGE)
    best = (noise / slope / WEDGE).min()
    assert best > 0.25
    assert low < 1
    assert high > 9
    at_end = Q / np.expm1(Q * high) - P / np.expm1(P * high)
    npt.assert_allclose(noise / at_end / high, 1.25 * best, rtol=0.03)


def test_turned_profile_is_laid_over_the_image():
    """A wedge that rises down the image, with the profile's x turned by 90 degrees."""
    rng = np.random.default_rng(7)
    image = ratio_image(rng, ratio=RATIO[:, None], shape=SHAPE[::-1])
    calibration = fit(rng, image=image, direction=np.pi / 2)
    assert_true(calibration)


def test_thin_wedge_determines_k_and_the_difference_of_p_and_q_alone():
    rng = np.random.default_rng(9)
    thin = 0.02 * WEDGE
    exact = wedge_profile(rng, noise=0.0)
    profile = Profile(exact.position, 0.02 * exact.thickness, np.full(exact.thickness.size, 0.005))
    calibration = fit(rng, image=ratio_image(rng, ratio=np.exp(log_ratio(thin))), profile=profile)
    assert has_note(calibration, "too thin to separate p and q")
    slope = calibration.attenuation_camera1 - calibration.attenuation_camera2
    covariance = calibration.covariance
    std = np.sqrt(covariance[1, 1] + covariance[2, 2] - 2 * covariance[1, 2])
    assert abs(slope - (P - Q)) < 4 * std


@pytest.mark.parametrize("mirrored", [False, True])
def test_falling_ratio_has_its_likely_cause_first(mirrored):
    """Thick films have more light, and pixels of less noise, unless the profile is mirrored."""
    rng = np.random.default_rng(10)
    noise = 0.004 / np.sqrt(1 - np.exp(-0.4 * (WEDGE + 0.3)))
    image = ratio_image(rng, noise=np.median(noise), ratio=RATIO if mirrored else 1 / RATIO)
    image.log_ratio_var[:] = noise**2
    profile = wedge_profile(rng)
    if mirrored:
        profile = Profile(profile.position, profile.thickness[::-1], profile.uncertainty)
    with pytest.raises(CalibrationError, match="to rise with thickness") as caught:
        fit(rng, image=image, profile=profile)
    first, _, second = str(caught.value).partition("(2)")
    assert ("profile runs the other way" in first) == mirrored
    assert ("cameras look swapped" in first) != mirrored
    assert ("cameras are exchanged" in second) == mirrored


def test_curve_holds_the_points_that_were_kept():
    """One slip of the CMM by 3 um is counted in a note and absent from the curve."""
    rng = np.random.default_rng(21)
    profile = wedge_profile(rng)
    profile.thickness[90] += 3.0
    calibration = fit(rng, profile=profile)
    assert has_note(calibration, "1 of 192 points lie far off the curve")
    curve = calibration.curve
    assert curve.sizes["bin"] == 191
    assert not np.isclose(curve.curve_x, 9.0).any()
    modelled = calibration.predict(curve.curve_thickness.values)
    npt.assert_allclose(curve.curve_ratio - curve.curve_residual, modelled, rtol=1e-12)
    assert 0.7 < float((curve.curve_residual / curve.curve_ratio_std).std()) < 1.3


def test_scatter_above_the_stated_noise_widens_the_error_bars():
    """A CMM three times as noisy as stated: chi-square is nine, the errors are the true ones.

    The root of chi-square scatters by 5 %, and q, on which the error of q depends, by as much.
    """
    rng = np.random.default_rng(22)
    noisy = wedge_profile(rng, noise=0.15)
    understated = Profile(noisy.position, noisy.thickness, noisy.uncertainty / 3)
    found, true = fit(rng, profile=understated), fit(rng, profile=noisy)
    assert 9 * 0.7 < found.reduced_chi_square < 9 * 1.3
    npt.assert_allclose(found.standard_deviations, true.standard_deviations, rtol=0.25)


@pytest.mark.parametrize("noise", [0.004, 0.2])
def test_a_ratio_that_does_not_follow_the_profile_is_refused(noise):
    """Light that is no film: the ratio scatters from place to place, whatever the thickness."""
    rng = np.random.default_rng(8)
    scattered = np.exp(rng.normal(0, 0.3, WEDGE.size) + 1e-3 * np.arange(WEDGE.size))
    with pytest.raises(CalibrationError, match=r"of the variance|times the film") as error:
        fit(rng, image=ratio_image(rng, noise=noise, ratio=scattered))
    assert "erlif check FIXTURE_DIR" in str(error.value)
