"""Pages added one at a time, against numpy over all of them."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.correction import PageStack

RNG = np.random.default_rng(20)
PAGES = RNG.normal(1000, 30, (7, 5, 6))


def add_all(pages, scales):
    stack = PageStack(pages[0])
    for page, scale in zip(pages, scales, strict=True):
        stack.add(page, scale=scale)
    return stack


@pytest.mark.parametrize("scales", [[1.0] * 7, [1.0, 0.9, 1.1, 1.02, 0.97, 1.0, 1.3]])
def test_mean_and_variance_are_those_of_the_scaled_pages(scales):
    stack = add_all(PAGES, scales)
    brought = PAGES * np.array(scales)[:, None, None]
    assert stack.count == 7
    npt.assert_allclose(stack.mean, brought.mean(axis=0), rtol=1e-13)
    npt.assert_allclose(stack.variance, brought.var(axis=0, ddof=1), rtol=1e-10)
    assert stack.scales == scales


def test_a_small_variance_on_a_bright_page_is_not_lost():
    """A variance of 1e-6 on counts of 1e6: sums of squared counts would have no digit left."""
    pages = 1e6 + 1e-3 * RNG.standard_normal((8, 5, 6))
    npt.assert_allclose(add_all(pages, [1.0] * 8).variance, pages.var(axis=0, ddof=1), rtol=1e-6)
