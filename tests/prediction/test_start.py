"""The start film of the least squares, for films known as functions of it."""

import numpy as np
import pytest

from erlif.core.errors import ModelError
from erlif.prediction import find_start_film

AGE = np.linspace(0.0, 3.0, 12)
CLEARANCE = 230e-6


def sinking(start):
    """A film h with h^-2 = h0^-2 + a t, that of a flat plate under load. [m]"""
    return 1e-6 / np.sqrt((1e-6 / start) ** 2 + 0.02 * AGE)


@pytest.mark.parametrize("start", [0.8e-6, 5e-6, 40e-6])
def test_the_start_film_of_exact_films_is_found(start):
    trials = []

    def predict(film):
        trials.append(film)
        return sinking(film)

    found = find_start_film(predict, sinking(start), np.full(12, 1e-8), clearance=CLEARANCE)
    assert found == pytest.approx(start, rel=2e-3)
    assert len(trials) <= 8


def test_a_search_from_a_rough_film_needs_few_exact_ones():
    """The rough film is 3 % off, and falls by another law."""
    trials = []

    def predict(film):
        trials.append(film)
        return sinking(film)

    def rough(start):
        return 1.03 * sinking(start) * (1 + 0.002 * AGE)

    for begin, most in ((None, 8), (rough, 3)):
        trials.clear()
        measured, std = sinking(5e-6), np.full(12, 1e-8)
        found = find_start_film(predict, measured, std, clearance=CLEARANCE, rough=begin)
        assert found == pytest.approx(5e-6, rel=2e-3)
        assert len(trials) <= most


def test_noise_of_the_films_averages_out():
    """Twelve films with 1 % of noise: about 0.01 / sqrt(12), more as later films forget it."""
    rng, starts = np.random.default_rng(5), []
    for _ in range(40):
        measured = sinking(3e-6) * (1 + 0.01 * rng.standard_normal(12))
        found = find_start_film(sinking, measured, 0.01 * measured, clearance=CLEARANCE)
        starts.append(found)
    assert np.mean(starts) == pytest.approx(3e-6, rel=3e-3)
    assert 0.0025 < np.std(starts) / 3e-6 < 0.007


def test_films_that_forget_their_start_end_the_search():
    trials = []

    def forgetful(start):
        trials.append(start)
        return np.full(12, 17e-6)

    find_start_film(forgetful, np.full(12, 16e-6), np.full(12, 1e-7), clearance=CLEARANCE)
    assert len(trials) == 2


def test_films_that_were_not_measured_are_left_out():
    measured = sinking(5e-6)
    measured[[2, 7]] = np.nan
    found = find_start_film(sinking, measured, np.full(12, 1e-8), clearance=CLEARANCE)
    assert found == pytest.approx(5e-6, rel=2e-3)
    with pytest.raises(ModelError, match="no trigger has one"):
        find_start_film(sinking, measured * np.nan, np.full(12, 1e-8), clearance=CLEARANCE)
