"""Lines through light and ratio at equal film."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.trend import fit_trend


def draw(rng, *, cycles=4, triggers=10, places=6, slopes=(-2e-4, -5e-4), noise=1e-3):
    """Frames of several cycles whose films differ from trigger to trigger and place to place."""
    pulse = np.arange(cycles * triggers, dtype=float)
    group = np.arange(cycles * triggers) % triggers
    film = rng.normal(0, 0.3, (triggers, places))[group]
    common = noise * rng.standard_normal((2, pulse.size, 1))  # the places of a frame err together
    ratio = film + slopes[0] * pulse[:, None] + common[0]
    light = 5 + 2 * film + slopes[1] * pulse[:, None] + common[1]
    return pulse, group, ratio, light


def test_errors_of_the_slopes_have_their_standard_deviations():
    rng = np.random.default_rng(2)
    pulls = []
    for _ in range(100):
        pulse, group, ratio, light = draw(rng)
        ratio[rng.uniform(size=ratio.shape) < 0.1] = np.nan  # bubbles
        found = fit_trend(pulse, group, ratio, light)
        pulls.append(
            [(found.log_ratio + 2e-4) / found.log_ratio_std, (found.light + 5e-4) / found.light_std]
        )
    for limit, share in ((1, 0.667), (2, 0.945)):  # Student's t with 29 degrees of freedom
        inside = np.mean(np.abs(pulls) < limit)
        assert inside == pytest.approx(share, abs=3.5 * np.sqrt(share * (1 - share) / 200))


def test_one_cycle_has_no_equal_films():
    pulse, group, ratio, light = draw(np.random.default_rng(3), cycles=1, triggers=40)
    assert fit_trend(pulse, group, ratio, light) is None
    assert fit_trend(pulse, 0 * group, ratio[:, :1], light[:, :1]) is not None


def test_light_without_energies_is_left_out():
    pulse, group, ratio, light = draw(np.random.default_rng(4))
    found = fit_trend(pulse, group, ratio, np.full_like(light, np.nan))
    assert np.isnan(found.light)
    assert found.significant()


def test_a_place_that_is_seen_once_changes_nothing():
    pulse, group, ratio, light = draw(np.random.default_rng(5))
    before = fit_trend(pulse, group, ratio, light)
    once = np.full((pulse.size, 1), np.nan)
    once[3] = 40.0
    ratio, light = np.hstack([ratio, once]), np.hstack([light, once])
    after = fit_trend(pulse, group, ratio, light)
    npt.assert_allclose(after.log_ratio, before.log_ratio, rtol=0.1)
