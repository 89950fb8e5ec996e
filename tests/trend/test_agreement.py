"""Film against theory and speed: factors, correlations and delays of films of known truth."""

import numpy as np
import numpy.testing as npt
import pytest
import scipy
from scenes.fixture import assert_covers

from erlif.models.mechanism import CrankRocker
from erlif.trend import correlate, film_factor, find_delay

ANGLE = np.linspace(0.0, 360.0, 50, endpoint=False)
SPEED = 2.5 * np.sin(np.radians(ANGLE)) * (1 + 0.2 * np.cos(np.radians(ANGLE))) + 1e-3
LATE = np.interp(ANGLE - 12.0, ANGLE, np.abs(SPEED), period=360.0)


def noisy(film, noise, rng):
    return film * (1 + noise * rng.normal(size=film.size))


def test_factor_is_the_median_of_fast_triggers_by_stroke():
    """Slow triggers have no ratio."""
    fast, stroke = np.abs(SPEED) > 0.25, np.sign(SPEED)
    ratio = np.where(fast, np.where(stroke > 0, 2.0, 4.0), np.nan)
    found = film_factor(ratio, 0.03 * ratio, 0.05 * ratio, stroke=stroke)
    assert (found.low, found.high, found.outward, found.back) == (2, 4, 2, 4)
    shared = np.median(0.04 * ratio[fast])
    npt.assert_allclose([found.std_shared, found.std], [shared, np.hypot(found.std_random, shared)])
    assert np.isnan(film_factor(ratio * np.nan, ratio, ratio)).all()


def test_random_error_of_a_factor_is_its_scatter():
    rng, ones = np.random.default_rng(1), np.ones(50)
    found = [film_factor(noisy(5.0 * ones, 0.02, rng), 0.1 * ones, 0.1 * ones) for _ in range(200)]
    assert_covers([(one.value - 5.0) / one.std for one in found])


@pytest.mark.parametrize("noise", [0.003, 0.1])
@pytest.mark.parametrize(
    "film",
    [
        3.0 * np.abs(SPEED) ** 0.6 + 0.3,
        2.0 + LATE,
        4.0 + 0.5 * np.sin(np.radians(2 * ANGLE + 70.0)) + 0.2 * np.abs(SPEED),
    ],
    ids=["power", "late", "other"],
)
def test_the_interval_holds_the_correlation_of_the_true_film(film, noise):
    rng, x = np.random.default_rng(2), np.log(np.abs(SPEED))
    true = np.corrcoef(x, np.log(film))[0, 1]
    inside = []
    for _ in range(300):
        one = noisy(film, noise, rng)
        found = correlate(one, noise * one, SPEED)
        inside.append(found.log_low <= true <= found.log_high)
    assert found.log == pytest.approx(np.corrcoef(x, np.log(one))[0, 1])
    assert found.rank == pytest.approx(scipy.stats.spearmanr(np.abs(SPEED), one).statistic)
    assert np.mean(inside) > 0.95 - 3 * np.sqrt(0.95 * 0.05 / 300)


def test_a_constant_film_has_no_correlation():
    rng, flat = np.random.default_rng(3), np.full(50, 5.0)
    found = [correlate(noisy(flat, 0.01, rng), 0.01 * flat, SPEED) for _ in range(100)]
    assert np.mean([one.log_low < 0 < one.log_high for one in found]) > 0.95
    assert np.mean([one.log_high - one.log_low for one in found]) > 1.5
    assert np.isnan(correlate(flat, 0.01 * flat, np.full(50, 2.0))).all()
    assert correlate(flat, 0 * flat, SPEED)[1:] == (0.0, -1.0, 1.0)


@pytest.mark.parametrize("delay", [-20.0, 0.0, 12.0, 35.0])
def test_the_delay_of_a_film_comes_back_whatever_its_trend(delay):
    """Film of the shifted speed, which sinks by 1 um over the cycle, with 1 % of noise."""
    rng, fine = np.random.default_rng(4), np.linspace(0.0, 360.0, 3600, endpoint=False)
    speed = np.abs(2.5 * np.sin(np.radians(fine)) * (1 + 0.2 * np.cos(np.radians(fine))) + 1e-3)
    film = 4.0 + np.interp(ANGLE - delay, fine, speed, period=360.0) - np.arange(50) / 50
    found = np.array([find_delay(noisy(film, 0.01, rng), SPEED, ANGLE) for _ in range(60)])
    assert abs(found[:, 0].mean() - delay) < 0.3
    scatter = found[:, 0].std(ddof=1)
    npt.assert_allclose(found[:, 1].mean(), scatter, rtol=0.4, atol=0.2)


@pytest.mark.parametrize(("gap", "alike"), [(64.0, 0.0), (10.0, 0.8)])
def test_the_error_of_a_delay_holds_across_a_gap_and_where_neighbours_are_alike(gap, alike):
    """A film 20 degrees behind the speed of a crank-rocker; the gap begins anywhere."""
    rng, pulls = np.random.default_rng(6), []
    rig = CrankRocker(0.055, 0.44, 0.26, 0.51)
    for _ in range(300):
        angle = np.sort((rng.uniform(0, 360) + np.linspace(0, 360 - gap, 50)) % 360)
        speed, late = (
            np.asarray(rig.rocker_speed(np.radians(at), crank_speed=10.0))
            for at in (angle, angle - 20.0)
        )
        scatter = scipy.signal.lfilter([np.sqrt(1 - alike**2)], [1, -alike], rng.normal(size=150))
        delay, std = find_delay(3.0 + np.abs(late) + 0.1 * scatter[-50:], speed, angle)
        pulls.append((delay - 20.0) / std)
    assert np.isfinite(pulls).all()
    assert 0.85 < np.sqrt(np.mean(np.square(pulls))) < 1.3
    assert np.mean(np.abs(pulls) < 2) > 0.9


def test_a_cycle_with_a_wide_gap_has_the_delay_of_a_whole_one():
    """Without noise: what is left is the course of the speed between the ends of the gap."""
    rig = CrankRocker(0.055, 0.44, 0.26, 0.51)
    for start in range(0, 360, 20):
        angle = np.sort((start + np.linspace(0, 360 - 64, 50)) % 360)
        speed, late = (
            np.asarray(rig.rocker_speed(np.radians(at), crank_speed=10.0))
            for at in (angle, angle - 20.0)
        )
        delay, std = find_delay(3.0 + np.abs(late), speed, angle)
        assert abs(delay - 20.0) < 2 * std < 0.2


def test_films_that_do_not_follow_the_speed_have_no_delay():
    rng = np.random.default_rng(5)
    for film in (np.full(50, 5.0), np.linspace(6.0, 5.0, 50), 5.0 - 0.5 * np.abs(SPEED)):
        for _ in range(40):
            delay, _ = find_delay(noisy(film, 0.01, rng), SPEED, ANGLE)
            assert np.isnan(delay)
    half = ANGLE < 180.0
    assert np.isnan(find_delay(LATE[half], SPEED[half], ANGLE[half])).all()


def test_films_that_scatter_apart_from_the_speed_are_not_correlated_with_it():
    """5 % of scatter, 0.3 % of it noise: an interval of 95 % leaves 0 out in 15 of 300."""
    rng, speed = np.random.default_rng(16), np.linspace(0.3, 2.5, 24)
    apart = 0
    for _ in range(300):
        film = 3.0 * np.exp(0.05 * rng.standard_normal(24))
        found = correlate(film, 0.003 * film, rng.permutation(speed))
        apart += not found.log_low < 0 < found.log_high
    assert 4 <= apart <= 28  # three standard deviations of the binomial


def test_neighbours_that_are_alike_count_as_fewer_triggers():
    """Two smooth waves of other periods: no correlation is certain of five of their turns."""
    turn = np.arange(48) * 2 * np.pi / 48
    speed, film = 2.0 + np.sin(turn), 3.0 + 0.3 * np.sin(turn + 1.3)
    found = correlate(film, np.full(48, 0.01), speed)
    assert found.log > 0.2
    assert found.log_low < 0
