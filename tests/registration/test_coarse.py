"""The coarse alignment on scenes of known offset, rotation and scale, and why it refuses others."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.registration import Scene, expose, smooth_map

from erlif.core.errors import RegistrationError
from erlif.registration import RegistrationSettings, orient
from erlif.registration.coarse import CoarsePair, Correlator, find_start
from erlif.registration.pairs import Pair, Textures

SHAPE = (256, 320)
SMALL = (96, 112)  # for refusals, which try every orientation first


def views_of(shape=SHAPE, seed=1, texture=None, **field):
    """A scene whose displacement is affine."""
    affine = smooth_map(shape, cubic=0.0, quadratic=0.0, **field)
    return Scene(shape, seed, **(texture or {})).photograph(affine)


def start_of(views, **settings):
    return find_start(Pair(views.reference, views.moving), RegistrationSettings(**settings))


def error_of(start, views):
    """Largest distance between the start and the truth over the frame. [px]"""
    h, w = views.dx.shape
    y, x = np.mgrid[:h, :w]
    place = np.stack([x, y], axis=-1)
    found = place @ start.matrix.T + start.offset
    return float(np.hypot(found[..., 0] - views.dx, found[..., 1] - views.dy).max())


@pytest.fixture(scope="module")
def views():
    return views_of()


@pytest.mark.parametrize(
    "field",
    [
        {"offset": (0.0, 0.0), "rotation": 0.0, "scale": 1.0},
        {"offset": (60.0, -45.0), "rotation": 0.0, "scale": 1.0},
        {"offset": (-30.0, 20.0), "rotation": 1.0, "scale": 0.99},
        {"offset": (10.0, -5.0), "rotation": 4.4, "scale": 1.0},
        {"offset": (10.0, -5.0), "rotation": -3.1, "scale": 1.04},
        {"offset": (-20.0, 8.0), "rotation": 0.6, "scale": 0.955},
    ],
)
def test_an_affine_map_is_found_within_a_binned_pixel(field):
    """Frames of 320 px are binned by two."""
    views = views_of(**field)
    start = start_of(views)
    assert error_of(start, views) < 1.0
    assert start.part > 0.8


def test_cameras_of_different_size_are_aligned(views):
    """Camera 2 with 40 columns fewer on its left: the same point lies 40 px further left."""
    narrow = replace(views, moving=np.ascontiguousarray(views.moving[:, 40:]))
    start = start_of(narrow)
    assert error_of(start._replace(offset=start.offset + np.array([40, 0])), views) < 1.0


def test_pixels_without_weight_do_not_decide():
    """A pattern on both sensors fits without any displacement; masked, the scene decides."""
    views = views_of(offset=(22.0, 12.0), rotation=0.0, scale=1.0)
    rng = np.random.default_rng(2)
    spots = rng.uniform(size=(SHAPE[0] // 4, SHAPE[1] // 4)).repeat(4, 0).repeat(4, 1) < 0.06
    weight = np.where(spots, 0, 1).astype(np.float32)
    frames = [np.where(spots, 4095, image) for image in (views.reference, views.moving)]
    start = find_start(Pair(*frames, weight, weight), RegistrationSettings())
    assert error_of(start, views) < 1.5


def noise_pair(offset=(0, 0), *, weight=None):
    """White noise under two cameras, camera 2 moved by whole pixels around the frame."""
    a = np.random.default_rng(5).standard_normal(SMALL).astype(np.float32)
    ones = np.ones(SMALL, np.float32)
    b = np.roll(a, offset[::-1], (0, 1))
    return Textures(a, ones, b, ones if weight is None else weight)


def test_the_height_of_a_peak_is_the_root_of_the_number_of_pixels():
    """Sum of n squares over the scatter of a sum of n products, both of unit variance."""
    pair = noise_pair()
    significance, offset = Correlator(CoarsePair(pair, 1), 0.27).peak(pair.b, 0.0)
    npt.assert_allclose(significance, np.sqrt(96 * 112), rtol=0.05)
    npt.assert_array_equal(offset, 0)


def test_offsets_at_which_hardly_any_pixel_is_shared_do_not_count():
    """Only 60 rows of camera 2 are known: they alone make the peak; without any there is none."""
    weight = np.ones(SMALL, np.float32)
    weight[60:] = 0
    pair = noise_pair(weight=weight)
    known = pair.b * weight
    both = CoarsePair(replace(pair, b=known), 1)
    significance, offset = Correlator(both, 0.27).peak(known, 0.0)
    npt.assert_array_equal(offset, 0)
    npt.assert_allclose(significance, np.sqrt(60 * 112), rtol=0.1)
    blind = CoarsePair(replace(pair, weight_b=0 * weight), 1)
    assert Correlator(blind, 0.27).peak(pair.b, 0.0)[0] == 0


@pytest.mark.parametrize(
    ("mounted", "expected", "named"),
    [
        ("mirrored_x", "normal", "mirrored_x"),
        ("transposed", "normal", "transposed"),
        ("normal", "mirrored_y", "normal"),
        ("rotated_90", "mirrored_x", "rotated_270"),
    ],
)
def test_a_camera_in_another_orientation_is_named(views, mounted, expected, named):
    """Frames come turned by the settings already; the message names what the settings should be."""
    seen = np.ascontiguousarray(orient(orient(views.moving, mounted), expected))
    weight, settings = np.ones(seen.shape, np.float32), RegistrationSettings(orientation=expected)
    message = f'in orientation {expected!r} .* Set orientation = "{named}"'
    with pytest.raises(RegistrationError, match=message):
        find_start(Pair(views.reference, seen, None, weight), settings)


def test_an_offset_within_the_search_range_is_found_and_beyond_it_named():
    views = views_of(SMALL, offset=(28.0, 0.0), rotation=0.0, scale=1.0)
    assert error_of(start_of(views, search=0.27), views) < 1.0
    message = r"within 20% of the frame, .* offset of \((27|28|29), -?[01]\) px"
    with pytest.raises(RegistrationError, match=message):
        start_of(views, search=0.2)


def test_a_camera_needs_a_twentieth_of_its_pixels(views):
    half, hardly = np.zeros((2, *SHAPE), np.float32)
    half[:, :160], hardly[:, :9] = 1, 1
    pair, options = (views.reference, views.moving), RegistrationSettings()
    assert error_of(find_start(Pair(*pair, half), options), views) < 3.0
    for camera, weights in ((1, (hardly, None)), (2, (None, hardly))):
        with pytest.raises(RegistrationError, match=f"camera {camera} is both lit and sound"):
            find_start(Pair(*pair, *weights), options)


EVEN = np.full(SMALL, 1000, np.uint16)
LIGHT = views_of(SMALL, 79, {"contrast": 0.0, "private": 0.0, "scratches": 0})


@pytest.mark.parametrize(
    ("one", "two", "peak"),
    [
        (views_of(SMALL).reference, views_of(SMALL, seed=9).moving, r"\d\.\d"),
        (LIGHT.reference, expose(LIGHT.clean_moving, np.random.default_rng(13)), r"\d\.\d"),
        (EVEN, EVEN, r"0\.0"),
    ],
    ids=["two walls", "light without texture", "one count"],
)
def test_frames_with_nothing_in_common_are_refused_with_the_height_of_the_peak(one, two, peak):
    with pytest.raises(RegistrationError, match=f"stands {peak} times above chance, 7 are needed"):
        find_start(Pair(one, two), RegistrationSettings())
