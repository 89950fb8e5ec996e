"""Order of the rows by a film that follows the speed, of logs whose order is known."""

import numpy as np
import pytest

from erlif.pipeline.audit.film_order import compare_film, find_other_films

COUNT = 50
TURN = 2 * np.pi * np.arange(COUNT) / COUNT
SPEED = np.abs(np.sin(TURN) + 0.12 * np.sin(2 * TURN))


def film(seed=1, lag=0):
    level = np.log1p(SPEED**0.6)
    return np.roll(level, lag) + 0.003 * np.random.default_rng(seed).normal(size=COUNT)


def film_of(level, seed=1):
    return level + 0.003 * np.random.default_rng(seed).normal(size=COUNT)


@pytest.mark.parametrize("lag", [-5, -1, 1, 5])
def test_a_late_log_is_found_by_the_film(lag):
    order = compare_film(SPEED, film(lag=-lag))
    assert (order.lag, order.since) == (lag, 0)


def test_pairs_in_reverse_order_are_found_by_the_film():
    """One stroke is faster than the other."""
    level = np.log1p(np.abs(np.sin(TURN) + 0.12 * np.sin(2 * TURN + 0.5)) ** 0.6)
    drive = np.abs(np.sin(TURN) + 0.12 * np.sin(2 * TURN + 0.5))
    assert compare_film(drive, film_of(level[::-1])).reverse
    assert compare_film(drive, film_of(level)) is None


def test_pairs_lost_in_the_middle_are_found_by_the_film():
    order = compare_film(SPEED[:-4], np.delete(film(), [20, 21, 22, 23]))
    assert (order.lag, order.since) == (4, 20)


@pytest.mark.parametrize("seed", range(10))
def test_a_film_of_its_own_speed_has_no_other_order(seed):
    assert compare_film(SPEED, film(seed)) is None
    assert find_other_films(SPEED, film(seed)).size == 0


@pytest.mark.parametrize("memory", [3, 5, 10, 20])
def test_a_film_that_squeeze_delays_has_no_other_order(memory):
    """It follows the speeds before, with an exponential memory of so many frames."""
    level = np.zeros(3 * COUNT)
    for k in range(1, level.size):
        level[k] = level[k - 1] + (SPEED[k % COUNT] - level[k - 1]) / memory
    assert compare_film(SPEED, level[-COUNT:]) is None


@pytest.mark.parametrize("memory", [3, 4, 6])
@pytest.mark.parametrize(("count", "strokes"), [(24, 2), (30, 2), (36, 4), (50, 4), (50, 2)])
def test_the_speed_of_equal_strokes_has_no_other_order(count, strokes, memory):
    """Half a turn later it is the same, and a delay of the film looks like rows that are later."""
    for start in np.arange(0, count / strokes, 2.3):
        speed = np.abs(np.sin(np.pi * strokes * (np.arange(count) + start) / count))
        level = np.zeros(4 * count)
        for k in range(1, level.size):
            level[k] = level[k - 1] + (speed[k % count] - level[k - 1]) / memory
        seen = level[-count:] + 0.003 * np.random.default_rng(1).normal(size=count)
        assert compare_film(speed, seen) is None


def test_a_film_of_another_speed_is_found():
    level = film()
    level[[12, 30]] = level[[25, 37]]
    found = find_other_films(SPEED, level).tolist()
    assert 12 in found
    assert set(found) <= {12, 30}


RAMP = np.linspace(0.4, 1.8, COUNT)


@pytest.mark.parametrize("load", [RAMP, RAMP[::-1], np.where(np.arange(COUNT) < 20, 1, 2.5)])
@pytest.mark.parametrize("seed", range(4))
def test_a_film_that_does_not_follow_the_load_of_its_log_has_no_other_order(load, seed):
    assert compare_film(SPEED / load, film(seed), size=SPEED) is None


def test_reverse_pairs_are_found_beside_a_load_that_scatters():
    """Two strokes that differ by little: the share that is left falls by a third alone."""
    load = 1 + 0.01 * np.random.default_rng(3).normal(size=COUNT)
    level = np.log1p(np.abs(np.sin(TURN) + 0.02 * np.sin(2 * TURN + 0.5)) ** 0.6)
    drive = np.abs(np.sin(TURN) + 0.02 * np.sin(2 * TURN + 0.5))
    assert compare_film(drive / load, film_of(level[::-1]), size=drive).reverse
