"""Steep light is found by its relative rise, whatever its direction, level and texture."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.plain import block_light

from erlif import registration

Y, X = np.indices((96, 128), dtype=np.float64)
LIMIT = 0.04  # relative rise above which light counts as steep [1/px]


def is_steep(signal, **limit):
    """The pixels of an image that lie in steep blocks of it."""
    return registration.is_steep(block_light(np.nan_to_num(signal)), signal.shape, **limit)


def light(rise_x=0.0, rise_y=0.0, level=3000.0):
    """Light that rises everywhere by the same part of itself; the logarithm is a plane."""
    return (level * np.exp(rise_x * (X - 64) + rise_y * (Y - 48))).astype(np.float32)


@pytest.mark.parametrize("direction", [(1, 0), (-1, 0), (0, 1), (0, -1), (0.6, 0.8), (-0.8, 0.6)])
def test_the_rise_counts_in_every_direction(direction):
    dx, dy = direction
    assert is_steep(light(1.15 * LIMIT * dx, 1.15 * LIMIT * dy))[16:-16, 16:-16].all()
    assert not is_steep(light(0.85 * LIMIT * dx, 0.85 * LIMIT * dy)).any()


def test_the_limit_is_the_callers():
    assert is_steep(light(0.03), limit=0.025)[16:-16, 16:-16].all()
    assert not is_steep(light(0.03), limit=0.035).any()


@pytest.mark.parametrize("level", [50.0, 3000.0, 60000.0])
def test_brightness_does_not_matter(level):
    npt.assert_array_equal(is_steep(light(0.06, level=level)), is_steep(light(0.06)))


def test_even_light_is_nowhere_steep():
    assert not is_steep(light()).any()
    assert not is_steep(np.zeros((96, 128), np.float32)).any()


def test_only_the_steep_part_of_a_frame_is_marked():
    """Exponential up to the middle, even beyond; the median of three blocks blurs the border."""
    steep = is_steep((3000 * np.exp(0.08 * (np.minimum(X, 64) - 64))).astype(np.float32))
    assert steep[:, 16:48].all()
    assert not steep[:, 80:].any()


def test_a_single_scratch_or_speck_is_not_the_film():
    scratched = light()
    scratched[:, 60:63] *= 0.2
    scratched[30:36, 20:26] *= 8
    assert not is_steep(scratched).any()


def test_fine_texture_is_not_steep():
    rng = np.random.default_rng(1)
    speckled = light() * (1 + 0.2 * rng.standard_normal(X.shape)).astype(np.float32)
    assert not is_steep(speckled).any()


def test_whole_blocks_of_eight_pixels_are_marked():
    steep = is_steep((3000 * np.exp(0.08 * (np.minimum(X, 70) - 64))).astype(np.float32))
    blocks = steep.reshape(12, 8, 16, 8)
    npt.assert_array_equal(blocks.all((1, 3)), blocks.any((1, 3)))
    assert steep.any()
    assert not steep.all()


@pytest.mark.parametrize("shape", [(61, 83), (64, 80), (33, 40)])
def test_the_mask_has_the_shape_of_the_frame(shape):
    steep = is_steep(light(0.06)[: shape[0], : shape[1]])
    assert steep.shape == shape
    assert steep.dtype == bool


def test_light_below_a_thousandth_of_a_count_is_dark_and_not_steep():
    """The logarithm ends at 0.001 counts: noise about zero has no steepness."""
    assert not is_steep(light(0.06, level=1e-6)).any()
    assert is_steep(light(0.06, level=1.0)).any()


def test_the_thin_edge_of_a_film_is_steep_and_its_speckle_is_not():
    """A film that rises from 0.05 um at the left edge, with speckle of 10 %."""
    rng = np.random.default_rng(7)
    film = 0.05 + 0.06 * np.arange(160)
    light = 10000 * (1 - np.exp(-0.4 * film)) * (1 + 0.1 * rng.standard_normal((120, 160)))
    steep = is_steep(light.astype(np.float32))
    slope = 0.4 * 0.06 / np.expm1(0.4 * film)  # of the logarithm of 1 - exp(-0.4 film)
    assert steep[:, slope > 0.08].all()
    assert not steep[:, slope < 0.02].any()
