"""Planes about a pixel and steps through its window, against least squares written out."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.ratio.planes import find_steps, fit_one_side, fit_planes, step_distances, weigh_pixels

SHAPE = (21, 25)
REACH = 4
Y, X = np.indices(SHAPE)
D = np.arange(-REACH, REACH + 1)
WINDOW = np.exp(-0.5 * (D / 1.7) ** 2)
STEP = np.where(D >= 0, 1.0, -1.0)
TAPS = np.stack(
    [
        *(WINDOW * D**n for n in range(3)),
        *(WINDOW**2 * D**n for n in range(3)),
        WINDOW * STEP,
        WINDOW * D * STEP,
    ]
).astype(np.float32)


@pytest.fixture
def image():
    """Values, variance and valid pixels, with a hole."""
    rng = np.random.default_rng(1)
    sound = np.ones(SHAPE, bool)
    sound[8:11, 13:16] = False
    variance = rng.uniform(0.5, 2.0, SHAPE).astype(np.float32)
    return rng.normal(0, 1, SHAPE).astype(np.float32), variance, sound


def weigh(value, variance, sound, shared=0.0):
    shared = np.full(SHAPE, shared, np.float32)
    return weigh_pixels(value, variance, shared, sound, 0.0, REACH)


def fitted(planes, value, variance, limit=np.inf):
    smooth, remaining = value.copy(), np.full(SHAPE, 1e6, np.float32)
    suspect = np.zeros(SHAPE, np.uint8)
    fit_planes(planes, TAPS, limit, 0.0, smooth, remaining, suspect)
    return smooth, remaining, suspect


def one_sided(planes, places, value, variance, smooth, remaining):
    window, distances = WINDOW.astype(np.float32), step_distances(REACH)
    fit_one_side(planes, window, distances, places, 4.5**2, value, variance, 0.0, smooth, remaining)


def least_squares(i, j, value, variance, use):
    """Weights with which the pixels enter the plane at (i, j), zero outside the window."""
    apart = np.maximum(abs(Y - i), abs(X - j))
    use = use & (apart <= REACH)
    weight = np.exp(-0.5 * ((Y - i) ** 2 + (X - j) ** 2) / 1.7**2)[use] / variance[use]
    design = np.stack([np.ones(use.sum()), (X - j)[use], (Y - i)[use]], axis=1)
    inverse = np.linalg.inv(design.T @ (weight[:, None] * design))
    share = (inverse @ design.T * weight)[0]
    return share @ value[use], share**2 @ variance[use]


@pytest.mark.parametrize("place", [(10, 12), (0, 0), (9, 12), (20, 13), (7, 24)])
def test_plane_is_that_of_weighted_least_squares(image, place):
    value, variance, sound = image
    smooth, remaining, _ = fitted(weigh(*image), value, variance)
    expected, expected_variance = least_squares(*place, value, variance, sound)
    npt.assert_allclose(smooth[place], expected, atol=1e-5)
    npt.assert_allclose(remaining[place], expected_variance, rtol=1e-4)


@pytest.mark.parametrize("along", ["x", "y"])
def test_a_step_through_a_pixel_is_suspect(along):
    place = X if along == "x" else Y
    value = np.where(place >= 10, 4.0, 0.0).astype(np.float32)
    variance = np.ones(SHAPE, np.float32)
    planes = weigh(value, variance, np.ones(SHAPE, bool))
    _, _, suspect = fitted(planes, value, variance, limit=3.5**2)
    marked = np.nonzero(suspect.any(axis=0 if along == "x" else 1))[0]
    assert 10 in marked
    assert np.abs(marked - 9.5).max() < REACH
    tilted = weigh(0.3 * place, variance, np.ones(SHAPE, bool))
    assert not fitted(tilted, value, variance, limit=3.5**2)[2].any()


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.2, np.pi / 2, 2.5])
def test_a_step_of_any_direction_is_found_and_each_side_keeps_its_level(angle):
    """Two levels with a slope in common, six standard deviations apart, without noise."""
    across = (X - 12) * np.cos(angle) + (Y - 10) * np.sin(angle)
    level = np.where(across >= 0, 6.0, 0.0)
    value = (level + 0.05 * X - 0.02 * Y).astype(np.float32)
    variance, sound = np.ones(SHAPE, np.float32), np.ones(SHAPE, bool)
    planes = weigh(value, variance, sound)
    places = np.argwhere((np.abs(across) < 2) & (np.abs(X - 12) < 6) & (np.abs(Y - 10) < 6))
    assert find_steps(planes, step_distances(REACH), places, 4.5**2).all()

    # lines are rounded to half pixels: pixels half a pixel from the step may change sides
    smooth, remaining = value.copy(), variance.copy()
    one_sided(planes, places, value, variance, smooth, remaining)
    clear = tuple(places[np.abs(across[tuple(places.T)]) > 0.5].T)
    assert np.abs(smooth[clear] - value[clear]).max() < 1.0
    assert np.median(np.abs(smooth[clear] - value[clear])) < 0.01
    assert (remaining[tuple(places.T)] < 1).all()


def test_noise_alone_has_few_steps():
    """Hundreds of lines are tried in a window; at 4.5 standard deviations few are significant."""
    rng = np.random.default_rng(3)
    variance, sound = np.ones(SHAPE, np.float32), np.ones(SHAPE, bool)
    found = []
    for _ in range(20):
        planes = weigh(rng.normal(0, 1, SHAPE).astype(np.float32), variance, sound)
        places = np.argwhere((X % 5 == 2) & (Y % 5 == 2))
        found.append(find_steps(planes, step_distances(REACH), places, 4.5**2))
    assert np.mean(found) < 0.02


def test_a_pixel_without_a_step_is_not_changed():
    value = (0.1 * X).astype(np.float32)
    variance, sound = np.ones(SHAPE, np.float32), np.ones(SHAPE, bool)
    smooth, remaining = np.full(SHAPE, 7.0, np.float32), np.full(SHAPE, 0.3, np.float32)
    one_sided(weigh(value, variance, sound), np.argwhere(sound), value, variance, smooth, remaining)
    npt.assert_array_equal(smooth, 7.0)
    npt.assert_array_equal(remaining, np.float32(0.3))
