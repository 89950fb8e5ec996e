"""The speed exponent: known power laws, coverage of its error bar, triggers left out."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import assert_covers

from erlif.trend import SLOWEST, fit_exponent, mean_at_constant_minimum

SPEED = np.linspace(0.3, 2.5, 40)
LOAD = np.full(40, 222.0)


@pytest.mark.parametrize("power", [0.40, 0.62, 1.0])
def test_power_law_comes_back_exactly(power):
    """Film c (|speed|/load)^n on both strokes, with a load that varies."""
    speed, load = SPEED * np.where(np.arange(40) % 2, 1, -1), LOAD * np.linspace(0.9, 1.1, 40)
    film = 7.0 * (np.abs(speed) / load) ** power
    found = fit_exponent(film, 0.01 * film, speed=speed, load=load)
    npt.assert_allclose([found.value, np.exp(found.log_scale)], [power, 7.0], rtol=1e-9)
    assert found.triggers == 40


def test_std_is_that_of_a_weighted_line():
    """sigma/sqrt(sum (x - mean)^2) for equal relative errors: the closed form of a straight line.

    Films on the line leave no scatter beyond the error bars.
    """
    film = 5.0 * (SPEED / LOAD) ** 0.6
    found = fit_exponent(film, 0.02 * film, speed=SPEED, load=LOAD)
    x = np.log(SPEED / LOAD)
    npt.assert_allclose(found.std, 0.02 / np.sqrt(((x - x.mean()) ** 2).sum()), rtol=1e-6)


@pytest.mark.parametrize("power", [0.40, 1.0])
def test_error_bar_covers_the_exponent(power):
    """300 noisy power laws: 68.3 and 95.4 % of them within one and two standard deviations."""
    rng = np.random.default_rng(7)
    angle = np.linspace(0, 2 * np.pi, 50, endpoint=False)
    speed, load = 2.54 * np.sin(angle), 222 * (1 + 0.01 * np.cos(angle))
    pulls = []
    for _ in range(300):
        film = 6 * (np.abs(speed) / 2.54 * 222 / load) ** power
        std = 0.01 + 0.02 * film
        found = fit_exponent(film + std * rng.standard_normal(50), std, speed=speed, load=load)
        pulls.append((found.value - power) / found.std)
    assert_covers(pulls)


def test_understated_error_bars_are_widened_by_the_scatter():
    """A scatter of 5 % about error bars of 0.1 nm."""
    rng = np.random.default_rng(8)
    pulls = []
    for _ in range(200):
        film = 5 * SPEED**0.6 * np.exp(0.05 * rng.standard_normal(40))
        found = fit_exponent(film, np.full(40, 1e-4), speed=SPEED, load=LOAD)
        pulls.append((found.value - 0.6) / found.std)
    assert 0.85 < np.std(pulls) < 1.15  # 200 draws give it to 5 %


def test_error_common_to_all_triggers_adds_its_share():
    """Films that share an error proportional to ln(speed) times the film tilt the line by it."""
    film = 5 * (SPEED / LOAD) ** 0.6
    shared = (film * np.log(SPEED / LOAD))[:, None]  # d film / d n of the power law itself
    alone = fit_exponent(film, 0.01 * film, speed=SPEED, load=LOAD)
    found = fit_exponent(
        film, 0.01 * film, speed=SPEED, load=LOAD, gradient=shared, covariance=np.array([[0.04**2]])
    )
    assert found.value == alone.value
    npt.assert_allclose(found.std, np.hypot(alone.std, 0.04), rtol=1e-6)


def test_slow_triggers_are_left_out():
    """The last two are slower than a tenth of the fastest."""
    speed = np.array([2.5, 2.0, 1.5, 1.0, 0.6, 0.3, 0.2, 0.1])
    assert SLOWEST == 0.1
    film = speed**0.5
    film[-2:] = 100.0
    found = fit_exponent(film, np.full(8, 0.01), speed=speed, load=np.ones(8))
    npt.assert_allclose(found.value, 0.5, atol=1e-6)
    assert found.triggers == 6


@pytest.mark.parametrize("film_3", [np.nan, -0.1, 0.0, np.inf])
def test_films_without_logarithm_are_left_out(film_3):
    film = 5 * SPEED**0.6
    film[3] = film_3
    found = fit_exponent(film, np.full(40, 0.01), speed=SPEED, load=LOAD)
    npt.assert_allclose(found.value, 0.6, atol=1e-6)
    assert found.triggers == 39


@pytest.mark.parametrize(("swing", "fitted"), [(0.02, False), (0.2, True)])
def test_a_steady_speed_over_load_and_four_triggers_have_no_exponent(swing, fitted):
    """A disc at constant speed: a load that varies by 4 % determines no power."""
    load = 20.0 * (1 + swing * np.sin(np.arange(12)))
    film = 2.0 * (0.1 / load) ** 0.6
    found = fit_exponent(film, np.full(12, 0.01), speed=np.full(12, 0.1), load=load)
    assert np.isfinite(found.value) == fitted
    assert found.triggers == 12
    few = np.where(np.arange(40) < 36, np.nan, 5 * SPEED**0.6)
    found = fit_exponent(few, np.full(40, 0.01), speed=SPEED, load=LOAD)
    assert np.isnan([found.value, found.std, found.log_scale]).all()
    assert found.triggers == 4


def test_the_mean_at_a_constant_minimum_is_that_of_a_parabola():
    """Over a width w with the minimum a beside the middle: h + (w^2/12 + a^2)/(2 R), R = 4.872 m.

    The region is 10 mm wide, 10 mm is 0.3 rad: a circle deviates from its parabola by 1 %.
    """
    radius, clearance = np.sqrt(33.36 * 33.59), 230.0
    angle = np.linspace(-5, 5, 401) / radius
    beside, minimum = np.linspace(-5, 5, 11), np.linspace(4, 8, 11)
    e = clearance - minimum
    place = np.stack([e * np.cos(beside / radius), e * np.sin(beside / radius)], axis=1)
    found = mean_at_constant_minimum(place, clearance, angle)
    npt.assert_allclose(found - 6.0, (100 / 12 + beside**2) / (2 * 4.872), rtol=0.03)


def test_without_a_displacement_there_is_no_mean_and_no_warning():
    found = mean_at_constant_minimum(np.full((5, 2), np.nan), 230.0, np.linspace(-0.1, 0.1, 21))
    assert np.isnan(found).all()
