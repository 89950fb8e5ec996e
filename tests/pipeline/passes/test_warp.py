"""Camera 2 on the pixels of camera 1, held to the plain alignment."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.pair import EPS, as_corrected, camera_map, camera_noise, scene

from erlif.pipeline.passes.noise import fill_noise
from erlif.pipeline.passes.warp import PairWarp, Warp, tabulate_map
from erlif.registration import align_frames
from erlif.registration.settings import ORIENTATIONS


def both(light, found, drift):
    """The pass, and the plain alignment."""
    shape = light.flags.shape[1:]
    out = PairWarp.empty(shape, found.settings.orientation)
    tables, noise = tabulate_map(found), camera_noise(shape)
    warp = Warp(light, tables, noise[1].turned(found.settings.orientation), drift, out)
    for start in range(0, shape[0], 16):
        warp.fill(start, min(start + 16, shape[0]))
    plain = align_frames(as_corrected(light, noise), found, drift=np.array([drift])).isel(frame=0)
    return out, tables, warp, plain


def check(light, found, drift):
    out, tables, warp, plain = both(light, found, drift)
    if np.isfinite(drift[0]):
        npt.assert_array_equal(out.flags | tables.flags, plain["flags"].values[1])

    # one spline: the plain alignment evaluates it by the same function
    npt.assert_array_equal(out.light, plain.signal.values[1])

    # a dozen roundings in the interpolation and as many in the factor
    for name, image in (("signal_var", out.variance), ("signal_var_fixed", out.variance_fixed)):
        npt.assert_allclose(image, plain[name].values[1], rtol=12 * EPS)
    npt.assert_allclose(warp.averaging, float(plain.interpolation), rtol=8 * EPS)


@pytest.mark.parametrize("shape", [(64, 96), (37, 51), (3, 5), (9, 3)])
@pytest.mark.parametrize("drift", [(0.0, 0.0), (0.37, -1.2), (-1.3, 2.6), (50.0, 0.0)])
def test_camera_2_is_that_of_the_plain_alignment(shape, drift):
    check(scene(shape), camera_map(shape), drift)


def test_displacement_may_differ_from_pixel_to_pixel():
    check(scene((48, 64)), camera_map((48, 64), rough=True), (0.2, 0.3))


def test_whole_displacements_reach_the_outermost_pixels():
    shape = (24, 40)
    found = camera_map(shape)
    found.displacement_x[:], found.displacement_y[:] = 2.0, -3.0
    light = scene(shape)
    check(light, found, (0.0, 0.0))
    out, *_ = both(light, found, (-2.0, 3.0))
    npt.assert_allclose(out.light, light.light[1], rtol=1e-5)
    variance, fixed = np.empty((2, *shape), np.float32)
    noise = tuple(camera_noise(shape)[1])
    fill_noise(light.light[1], noise, np.float32(1), variance, fixed, 0, shape[0])
    npt.assert_allclose(out.variance, variance, rtol=2 * EPS)


@pytest.mark.parametrize("orientation", ORIENTATIONS)
def test_turned_camera_is_turned_first(orientation):
    check(scene((40, 40)), camera_map((40, 40), orientation=orientation), (0.4, 0.1))


def test_turned_camera_may_have_exchanged_sides():
    check(scene((40, 56)), camera_map((40, 56), orientation="rotated_90"), (0.4, 0.1))


def test_unknown_drift_leaves_no_pixel():
    out, _, warp, plain = both(scene((24, 40)), camera_map((24, 40)), (np.nan, np.nan))
    assert np.isnan(out.light).all()
    assert np.isnan(out.variance).all()
    assert warp.averaging == 1.0 == float(plain.interpolation)
