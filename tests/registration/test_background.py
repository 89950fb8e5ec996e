"""The light that lamp, lens and film shape, taken out before two bands are compared."""

import math

import numpy as np
import numpy.testing as npt
import pytest
from scenes.plain import block_light
from scipy.interpolate import CubicSpline

from erlif import registration
from erlif.registration.background import _to_nodes, divide_by_light, local_light

Y, X = np.indices((120, 160), dtype=np.float64)


def test_texture_is_left_and_light_is_gone():
    rng = np.random.default_rng(1)
    texture = 1 + 0.05 * rng.standard_normal(X.shape)
    light = 3000 * (1 - np.exp(-0.02 * (X + 3))) * (1 - 1e-5 * (Y - 60) ** 2)
    found, weight = divide_by_light(light * texture, np.ones(X.shape))
    lit = weight > 0
    assert lit.mean() > 0.95
    slope, before = (np.polyfit(X[lit], im[lit], 1)[0] for im in (found, light / light.mean()))
    assert abs(slope) < 0.01 * before
    assert np.corrcoef(found[lit], texture[lit])[0, 1] > 0.99


def test_flagged_pixels_do_not_shape_the_light():
    light = 1000 + 2 * X
    spoilt = light.copy()
    spoilt[50:56, 70:76] = 1e5
    weight = np.ones_like(light)
    weight[50:56, 70:76] = 0
    npt.assert_allclose(local_light(spoilt, weight), light, rtol=2e-3)
    _, used = divide_by_light(spoilt.astype(np.float32), weight)
    assert not used[50:56, 70:76].any()


def test_the_window_is_a_gaussian_of_twelve_pixels():
    """A slow cubic is left by a quadratic fit as known from its third moment.

    About each place, x^3 projects onto x as 3 sigma^2 x, so the value there stays; and x^4 onto
    the constant as -3 sigma^4, for the quadratic takes 6 sigma^2 x^2 - 3 sigma^4 of it.
    """
    u = (X - 80) / 80
    for power, at_the_middle in ((3, 0.0), (4, -3 * (12 / 80) ** 4)):
        found = local_light(1000 * (1 + u**power), np.ones_like(u))[60, 80] / 1000 - 1
        npt.assert_allclose(found, at_the_middle, atol=2e-4)


def test_light_is_zero_where_nothing_near_counts_and_frames_may_have_parts_of_cells():
    weight = np.ones((53, 161))
    weight[:, 80:] = 0
    light = 500 + 2 * Y[:53, :1] + np.zeros(weight.shape)
    found = local_light(light, weight)
    assert (found.shape, found.dtype) == (weight.shape, np.float32)
    npt.assert_allclose(found[:-8, :76], light[:-8, :76], rtol=5e-3)
    npt.assert_allclose(found[:, 140:], 0, atol=1)  # the spline rings by a part in a thousand


def test_dark_parts_have_neither_texture_nor_weight():
    """Below a fiftieth of the brighter parts the light is too weak to divide by."""
    image = np.full(X.shape, 1000, np.float32)
    image[:, 100:] = 10
    texture, weight = divide_by_light(image, np.ones(X.shape, np.float32))
    npt.assert_array_equal(weight[:, 140:], 0)
    npt.assert_array_equal(texture[weight == 0], 1)
    image[:, 100:] = 50
    assert divide_by_light(image, np.ones(X.shape, np.float32))[1][:, 140:].all()


@pytest.mark.parametrize("size", [20, 24, 32, 100, 1280])
def test_light_between_the_cells_is_that_of_the_cubic_spline_of_scipy(size):
    """Cells of 8 px; from 25 px on there are enough of them for a spline."""
    cells = math.ceil(size / 8)
    nodes = 4 * np.arange(-1, math.ceil(size / 4) + 1) + 1.5
    expected = CubicSpline(8 * np.arange(cells) + 3.5, np.eye(cells))(nodes)
    npt.assert_allclose(_to_nodes(size), expected, atol=1e-12)


# steep light

LIMIT = 0.04  # relative rise above which light counts as steep [1/px]


def is_steep(signal):
    """The pixels of an image that lie in steep blocks of it."""
    return registration.is_steep(block_light(np.nan_to_num(signal)), signal.shape)


def light(rise_x=0.0, rise_y=0.0, level=3000.0):
    """Light that rises everywhere by the same part of itself; the logarithm is a plane."""
    return (level * np.exp(rise_x * (X - 80) + rise_y * (Y - 60))).astype(np.float32)


@pytest.mark.parametrize("direction", [(1, 0), (-1, 0), (0, 1), (0, -1), (0.6, 0.8), (-0.8, 0.6)])
def test_the_rise_counts_in_every_direction(direction):
    dx, dy = direction
    assert is_steep(light(1.15 * LIMIT * dx, 1.15 * LIMIT * dy))[16:-16, 16:-16].all()
    assert not is_steep(light(0.85 * LIMIT * dx, 0.85 * LIMIT * dy)).any()


def test_a_single_scratch_or_speck_is_not_the_film():
    scratched = light()
    scratched[:, 60:63] *= 0.2
    scratched[30:36, 20:26] *= 8
    assert not is_steep(scratched).any()


def test_light_below_a_thousandth_of_a_count_is_dark_and_not_steep():
    """The logarithm ends at 0.001 counts: noise about zero has no steepness."""
    assert not is_steep(light(0.06, level=1e-6)).any()
    assert is_steep(light(0.06, level=1.0)).any()


def test_blocks_that_are_not_known_are_no_slope_of_the_film():
    """One column of blocks, as of a scratch that the settings exclude."""
    blocks = np.full((12, 16), 1000, np.float32)
    blocks[:, 7] = np.nan
    assert not registration.is_steep(blocks, (96, 128)).any()


def test_the_thin_edge_of_a_film_is_steep_and_its_speckle_is_not():
    """A film that rises from 0.05 um at the left edge, with speckle of 10 %."""
    rng = np.random.default_rng(7)
    film = 0.05 + 0.06 * np.arange(160)
    light = 10000 * (1 - np.exp(-0.4 * film)) * (1 + 0.1 * rng.standard_normal((120, 160)))
    steep = is_steep(light.astype(np.float32))
    slope = 0.4 * 0.06 / np.expm1(0.4 * film)  # of the logarithm of 1 - exp(-0.4 film)
    assert steep[:, slope > 0.08].all()
    assert not steep[:, slope < 0.02].any()
