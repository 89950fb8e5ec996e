"""Steps of the film: images of known pockets, blurred as by a lens, with noise."""

import cv2
import numpy as np
import pytest

from erlif.core.flags import Flag
from erlif.thickness import flag_steps

NOISE = 0.02
Y, X = np.mgrid[:240, :320]
FROM_AXIS = np.hypot(X - 160, Y - 120)
SMOOTH = 0.2 + 2e-6 * FROM_AXIS**2 + 3e-4 * X


def flags_of(log_ratio, noise=NOISE, flagged=None):
    """Flags of an image with noise of a given size at each pixel."""
    noise = np.broadcast_to(noise, log_ratio.shape)
    seen = log_ratio + noise * np.random.default_rng(4).normal(size=noise.shape)
    flags = np.zeros(noise.shape, np.uint16)
    if flagged is not None:
        seen[flagged], flags[flagged] = 3.0, Flag.NO_FILM
    flag_steps(seen.astype(np.float32), (noise**2).astype(np.float32), flags)
    return flags & np.uint16(Flag.FILM_STEP) > 0


def pocket(depth, radius=60.0):
    """An image with a pocket, as it is and behind a lens."""
    sharp = SMOOTH + depth * (radius > FROM_AXIS)
    return sharp, cv2.GaussianBlur(sharp, (0, 0), 0.8)


@pytest.mark.parametrize(("depth", "least"), [(0.1, 0.6), (-0.2, 0.85), (0.4, 0.95)])
def test_pixels_that_the_lens_falsifies_are_flagged_and_few_others(depth, least):
    sharp, blurred = pocket(depth)
    found = flags_of(blurred)
    wrong = np.abs(blurred - sharp) > 0.1 * abs(depth)
    assert found[wrong].mean() > least
    assert np.abs(FROM_AXIS[found] - 60).max() < 9
    assert found.sum() < 4 * wrong.sum()


@pytest.mark.parametrize(
    "noise",
    [0.0, 0.003, NOISE, NOISE * (1 + 3 * FROM_AXIS / 200)],
    ids=["none", "small", "usual", "rising towards the corners"],
)
def test_a_film_that_is_inclined_and_bends_has_no_step(noise):
    assert flags_of(SMOOTH, noise).mean() < 2e-4


@pytest.mark.parametrize("noise", [1e-5, NOISE])
def test_a_steep_film_has_no_step_at_the_border(noise):
    assert flags_of(0.2 + 3e-5 * (X - 160.0) ** 2 + 2e-3 * Y, noise).mean() < 2e-4


def test_a_bubble_is_no_step():
    bubble = FROM_AXIS < 20
    assert flags_of(SMOOTH, flagged=bubble).mean() < 2e-4


def test_an_image_too_small_for_a_step_has_none():
    assert not flags_of(np.where(X < 160, 0.2, 0.6)[:13, :320]).any()


@pytest.mark.parametrize("rise", [0.3, 1.0])
def test_the_flank_of_a_flattened_ball_has_no_step(rise):
    # gap beside a Hertzian contact (Johnson, Contact Mechanics 1985, section 4.2), and a
    # constriction with a standard deviation of a tenth of its radius
    out = np.maximum(FROM_AXIS / 50, 1)
    gap = np.sqrt(out**2 - 1) + (out**2 - 2) * np.arccos(1 / out)
    constriction = 0.05 * np.exp(-(((FROM_AXIS - 48) / 7) ** 2))
    film = cv2.GaussianBlur(0.2 + rise * gap - constriction, (0, 0), 0.8)
    assert flags_of(film, 0.006).mean() < 2e-4
