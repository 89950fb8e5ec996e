"""Flats: pages sorted by light, saturation, and the response against a known pattern."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import FrameError
from erlif.correction import make_flat_field
from erlif.correction.flats import reduce_flats, sum_light

SHAPE = (50, 60)
DARK = np.full(SHAPE, 64.0)
EMPTY = np.zeros(4096, np.int64)


def page(light, above_dark=64):
    return np.full(SHAPE, light + above_dark, np.uint16)


def reduce(pages, *, dark=DARK, histogram=EMPTY):
    return reduce_flats(pages, dark=dark, histogram=histogram, camera="camera2")


@pytest.mark.parametrize(
    ("lights", "counts"),
    [
        ([1000, 1000, 1000], [3]),
        ([1000, 1049, 951], [3]),
        ([1000, 1051], [1, 1]),
        ([1000, 949], [1, 1]),
        ([1000, 1030, 1060], [2, 1]),  # the first page of a level is the reference
        ([1000, 2000, 1000], [1, 1, 1]),  # consecutive pages only
        ([500, 500, 1500, 1500, 1500], [2, 3]),
    ],
)
def test_consecutive_pages_within_5_percent_are_one_level(lights, counts):
    stacks, _ = reduce([page(light) for light in lights])
    assert [stack.count for stack in stacks] == counts


def test_pages_are_scaled_to_the_first_of_their_level():
    (stack,), _ = reduce([page(1000), page(1040), page(960)])
    npt.assert_allclose(stack.scales, [1, 1000 / 1040, 1000 / 960])
    # single precision rounds 1000 DN by 6e-5 DN, the noise of a camera is above 0.3 DN
    npt.assert_allclose(stack.mean, 1000, rtol=6e-8)
    npt.assert_allclose(stack.variance, 0, atol=6e-5**2)


@pytest.mark.parametrize(("saturated", "kept"), [(0, 1), (3, 1), (4, 0)])
def test_a_page_with_more_than_a_thousandth_of_saturated_pixels_is_left_out(saturated, kept):
    bright = page(1000)  # 3000 pixels
    bright.flat[:saturated] = 4095
    assert len(reduce([page(2000), bright])[0]) == 1 + kept


def test_pages_that_saturate_below_full_scale_are_left_out_and_show_the_count():
    rng = np.random.default_rng(1)
    piled = (np.minimum(rng.normal(3300, 150, SHAPE).round(), 3300) for _ in range(2))
    stacks, saturation = reduce([page(1000), *(image.astype(np.uint16) for image in piled)])
    assert saturation == 3300
    assert [stack.count for stack in stacks] == [1]


@pytest.mark.parametrize("light", [-3, 0, 40, 81])
def test_flats_below_a_fiftieth_of_full_scale_are_refused(light):
    with pytest.raises(FrameError, match="flats of camera2 well above dark and below saturation"):
        reduce([page(light)])


@pytest.mark.parametrize(
    ("light", "cause"), [(-3, "3 counts darker than the darks"), (0, "as dark as the darks")]
)
def test_flats_that_are_no_flats_are_named(light, cause):
    with pytest.raises(FrameError, match=cause):
        reduce([page(light), page(light)])


@pytest.mark.parametrize("first", [0, -3])
def test_a_page_without_light_is_left_out(first):
    (stack,), _ = reduce([page(first), page(1000), page(1000)])
    npt.assert_array_equal(stack.mean, 1000)


def field(total, *, pages=1, dark_var=0.0, bad=None, gain=4.0, page_var=0.0):
    bad, dark = np.zeros(total.shape, bool) if bad is None else bad, np.full(total.shape, dark_var)
    return make_flat_field(total, pages, dark_var=dark, bad=bad, gain=gain, page_var=page_var)


def test_variance_of_the_response_has_a_closed_form():
    """Shot noise total/gain, reading of n pages, and n times the dark: its error is one for all."""
    total = np.linspace(2000.0, 6000.0, 60) * np.ones(SHAPE)
    found = field(total, pages=5, dark_var=0.3, gain=4.4, page_var=2.5)
    expected = (total / 4.4 + 5 * 2.5 + 25 * 0.3) / 4000**2
    npt.assert_allclose(found.response_var, expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("share", "dead"),
    [(0.0, True), (0.49, True), (0.51, False), (1.49, False), (1.51, True), (-1, True)],
)
def test_a_pixel_far_off_its_surroundings_is_dead_and_takes_their_response(share, dead):
    total = 1000 * np.linspace(0.9, 1.1, 60) * np.ones(SHAPE)
    around = total[20, 30]
    total[20, 30] = share * around
    found = field(total)
    assert found.dead[20, 30] == dead
    assert found.dead.sum() == int(dead)
    own = around if dead else share * around
    npt.assert_allclose(found.response[20, 30], own / total.mean(), rtol=1e-6)


@pytest.mark.parametrize(("share", "dead"), [(0.015, True), (0.025, False)])
def test_a_dark_patch_is_dead_below_a_fiftieth_of_the_mean(share, dead):
    """Its pixels resemble their surroundings; only the mean shows that they are dead."""
    total = np.full(SHAPE, 1000.0)
    total[10:22, 10:22] = share * 950
    found = field(total)
    assert found.dead[12:20, 12:20].all() == dead
    assert found.dead[12:20, 12:20].any() == dead
    # a division by the response stays finite
    assert (found.response >= 0.02).all()


def test_a_bad_pixel_takes_the_response_of_its_surroundings_and_is_not_called_dead():
    total = np.full(SHAPE, 1000.0)
    total[20, 30] = 1400.0
    bad = total > 1000
    found = field(total, bad=bad)
    assert not found.dead.any()
    npt.assert_allclose(found.response, 1.0)  # the mean is that of the good pixels


def test_error_bars_of_the_response_cover_the_truth(simulated, check_coverage):
    """Three levels of eight pages of a camera with a pattern of 1 %, under a lamp that flickers."""
    rng = np.random.default_rng(3)
    camera = simulated()
    pages = camera.flats((3000, 7000, 12000), 8, rng)
    darks = np.mean(camera.darks(16, rng), axis=0)
    levels, _ = reduce(pages, dark=darks)
    noise = camera.temporal_var
    total, known = sum_light(levels), {"gain": camera.gain, "page_var": noise}
    found = field(total, pages=24, dark_var=noise / 16, **known)
    truth = camera.response / camera.response.mean()
    pulls = (found.response - truth) / np.sqrt(found.response_var)
    # 5760 pixels: 3.5 binomial standard deviations are 2.1 % at one sigma, 1 % at two
    check_coverage(pulls)
    assert abs(pulls.mean()) < 4 / np.sqrt(pulls.size)
