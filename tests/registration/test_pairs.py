"""Pairs of frames: what is accepted, how camera 2 is turned, and which frames make the map."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import RegistrationError
from erlif.registration import RegistrationSettings, orient
from erlif.registration.interpolation import laid_over
from erlif.registration.pairs import Textures, make_pair, open_series
from erlif.registration.settings import ORIENTATIONS

SHAPE = (64, 80)
SETTINGS = RegistrationSettings()


def image(seed=0, kind=np.uint16, shape=SHAPE):
    return np.random.default_rng(seed).integers(500, 1500, shape).astype(kind)


@pytest.mark.parametrize(
    "wrong", [image(shape=(63, 80)), np.zeros((64, 80, 3)), np.zeros((64, 80), complex)]
)
@pytest.mark.parametrize("camera", [1, 2])
def test_what_is_no_grey_image_or_no_weight_of_it_is_refused_and_its_camera_named(wrong, camera):
    pair = (wrong, image()) if camera == 1 else (image(), wrong)
    with pytest.raises(RegistrationError, match=f"camera {camera} has {wrong.dtype} of shape"):
        make_pair(*pair, None, None, SETTINGS)
    weights = (np.ones((64, 79)), None) if camera == 1 else (None, np.ones((64, 79)))
    with pytest.raises(RegistrationError, match=rf"camera {camera} has shape \(64, 79\)"):
        make_pair(image(), image(), *weights, SETTINGS)


def test_pixels_that_are_not_finite_lose_their_weight():
    given = image(kind=np.float64)
    given[3, 5], given[10, 20] = np.nan, np.inf
    pair = make_pair(given, image(kind=np.float32), None, None, SETTINGS)
    npt.assert_array_equal(np.argwhere(pair.weight_reference == 0), [[3, 5], [10, 20]])
    assert pair.weight_moving is None


@pytest.mark.parametrize("orientation", ORIENTATIONS)
def test_camera_2_and_its_weight_are_turned_and_camera_1_is_not(orientation):
    one, two = image(1), image(2)
    weight_1, weight_2 = (image(seed) > 900 for seed in (3, 4))
    settings = RegistrationSettings(orientation=orientation)
    pair = make_pair(one, two, weight_1, weight_2, settings)
    npt.assert_array_equal(pair.reference, one)
    npt.assert_array_equal(pair.weight_reference, weight_1)
    npt.assert_array_equal(pair.moving, orient(two, orientation))
    npt.assert_array_equal(pair.weight_moving, orient(weight_2, orientation))
    assert pair.moving.flags.c_contiguous
    assert pair.weight_moving.flags.c_contiguous


def test_pixels_without_weight_are_not_interpolated_over():
    """One bad pixel spoils the four squares of which it is a corner."""
    b = np.random.default_rng(5).normal(size=SHAPE).astype(np.float32)
    weight, half = np.ones(SHAPE, np.float32), np.full(SHAPE, 0.5, np.float32)
    weight[20, 30] = 0
    found = laid_over(Textures(b, weight, b, weight).spline(1), half, half, (0.0, 0.0), 1)
    missing = np.argwhere(np.isnan(found[:-1, :-1]))
    npt.assert_array_equal(missing, [[19, 29], [19, 30], [20, 29], [20, 30]])


@pytest.mark.parametrize(
    ("count", "most", "chosen"),
    [
        (1, 32, [0]),
        (5, 32, [0, 1, 2, 3, 4]),
        (9, 1, [4]),
        (9, 3, [1, 4, 7]),
        (12, 4, [1, 4, 7, 10]),
    ],
)
def test_the_middle_frames_of_equal_parts_of_the_run_make_the_map(count, most, chosen):
    frames = open_series([()] * count, RegistrationSettings(frames_for_map=most))
    assert frames.count == count
    assert list(frames.chosen) == chosen


def test_a_run_without_frames_is_refused():
    with pytest.raises(RegistrationError, match="at least one pair of frames, got none"):
        open_series([], SETTINGS)
