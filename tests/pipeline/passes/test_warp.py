"""Camera 2 on the pixels of camera 1, held to the plain alignment."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.pair import EPS, as_corrected, camera_map, camera_noise, scene
from scenes.plain import align_frames

from erlif.correction.light import fill_noise
from erlif.pipeline.passes.warp import NoiseRows, PairWarp, Warp, tabulate_map, turn_noise
from erlif.registration.settings import ORIENTATIONS


def both(light, found, drift):
    """The pass, and the plain alignment."""
    shape = light.flags.shape[1:]
    out = PairWarp.empty(shape, found.settings.orientation)
    tables, noise = tabulate_map(found), camera_noise(shape)
    warp = Warp(light, tables, turn_noise(noise[1], found.settings.orientation), drift, out)
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


def fill(light, noise, rows):
    """All rows, of which as many are kept."""
    kept = np.zeros((2, rows, light.shape[1]), np.float32)
    fill_noise(light, tuple(noise), np.float32(1), *kept, 0, light.shape[0])
    return kept


def test_rows_are_there_wherever_they_are_asked_for():
    """Forwards, with a gap, and back; never more at a time than are kept."""
    light, noise = scene((37, 51)).light[0], camera_noise((37, 51))[0]
    whole = fill(light, noise, 37)
    rows = NoiseRows()
    rows.begin(light, noise, np.ones(1), rows=9)
    for first, stop in ((0, 5), (3, 12), (4, 9), (8, 17), (25, 34), (2, 6), (0, 0), (28, 37)):
        rows.hold(first, stop)
        for row in range(first, stop):
            npt.assert_array_equal(rows.variance[row % 9], whole[0, row])
            npt.assert_array_equal(rows.fixed[row % 9], whole[1, row])
