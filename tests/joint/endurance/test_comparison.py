"""Two designs against each other."""

import numpy as np
import pytest
import scipy.stats

from erlif.core.errors import EnduranceError
from erlif.joint.endurance import FailureLoad, compare_designs, describe_designs


def exact(load):
    return FailureLoad(load, 0.0, load, True, 1)


def survivor(load):
    return FailureLoad(load, 0.0, load, False, 1)


def staged(strength, last=36.0):
    """A bearing tested in stages of 8, 12, 16, ... up to the last one."""
    stages = np.arange(8.0, last + 1, 4.0)
    place = int(np.searchsorted(stages, strength))
    if place == stages.size:
        return survivor(last)
    return FailureLoad(stages[place], 0.0, stages[place] - 4 if place else 0.0, True, place + 1)


@pytest.mark.parametrize("runs", [3, 5])
def test_exact_loads_give_the_interval_of_student(runs):
    """Two normal samples of one variance: the posterior is the classical pivot."""
    rng = np.random.default_rng(runs)
    one, two = rng.normal(3.2, 0.1, runs), rng.normal(3.4, 0.1, runs)
    expected = np.exp(scipy.stats.ttest_ind(two, one).confidence_interval())
    found = compare_designs([exact(x) for x in np.exp(one)], [exact(x) for x in np.exp(two)])
    np.testing.assert_allclose([found.low, found.high], expected, rtol=0.01)
    assert found.ratio == pytest.approx(np.exp(two.mean() - one.mean()), rel=0.005)


@pytest.mark.parametrize("model", ["lognormal", "weibull"])
def test_interval_holds_the_ratio_with_few_runs_in_stages_some_of_which_survive(model):
    rng = np.random.default_rng(4)
    held = []
    for _ in range(20):
        normal = rng.standard_normal(6)
        extreme = np.log(rng.exponential(size=6) / np.log(2))
        deviate = normal if model == "lognormal" else extreme
        strength = np.exp(0.12 * deviate) * np.repeat([22.0, 29.0], 3)
        runs = [staged(one) for one in strength]
        found = compare_designs(runs[:3], runs[3:], model=model)
        if np.isfinite(found.ratio):
            held.append(found.low < 29 / 22 < found.high)
    assert len(held) > 15
    assert np.mean(held) > 0.8  # 0.95 less three standard errors


def test_runs_that_are_not_decided_are_counted_and_their_failure_is_compared():
    """As failures at 24 they are the same data as failures that were seen there."""
    one = [exact(x) for x in (20.0, 22.0, 25.0)]
    seen = [FailureLoad(30.0, 0.0, 26.0, True, 3), FailureLoad(24.0, 0.0, 20.0, True, 2)]
    open_run = FailureLoad(20.0, 0.0, 20.0, False, 1, decided=False, next_load=24.0)
    found = compare_designs(one, [seen[0], open_run])
    expected = compare_designs(one, seen)
    assert found.undecided == (0, 1)
    assert found.if_failed == pytest.approx((expected.low, expected.ratio, expected.high))
    assert found.ratio > expected.ratio
    text = "\n".join(describe_designs(found))
    assert "1 run not decided" in text
    assert f"the ratio is {expected.ratio:.2f}" in text
    assert np.isnan(expected.if_failed[1])


def test_designs_alike_are_not_separated():
    found = compare_designs([exact(x) for x in (20, 25, 30)], [exact(x) for x in (20, 25, 30)])
    assert found.low < 1 < found.high
    assert (found.ratio, found.probability) == pytest.approx((1.0, 0.5), abs=1e-6)
    assert found.log_rank == 1.0


def test_log_rank_by_permutation_of_two_samples_without_overlap():
    """Of 20 ways to choose three of six runs, two are as extreme."""
    found = compare_designs([exact(x) for x in (20, 21, 22)], [exact(x) for x in (30, 31, 32)])
    assert found.log_rank == pytest.approx(0.1)
    assert found.least_p == pytest.approx(0.1)


def test_one_run_is_refused():
    with pytest.raises(EnduranceError, match="at least two runs"):
        compare_designs([exact(20)], [exact(20)] * 2)


def test_failure_at_a_load_carried_before_is_a_failure_at_this_load():
    """Bolts relax: 36 kN in the stage before, 35.9 kN at the onset."""
    one, two = [exact(x) for x in (20, 22, 25)], [exact(x) for x in (30, 33)]
    relaxed = FailureLoad(35.9, 0.0, 36.0, True, 4)
    assert compare_designs(one, [*two, relaxed]) == compare_designs(one, [*two, exact(35.9)])


def test_no_p_value_by_permutation_is_zero():
    """Of 15 and 15 runs without overlap 2 of 155,117,520 divisions are as extreme."""
    one, two = ([exact(first + k / 10) for k in range(15)] for first in (20, 30))
    assert 2 / 155_117_520 <= compare_designs(one, two).log_rank < 1e-3
