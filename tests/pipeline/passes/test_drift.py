"""The drift from binned light, held to the estimate from whole frames and to known scenes."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.pair import map_with, references_of
from scenes.registration import Scene, smooth_map

from erlif.core.errors import RegistrationError
from erlif.core.flags import Flag
from erlif.correction.light import measure_light, tabulate
from erlif.pipeline.passes.drift import PairDrift
from erlif.registration import estimate_drift, is_steep, orient

SMALL, LARGE, ODD = (160, 192), (416, 448), (411, 433)


def known_map(shape, orientation="normal", offset=(0.0, 0.0)):
    """The map of `smooth_map`, too small by an offset that is left as drift."""
    y, x = np.indices(shape).astype(float)
    dx, dy = smooth_map(shape)(x, y)
    return map_with(dx - offset[0], dy - offset[1], shape, orientation=orientation, threads=1)


def photograph(shape, seed=1, stranger=False):
    views = Scene(shape, seed).photograph(smooth_map(shape))
    other = Scene(shape, 77).photograph(smooth_map(shape)) if stranger else views
    return np.stack([views.reference, other.moving]).astype(np.uint16)


def to_light(counts):
    """Light of cameras without dark, flat and bad pixels that saturate at 4095."""
    references = references_of(counts.shape[1:], dark=0.0)
    return measure_light(counts, tabulate(references, least_signal=100.0))


def estimate(camera_map, light):
    """The same from whole frames."""
    sound = (light.flags & np.uint16(Flag.SATURATED | Flag.BAD_PIXEL)) == 0
    one, two = (
        (sound[n] & ~is_steep(light.blocks[n], sound[n].shape)).astype(np.float32) for n in range(2)
    )
    return estimate_drift(camera_map, *light.light, weight_reference=one, weight_moving=two)


@pytest.mark.parametrize("shape", [SMALL, LARGE])
def test_known_drift_is_found(shape):
    search = PairDrift.of(known_map(shape, offset=(4.25, -2.5)))
    found = search.find(to_light(photograph(shape)))
    npt.assert_allclose((found.dx, found.dy), (4.25, -2.5), atol=0.03)


@pytest.mark.parametrize("shape", [SMALL, LARGE, ODD])
@pytest.mark.parametrize("turn", ["normal", "mirrored_x", "rotated_180"])
def test_drift_is_that_of_the_estimate_from_whole_frames(shape, turn):
    """The coarse images differ a little; what is left of that is far below the noise."""
    counts = photograph(shape, seed=3)
    counts[1] = orient(counts[1], turn)
    camera_map = known_map(shape, turn, offset=(0.7, -0.4))
    light = to_light(counts)
    found, expected = PairDrift.of(camera_map).find(light), estimate(camera_map, light)
    assert abs(found.dx - expected.dx) < 0.1 * expected.std_dx
    assert abs(found.dy - expected.dy) < 0.1 * expected.std_dy
    npt.assert_allclose(
        (found.std_dx, found.std_dy, found.quality),
        (expected.std_dx, expected.std_dy, expected.quality),
        rtol=0.02,
    )


@pytest.mark.parametrize("shape", [SMALL, LARGE])
def test_saturated_and_steep_light_count_as_little_as_in_whole_frames(shape):
    """A saturated disk and a steep wedge that stay in place while camera 2 moves by 3 px."""
    counts = photograph(shape, seed=5)
    counts[1] = np.roll(counts[1], 3, axis=1)
    counts[:, 30:70, 40:90] = 4095
    wedge = np.exp(0.08 * np.arange(48)) / np.exp(0.08 * 47)
    counts[:, -64:, :48] = 3000 * wedge
    camera_map = known_map(shape)
    light = to_light(counts)
    found, expected = PairDrift.of(camera_map).find(light), estimate(camera_map, light)
    npt.assert_allclose((found.dx, found.dy), (3, 0), atol=0.05)
    npt.assert_allclose((found.dx, found.dy), (expected.dx, expected.dy), atol=2e-4)


@pytest.mark.parametrize("shape", [SMALL, LARGE])
def test_frame_without_common_texture_has_no_drift(shape):
    camera_map, light = known_map(shape), to_light(photograph(shape, stranger=True))
    found = PairDrift.of(camera_map).find(light)
    assert np.isnan([found.dx, found.dy, found.std_dx, found.std_dy]).all()
    with pytest.raises(RegistrationError, match="does not fit"):
        estimate(camera_map, light)


def test_frame_of_another_size_is_refused():
    search = PairDrift.of(known_map(LARGE))
    with pytest.raises(RegistrationError, match=r"for frames of \(416, 448\), .* \(160, 192\)"):
        search.find(to_light(photograph(SMALL)))
