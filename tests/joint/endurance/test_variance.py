"""The variance of a stage as the other stages know it."""

import numpy as np
import pytest

from erlif.joint.endurance.variance import UNKNOWN, Spread, combine_spreads, pool_spreads


@pytest.mark.parametrize("freedom", [4.0, 20.0])
def test_variances_of_a_known_scatter_give_its_degrees_of_freedom(freedom):
    """Variances drawn as 2e-4 over chi-square by its degrees of freedom: the prior of Smyth."""
    rng = np.random.default_rng(3)
    true = 2e-4 * freedom / rng.chisquare(freedom, 2000)
    seen = [Spread(one * rng.chisquare(50) / 50, 50) for one in true]
    pooled = combine_spreads(seen)
    assert pooled.freedom == pytest.approx(freedom, rel=0.1)
    assert pooled.variance == pytest.approx(2e-4, rel=0.05)


def test_stages_that_are_alike_are_worth_their_samples():
    rng = np.random.default_rng(4)
    seen = [Spread(rng.chisquare(80) / 80, 80) for _ in range(1000)]
    assert combine_spreads(seen).freedom > 500


def test_one_other_stage_does_not_show_how_unlike_stages_are():
    assert pool_spreads([Spread(1.0, 50), Spread(2.0, 50)]) == [UNKNOWN, UNKNOWN]
