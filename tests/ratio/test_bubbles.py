"""Bubbles: found with their meniscus, and nothing else."""

import cv2
import numpy as np
import pytest

from erlif.ratio import find_bubbles


def test_bubbles_are_found_with_their_rim_in_uneven_light():
    y, x = np.indices((120, 160))
    beam = 2000 * np.exp(-((x - 80) ** 2 + (y - 60) ** 2) / (2 * 60**2))
    for centre, radius in (((30, 40), 4), ((90, 120), 9)):
        beam[np.hypot(y - centre[0], x - centre[1]) <= radius] *= 0.05
    dark = find_bubbles(beam.astype(np.float32), beam.astype(np.float32), share=0.25)
    for centre, radius in (((30, 40), 4), ((90, 120), 9)):
        assert dark[np.hypot(y - centre[0], x - centre[1]) <= radius + 2].all()
    near = np.minimum(np.hypot(y - 30, x - 40) - 4, np.hypot(y - 90, x - 120) - 9)
    assert not dark[near > 5].any()


def even_light(shape=(64, 80)):
    return np.full(shape, 1000, np.float32)


@pytest.mark.parametrize(("level", "expected"), [(0.24, True), (0.26, False)])
def test_a_pixel_is_dark_below_the_share_of_its_surroundings(level, expected):
    light = even_light()
    light[30:33, 40:43] *= level
    assert find_bubbles(light, light, share=0.25)[31, 41] == expected


def test_unknown_pixels_are_no_bubble():
    light = even_light()
    light[10:40, 10:60] = np.nan
    assert not find_bubbles(light, light, share=0.25).any()
    light[:] = np.nan
    assert not find_bubbles(light, light, share=0.25).any()


def test_discs_about_dark_pixels_are_those_of_a_dilation():
    """OpenCV's dilation of the dark pixels, where blocks, discs and the edges meet."""
    rng = np.random.default_rng(4)
    light = np.where(rng.random((70, 90)) < 0.02, 20, 1000).astype(np.float32)
    light[-1, -1] = light[0, 40] = 20
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (7, 7))
    expected = cv2.dilate((light < 500).astype(np.uint8), disc)
    assert np.array_equal(find_bubbles(light, light, share=0.25), expected.astype(bool))
