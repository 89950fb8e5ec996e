"""The ratio pass, held to the plain functions, and its logarithm to numpy's."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.pair import EPS, as_corrected, camera_map, camera_noise, scene
from scenes.plain import align_frames, compute_ratio, soften
from scipy.ndimage import maximum_filter

from erlif.core.flags import Flag
from erlif.pipeline.passes.ratio import KEPT, measure_ratio
from erlif.pipeline.passes.warp import PairWarp, tabulate_map, turn_noise
from erlif.ratio import BlurDifference, PairRatio
from erlif.ratio.log_ratio import _take_log, empty_ratio
from erlif.ratio.softening import Softening

BLUR = BlurDifference(0.03, -0.02, 0.001, 0.001, excess=0.004, excess_std=0.0001)


def both(light, found, drift, blur=BLUR, share=0.25):
    """The pass, and the plain functions."""
    shape = light.flags.shape[1:]
    noise, orientation = camera_noise(shape), found.settings.orientation
    ratio = measure_ratio(
        light,
        tabulate_map(found),
        (noise[0], turn_noise(noise[1], orientation)),
        drift,
        softening=Softening.of(blur),
        no_film_below=share,
        warped=PairWarp.empty(shape, orientation, rows=KEPT),
        out=empty_ratio(shape),
    )
    aligned = align_frames(as_corrected(light, noise), found, drift=np.array([drift]))
    plain = compute_ratio(aligned, no_film_below=share, blur=blur)
    plain = plain.expand_dims("frame").assign(signal_camera1=aligned.signal.isel(camera=0))
    return ratio, PairRatio.of(plain), whole_share(aligned, blur)


def whole_share(aligned, blur):
    """Blurred light over the brightest near it: where it is small, roundings are those of these."""
    least = np.ones(aligned.sizes["y"], float)[:, None]
    for n, taps in enumerate(Softening.of(blur).taps):
        light, flags = aligned.signal.values[n, 0], aligned["flags"].values[n, 0]
        near = maximum_filter(np.abs(np.nan_to_num(light)), taps.shape[1])
        with np.errstate(divide="ignore", invalid="ignore"):
            least = np.fmin(least, np.abs(soften(light.astype(float), flags, taps)) / near)
    return least


def check(light, found, drift, blur=BLUR):
    ratio, plain, share = both(light, found, drift, blur)
    npt.assert_array_equal(ratio.flags, plain.flags)
    npt.assert_array_equal(ratio.light_one, plain.light_one)

    # three dozen roundings from the variances of the light to those of the ratio
    for name in ("variance", "variance_fixed"):
        off = share * (getattr(ratio, name) / getattr(plain, name) - 1)
        npt.assert_allclose(off, 0 * getattr(plain, name), rtol=0, atol=20 * EPS)

    # the roundings of both lights, and of the logarithm of their ratio
    largest = np.nanmax(np.abs(plain.log_ratio), initial=1.0)
    bias = np.nanmax(plain.variance, initial=0.0)
    atol = (4 * largest + 20 * bias + 16 * 4 * 0.05) * EPS
    npt.assert_allclose(share * ratio.log_ratio, share * plain.log_ratio, rtol=0, atol=atol)

    # differences of light that nearly cancel: rounding relative to the light, not to them
    largest = float(np.nanmax(np.abs(plain.variance_shared), initial=0.0))
    npt.assert_allclose(
        ratio.variance_shared, plain.variance_shared, rtol=20 * EPS, atol=20 * EPS * largest
    )

    # sums over rows in single precision
    npt.assert_allclose(ratio.noise_correlation, plain.noise_correlation, rtol=100 * EPS)


@pytest.mark.parametrize("shape", [(96, 64), (37, 51), (3, 5), (9, 3), (65, 20), (150, 40)])
@pytest.mark.parametrize("drift", [(0.0, 0.0), (0.37, -1.2), (500.0, 0.0)])
def test_ratio_is_that_of_the_plain_functions(shape, drift):
    check(scene(shape), camera_map(shape), drift)


@pytest.mark.parametrize("shape", [(3, 5), (65, 20), (150, 40)])
def test_a_blur_that_reaches_eight_pixels_crosses_the_bands(shape):
    wide = BlurDifference(1.5, -0.3, 0.001, 0.001)
    check(scene(shape), camera_map(shape), (0.37, -1.2), wide)
    check(scene(shape), camera_map(shape), (0.37, -1.2), replace(wide, x=-0.3, y=1.5))


def test_light_below_the_dark_has_no_ratio():
    light = scene((48, 64), dark=0.2)
    light.light[:, 10:14, 20:24] = 0.0
    check(light, camera_map((48, 64)), (0.1, 0.2))
    ratio, *_ = both(light, camera_map((48, 64)), (0.1, 0.2))
    assert (ratio.flags[np.isnan(ratio.log_ratio)] != 0).all()


def test_drift_that_is_not_known_is_flagged():
    ratio, plain, _ = both(scene((24, 40)), camera_map((24, 40)), (np.nan, np.nan))
    npt.assert_array_equal(ratio.flags, plain.flags)
    assert (ratio.flags & Flag.POOR_REGISTRATION > 0).all()
    assert np.isnan(ratio.log_ratio).all()
    assert np.isnan(ratio.drift).all()


@pytest.mark.parametrize("orientation", ["mirrored_y", "rotated_270", "antitransposed"])
def test_camera_2_may_be_turned(orientation):
    check(scene((40, 40)), camera_map((40, 40), orientation=orientation), (0.4, 0.1))


def test_logarithm_is_good_to_single_precision():
    rng = np.random.default_rng(4)
    exact = np.concatenate([np.exp(rng.uniform(-30, 30, 5000)), rng.uniform(0.5, 2, 5000), [1.0]])
    values = exact.astype(np.float32)
    truth = np.log(values.astype(float))
    _take_log(values, values.view(np.int32), np.empty_like(values))
    npt.assert_allclose(values, truth, rtol=2 * EPS, atol=0)
    assert values[-1] == 0


@pytest.mark.parametrize("drift", [(0.37, -1.2), (0.2, 40.0), (0.0, -90.0), (np.nan, np.nan)])
@pytest.mark.parametrize("rough", [False, True])
def test_images_are_the_same_in_less_memory(drift, rough):
    """Two bands and a part; the part of the variance that repeats may share one row."""
    found, light = camera_map((150, 40), rough=rough), scene((150, 40))
    separate, *_ = both(light, found, drift)
    place = np.empty((150, 40), np.float32)
    shown = light.light[1].copy()
    lean = measure_ratio(
        light,
        tabulate_map(found),
        camera_noise((150, 40)),
        drift,
        softening=Softening.of(BLUR),
        no_film_below=0.25,
        warped=PairWarp.empty((150, 40), found.settings.orientation, rows=KEPT),
        out=empty_ratio((150, 40), with_fixed=False, replaces=(place, light.light[1])),
    )
    assert np.shares_memory(lean.log_ratio, place)
    assert not np.array_equal(light.light[1], shown)
    for name in ("log_ratio", "variance", "variance_shared", "flags"):
        npt.assert_array_equal(getattr(lean, name), getattr(separate, name))
    npt.assert_array_equal(lean.variance_fixed[0], separate.variance_fixed[-1])
