"""Pixels without light: found where frames are dark, and read with the noise that they have."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.correction import find_unlit, reduce_darks

SHAPE = (60, 80)
LEVEL, NOISE = 64.0, 2.0  # DN


@pytest.fixture
def rng():
    return np.random.default_rng(5)


@pytest.fixture
def darks(rng):
    return reduce_darks(page(rng) for _ in range(16))


def page(rng, light=0.0):
    """Counts of an exposure at 4 electrons a count."""
    shot = rng.poisson(np.broadcast_to(4.0 * light, SHAPE)) / 4.0
    return np.rint(LEVEL + shot + NOISE * rng.standard_normal(SHAPE)).astype(np.uint16)


def find(frames, darks):
    histogram = sum(np.bincount(frame.ravel(), minlength=4096) for frame in frames)
    return find_unlit(np.max(frames, axis=0), histogram, darks)


def corners(light):
    """Even light in a circle."""
    y, x = np.indices(SHAPE)
    return light * (np.hypot(x - 39.5, y - 29.5) < 35)


def test_corners_outside_the_light_are_found_but_not_their_edge(rng, darks):
    found = find([page(rng, corners(900.0)) for _ in range(8)], darks)
    y, x = np.divmod(found.place, SHAPE[1])
    assert found.place.size > 300
    assert np.hypot(x - 39.5, y - 29.5).min() > 37
    npt.assert_allclose(found.light, 900, rtol=0.02)


def test_single_dark_pixels_serve_where_there_are_no_others(rng, darks):
    light = np.full(SHAPE, 900.0)
    dead = np.array([5, 1000, 1001, 3003])
    light.flat[dead] = 0.0
    npt.assert_array_equal(find([page(rng, light) for _ in range(8)], darks).place, dead)
    light.flat[dead[2:]] = 900.0
    assert find([page(rng, light)], darks) is None


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
    slope = np.linspace(0.0, 20.0, SHAPE[1])
    read = np.array([found.read(page(rng, corners(900.0) + slope)) for _ in range(50)]).mean(axis=0)
    npt.assert_allclose(read[0], 10.0, atol=0.5)
    npt.assert_allclose(read[1] - found.variance, 10 / 4, rtol=0.15)


def test_frames_that_are_lit_everywhere_and_darks_of_one_page_show_nothing(rng, darks):
    assert find([page(rng, 900.0)], darks) is None
    frames = [page(rng, corners(900.0))]
    assert find(frames, reduce_darks([page(rng)])) is None
    assert find([page(rng)], darks) is None
