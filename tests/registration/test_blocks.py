"""Blocks matched between textures of known offset, and the affine field that most of them share."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.registration import Blobs

from erlif.registration.blocks import BLOCK, STRIDE, agree, match_blocks

SHAPE = (112, 144)


def noise(seed=0, shape=SHAPE):
    return np.random.default_rng(seed).standard_normal(shape).astype(np.float32)


def ones(shape=SHAPE):
    return np.ones(shape, np.float32)


def blobs(dx=0.0, dy=0.0):
    """An analytic texture whose features lie (dx, dy) further right and down."""
    field = Blobs(SHAPE, 2.0, np.random.default_rng(1))
    y, x = np.indices(SHAPE, dtype=float)
    return field(x - dx, y - dy).astype(np.float32)


def grid(columns=8, rows=6):
    """Centres of blocks about the middle of a frame."""
    x, y = np.meshgrid(np.arange(columns) * 16.0 - 56, np.arange(rows) * 16.0 - 40)
    return np.stack([x.ravel(), y.ravel()], axis=-1)


@pytest.mark.parametrize("offset", [(0, 0), (3, 0), (0, -2), (-4, 5)])
def test_a_whole_offset_is_found_by_every_block(offset):
    dx, dy = offset
    a = noise()
    b = np.roll(a, (dy, dx), (0, 1))
    found = match_blocks(a, b, ones(), 6)
    rows, cols = (SHAPE[0] - BLOCK) // STRIDE + 1, (SHAPE[1] - BLOCK) // STRIDE + 1
    assert len(found.centres) == rows * cols
    # white noise has a peak of one pixel; its neighbours pull the parabola by some hundredths
    npt.assert_allclose(found.vectors, np.tile(offset, (rows * cols, 1)), atol=0.1)


@pytest.mark.parametrize("offset", [(0.3, 0.0), (0.0, 0.3), (-1.4, 2.25)])
def test_a_parabola_finds_the_fraction_of_the_offset(offset):
    found = match_blocks(blobs(), blobs(*offset), ones(), 6)
    npt.assert_allclose(np.median(found.vectors, axis=0), offset, atol=0.06)


def test_blocks_that_camera_2_does_not_see_are_left_out():
    weight = ones()
    weight[:, 88:] = 0
    found = match_blocks(noise(), noise() * weight, weight, 3)
    assert found.centres[:, 0].max() == 79.5  # of the block from 80 to 111 a quarter is seen
    assert len(found.centres) == len(found.vectors) == len(found.strength)


def test_a_peak_on_the_rim_of_the_search_keeps_whole_pixels():
    found = match_blocks(blobs(), blobs(3.4, 0.2), ones(), 3)
    npt.assert_array_equal(found.vectors[:, 0], 3)


MATRIX = np.array([[0.02, -0.05], [0.04, 0.01]])
OFFSET = np.array([2.0, -3.0])


@pytest.mark.parametrize("wrong", [0, 10, 20])
def test_an_affine_field_is_found_and_wrong_blocks_change_the_part_that_agrees(wrong):
    centres = grid()
    vectors = centres @ MATRIX.T + OFFSET
    rng = np.random.default_rng(2)
    bad = rng.choice(len(centres), wrong, replace=False)
    angle = rng.uniform(0, 2 * np.pi, wrong)
    vectors[bad] += 8 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    found = agree(centres, vectors, np.ones(len(centres)))
    npt.assert_allclose(found.matrix, MATRIX, atol=1e-9)
    npt.assert_allclose(found.offset, OFFSET, atol=1e-9)
    assert found.part == (48 - wrong) / 48


def test_blocks_a_pixel_off_do_not_agree():
    centres = grid()
    vectors = np.zeros_like(centres)
    vectors[::8, 0] = 1.6
    vectors[3::8, 1] = 0.6
    found = agree(centres, vectors, np.ones(48))
    assert found.part == 42 / 48


def test_a_quarter_of_the_blocks_is_enough_if_they_are_the_strong_ones():
    centres = grid()
    rng = np.random.default_rng(4)
    vectors = rng.uniform(-6, 6, centres.shape)
    vectors[:12] = OFFSET
    strength = np.where(np.arange(48) < 12, 20.0, 2.0)
    found = agree(centres, vectors, strength)
    there = centres[:12] @ found.matrix.T + found.offset
    npt.assert_allclose(there, np.tile(OFFSET, (12, 1)), atol=1)
    assert 12 / 48 <= found.part < 0.5


@pytest.mark.parametrize(("slope", "part"), [(0.11, 1.0), (0.13, 0.0)])
def test_a_field_steeper_than_any_camera_mount_is_refused(slope, part):
    centres = grid()
    found = agree(centres, centres * slope, np.ones(48))
    npt.assert_allclose(found.part, part, atol=0.2 if part == 0 else 0)


@pytest.mark.parametrize("centres", [grid()[:0], grid()[8:11], grid()[:8]])
def test_three_blocks_and_blocks_in_a_line_determine_no_field(centres):
    found = agree(centres, np.ones(centres.shape), np.ones(len(centres)))
    assert found.part == 0
    npt.assert_array_equal(found.matrix, 0)
