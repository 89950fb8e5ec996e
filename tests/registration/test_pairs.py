"""Pairs of frames: what is accepted, how camera 2 is turned, and which frames make the map."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import RegistrationError
from erlif.registration import RegistrationSettings, orient
from erlif.registration.normalise import REACH, binned, normalise
from erlif.registration.pairs import Pair, Textures, laid_over, make_pair, open_frames, textures
from erlif.registration.settings import ORIENTATIONS

SHAPE = (64, 80)
SETTINGS = RegistrationSettings()


def image(seed=0, kind=np.uint16, shape=SHAPE):
    return np.random.default_rng(seed).integers(500, 1500, shape).astype(kind)


def ones(shape=SHAPE):
    return np.ones(shape, np.float32)


# checks -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", [np.uint16, np.float32])
def test_types_of_the_kernels_are_kept(kind):
    given = image(kind=kind)
    pair = make_pair(given, given, None, None, SETTINGS)
    assert pair.reference.dtype == pair.moving.dtype == kind
    assert pair.weight_reference is None
    assert pair.weight_moving is None
    npt.assert_array_equal(pair.reference, given)


@pytest.mark.parametrize("kind", [np.uint8, np.int32, np.float64])
def test_other_real_types_become_single_precision(kind):
    given = image().astype(kind)
    pair = make_pair(image(), given, None, None, SETTINGS)
    assert pair.moving.dtype == np.float32
    npt.assert_array_equal(pair.moving, given)


@pytest.mark.parametrize(
    "wrong",
    [
        image(shape=(63, 80)),
        image(shape=(80, 63)),
        np.zeros((64, 80, 3)),
        np.zeros((64, 80), bool),
        np.zeros((64, 80), complex),
        np.zeros(5000),
    ],
)
@pytest.mark.parametrize("camera", [1, 2])
def test_anything_but_a_grey_image_is_refused_and_its_camera_named(wrong, camera):
    pair = (wrong, image()) if camera == 1 else (image(), wrong)
    with pytest.raises(RegistrationError, match=f"camera {camera} has {wrong.dtype} of shape"):
        make_pair(*pair, None, None, SETTINGS)


@pytest.mark.parametrize("camera", [1, 2])
def test_a_weight_of_another_shape_is_refused_and_its_camera_named(camera):
    weights = [None, None]
    weights[camera - 1] = np.ones((64, 79))
    with pytest.raises(RegistrationError, match=rf"camera {camera} has shape \(64, 79\)"):
        make_pair(image(), image(), *weights, SETTINGS)


def test_weights_become_single_precision():
    mask = image() > 1000
    pair = make_pair(image(), image(), mask, mask.astype(int), SETTINGS)
    for weight in (pair.weight_reference, pair.weight_moving):
        assert weight.dtype == np.float32
        npt.assert_array_equal(weight, mask)


def test_pixels_that_are_not_finite_lose_their_weight():
    given = image(kind=np.float64)
    given[3, 5], given[10, 20] = np.nan, np.inf
    pair = make_pair(given, image(kind=np.float32), None, None, SETTINGS)
    npt.assert_array_equal(np.argwhere(pair.weight_reference == 0), [[3, 5], [10, 20]])
    assert pair.weight_moving is None


def test_a_given_weight_is_kept_as_it_is():
    given = image(kind=np.float32)
    given[3, 5] = np.nan
    assert make_pair(given, given, ones(), None, SETTINGS).weight_reference.all()


# orientation ------------------------------------------------------------------------------------


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


def test_a_missing_pixel_is_turned_with_its_image():
    given = image(kind=np.float32)
    given[3, 5] = np.nan
    pair = make_pair(image(), given, None, None, RegistrationSettings(orientation="mirrored_x"))
    npt.assert_array_equal(np.argwhere(pair.weight_moving == 0), [[3, 80 - 1 - 5]])


# textures ---------------------------------------------------------------------------------------


def test_textures_at_full_size_are_the_normalised_frames():
    weight = (image(3) > 600).astype(np.float32)
    found = textures(Pair(image(1), image(2), weight, None), 1, 1)
    npt.assert_array_equal(found.a, normalise(image(1), weight)[0])
    npt.assert_array_equal(found.weight, weight)
    npt.assert_array_equal(found.b, normalise(image(2))[0])
    npt.assert_array_equal(found.weight_b, 1)


@pytest.mark.parametrize(("binning", "reach"), [(2, REACH / 2), (4, 3.0), (8, 3.0)])
def test_binned_textures_average_over_the_same_field_of_view(binning, reach):
    shape = (256, 320)
    pair = Pair(image(1, shape=shape), image(2, shape=shape))
    found = textures(pair, binning, 1)
    assert found.a.shape == (256 // binning, 320 // binning)
    for texture, frame in ((found.a, pair.reference), (found.b, pair.moving)):
        expected, _ = normalise(*binned(frame, None, binning), reach=reach)
        npt.assert_array_equal(texture, expected)


def test_weights_are_binned_with_their_frames():
    weight = ones()
    weight[10:12, 20:22] = 0
    found = textures(Pair(image(1), image(2), weight, weight), 2, 1)
    npt.assert_array_equal(np.argwhere(found.weight == 0), [[5, 10]])
    npt.assert_array_equal(np.argwhere(found.weight_b == 0), [[5, 10]])


def read(b, dx, dy, *, weight=None, drift=(0.0, 0.0)):
    """Texture of camera 2 read at an even displacement."""
    weight = ones(b.shape) if weight is None else weight
    spline = Textures(b, weight, b, weight).spline(1)
    field = np.ones(b.shape, np.float32)
    return laid_over(spline, np.float32(dx) * field, np.float32(dy) * field, drift, 1)


def test_camera_2_is_read_at_the_displaced_pixel():
    b = np.random.default_rng(5).normal(size=SHAPE).astype(np.float32)
    found = read(b, 3, -2)
    npt.assert_allclose(found[2:, :-3], b[:-2, 3:], atol=1e-5)
    assert np.isnan(found[:2]).all()
    assert np.isnan(found[:, -3:]).all()


def test_the_drift_is_added_to_the_displacement():
    b = np.random.default_rng(5).normal(size=SHAPE).astype(np.float32)
    npt.assert_array_equal(read(b, 1, -3, drift=(2.0, 1.0)), read(b, 3, -2))


def test_pixels_without_weight_are_not_interpolated_over():
    """One bad pixel spoils the four squares of which it is a corner."""
    b = np.random.default_rng(5).normal(size=SHAPE).astype(np.float32)
    weight = ones()
    weight[20, 30] = 0
    missing = np.argwhere(np.isnan(read(b, 0.5, 0.5, weight=weight)[:-1, :-1]))
    npt.assert_array_equal(missing, [[19, 29], [19, 30], [20, 29], [20, 30]])


# frames -----------------------------------------------------------------------------------------


def pairs_of(count):
    """Pairs whose pixel (0, 0) is the number of the frame."""
    frames = []
    for number in range(count):
        one = image(number)
        one[0, 0] = number
        frames.append((one, image(100 + number), None, None))
    return frames


def numbers(picked):
    return [int(pair.reference[0, 0]) for pair in picked]


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
    frames = open_frames(pairs_of(count), RegistrationSettings(frames_for_map=most))
    assert frames.count == count
    assert list(frames.chosen) == chosen


@pytest.mark.parametrize(("count", "most"), [(50, 32), (33, 32), (7, 5), (100, 7)])
def test_chosen_frames_are_evenly_spaced(count, most):
    chosen = open_frames([(None,) * 4] * count, RegistrationSettings(frames_for_map=most)).chosen
    steps = np.diff(chosen)
    assert len(chosen) == most
    assert steps.min() >= 1
    assert steps.max() - steps.min() <= 2
    assert chosen[0] <= count / most
    assert chosen[-1] >= count - 1 - count / most


@pytest.mark.parametrize("as_callable", [False, True])
def test_wanted_frames_are_read_in_order(as_callable):
    source = pairs_of(6)
    frames = open_frames((lambda: iter(source)) if as_callable else source, SETTINGS)
    assert frames.count == 6
    assert numbers(frames.pick([1, 3, 4])) == [1, 3, 4]
    assert numbers(frames.pick(range(6))) == list(range(6))


def test_a_sequence_reads_only_the_wanted_frames():
    read = []

    class Source(list):
        def __getitem__(self, number):
            read.append(number)
            return super().__getitem__(number)

    frames = open_frames(Source(pairs_of(6)), SETTINGS)
    assert numbers(frames.pick([2, 5])) == [2, 5]
    assert read == [2, 5]


def test_a_frame_is_checked_and_turned_when_it_is_read():
    source = pairs_of(3)
    source[1] = (image(shape=(20, 20)), image(), None, None)
    picked = open_frames(source, RegistrationSettings(orientation="rotated_180")).pick(range(3))
    npt.assert_array_equal(next(picked).moving, source[0][1][::-1, ::-1])
    with pytest.raises(RegistrationError, match="grey images"):
        next(picked)


@pytest.mark.parametrize("source", [[], lambda: iter([])])
def test_a_run_without_frames_is_refused(source):
    with pytest.raises(RegistrationError, match="at least one pair of frames, got none"):
        open_frames(source, SETTINGS)
