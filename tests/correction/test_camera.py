"""One camera reduced in a pass: what its darks and flats hold, page by page."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.correction import find_unlit, measure_camera, reduce_darks

EMPTY = np.zeros(4096, np.int64)
SHAPE = (50, 60)


def measure(darks, flats, *, histogram=EMPTY, shape=SHAPE):
    return measure_camera(
        darks=darks, flats=flats, histogram=histogram, shape=shape, camera="camera1"
    )


def test_levels_and_light_are_those_of_the_flats(simulated):
    rng = np.random.default_rng(2)
    camera = simulated(shape=SHAPE)
    flats = camera.flats((4400, 8800), 4, rng, flicker=0)
    measured = measure(camera.darks(8, rng), iter(flats))
    assert measured.has_flat
    assert measured.flat_pages == 8
    mean = camera.response.mean()
    npt.assert_allclose(
        [level.light for level in measured.levels], [1000 * mean, 2000 * mean], rtol=0.002
    )
    expected = np.sum(flats, axis=0, dtype=float) - 8 * 64
    npt.assert_allclose(measured.flat_light, expected, rtol=0.01)


@pytest.mark.parametrize(("share", "used"), [(0.94, True), (0.96, False)])
def test_pixels_within_5_percent_of_saturation_are_left_out_of_the_noise(share, used):
    """Half of the image is near saturation: its level then has the light of the other half."""
    rng = np.random.default_rng(5)
    light = np.where(np.arange(60) < 30, 1000.0, share * 4095 - 64) * np.ones(SHAPE)
    flats = [np.rint(light + 64 + rng.normal(0, 3, SHAPE)).astype(np.uint16) for _ in range(4)]
    (level,) = measure(64.0, flats).levels
    expected = light.mean() if used else 1000.0
    assert level.light == pytest.approx(expected, rel=0.001)


SHAPE_OF_UNLIT = (60, 80)
LEVEL, NOISE = 64.0, 2.0  # DN


@pytest.fixture
def rng():
    return np.random.default_rng(5)


@pytest.fixture
def darks(rng):
    return reduce_darks(page(rng) for _ in range(16))


def page(rng, light=0.0):
    """Counts of an exposure at 4 electrons a count."""
    shot = rng.poisson(np.broadcast_to(4.0 * light, SHAPE_OF_UNLIT)) / 4.0
    return np.rint(LEVEL + shot + NOISE * rng.standard_normal(SHAPE_OF_UNLIT)).astype(np.uint16)


def find(frames, darks):
    histogram = sum(np.bincount(frame.ravel(), minlength=4096) for frame in frames)
    return find_unlit(np.max(frames, axis=0), histogram, darks)


def corners(light):
    """Even light in a circle."""
    y, x = np.indices(SHAPE_OF_UNLIT)
    return light * (np.hypot(x - 39.5, y - 29.5) < 35)


def test_corners_outside_the_light_are_found_but_not_their_edge(rng, darks):
    found = find([page(rng, corners(900.0)) for _ in range(8)], darks)
    y, x = np.divmod(found.place, SHAPE_OF_UNLIT[1])
    assert found.place.size > 300
    assert np.hypot(x - 39.5, y - 29.5).min() > 37
    npt.assert_allclose(found.light, 900, rtol=0.02)


def test_single_dark_pixels_serve_where_there_are_no_others(rng, darks):
    light = np.full(SHAPE_OF_UNLIT, 900.0)
    dead = np.array([5, 1000, 1001, 3003])
    light.flat[dead] = 0.0
    npt.assert_array_equal(find([page(rng, light) for _ in range(8)], darks).place, dead)
    light.flat[dead[2:]] = 900.0
    assert find([page(rng, light)], darks) is None


@pytest.mark.parametrize("offset", [60, 300, 1000])
def test_pixels_that_are_dark_in_the_flats_show_an_offset_of_all_frames(rng, darks, offset):
    flat = np.full(SHAPE_OF_UNLIT, 4000.0)
    flat.flat[[5, 1000, 1001, 3003]] = 3.0
    frames = [page(rng, flat * 0.2) + np.uint16(offset) for _ in range(8)]
    histogram = sum(np.bincount(frame.ravel(), minlength=4096) for frame in frames)
    found = find_unlit(np.max(frames, axis=0), histogram, darks, flat)
    npt.assert_array_equal(found.place, [5, 1000, 1001, 3003])
    npt.assert_allclose(np.mean([found.read(one)[0] for one in frames]), offset, atol=1.5)


def test_level_and_variance_of_dark_pixels_are_those_of_the_noise(rng, darks):
    """Variance 2^2 + 1/12 of a frame and a sixteenth of it in the mean of the darks."""
    found = find([page(rng, corners(900.0)) for _ in range(8)], darks)
    read = np.array([found.read(page(rng, corners(900.0)) + 7) for _ in range(50)])
    npt.assert_allclose(read.mean(axis=0)[0], 7.0, atol=0.05)
    npt.assert_allclose(found.variance, (NOISE**2 + 1 / 12) * 17 / 16, rtol=0.02)
    npt.assert_allclose(read.mean(axis=0)[1], found.variance, rtol=0.05)


def test_weak_light_has_the_variance_of_its_electrons(rng, darks):
    """10 counts of 4 electrons have a variance of 10/4 DN2; uneven light has none of its own."""
    found = find([page(rng, corners(900.0)) for _ in range(8)], darks)
    slope = np.linspace(0.0, 20.0, SHAPE_OF_UNLIT[1])
    read = np.array([found.read(page(rng, corners(900.0) + slope)) for _ in range(50)]).mean(axis=0)
    npt.assert_allclose(read[0], 10.0, atol=0.5)
    npt.assert_allclose(read[1] - found.variance, 10 / 4, rtol=0.15)


def test_frames_that_are_lit_everywhere_and_darks_of_one_page_show_nothing(rng, darks):
    assert find([page(rng, 900.0)], darks) is None
    frames = [page(rng, corners(900.0))]
    assert find(frames, reduce_darks([page(rng)])) is None
    assert find([page(rng)], darks) is None
