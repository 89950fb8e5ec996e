"""Error bars of calibrations and of their comparison, over many fixtures of the same wedge."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import (
    FILMS,
    PITCH,
    WEDGE,
    assert_covers,
    calibrate,
    calibrate_wedge,
    find_pulls,
    has_note,
    image,
    log_ratio,
    pulls_of_curve,
    share_within,
    through_filters,
    wedge_profile,
)
from scipy.ndimage import gaussian_filter1d
from scipy.stats import binom

from conftest import FULL
from erlif.calibration import Profile, compare_calibrations

pytestmark = pytest.mark.slow

COUNT = 100 if FULL else 40


@pytest.fixture(scope="module")
def photographed():
    """Fixtures with a noisy CMM, of 0.15 um; the first half photographed twice."""
    rng = np.random.default_rng(2)
    profiles = [wedge_profile(rng) for _ in range(COUNT)]
    first, second = (
        [calibrate_wedge(rng, profile=profile) for profile in chosen]
        for chosen in (profiles, profiles[: COUNT // 2])
    )
    return first, second


def test_uncertainties_of_parameters_and_films_cover(photographed):
    """68 and 95 % within one and two standard deviations: K, p, q, and films of 1, 3 and 8 um."""
    assert all(calibration.departure is None for calibration in photographed[0])
    noted = [
        has_note(each, text) for each in photographed[0] for text in ("structure", "correlated")
    ]
    assert not any(noted)
    pulls = [pulls_of_curve(calibration, FILMS) for calibration in photographed[0]]

    assert_covers(pulls)
    assert np.all(np.abs(np.mean(pulls, axis=0)) < 4 / np.sqrt(COUNT))


@pytest.mark.parametrize("shared", [False, True])
def test_false_alarms_are_as_rare_as_stated(photographed, shared):
    """Of pairs of unchanged fixtures, at most a few are significant by chance.

    Half of them have a probability below a half.
    """
    first, second = photographed
    count = COUNT // 2
    one, other = (second, first[:count]) if shared else (first[::2], first[1::2])
    found = [compare_calibrations(*pair) for pair in zip(one, other, strict=True)]
    assert len(found) == count
    by_chance = binom.ppf(0.999, count, 0.01)
    assert sum(each.significant for each in found) <= by_chance
    assert sum(each.drifted for each in found) <= by_chance
    below = sum(each.probability < 0.5 for each in found)
    assert abs(below - count / 2) < 3.3 * np.sqrt(count) / 2
    pulls = np.array([(each.difference / each.difference_std)[[10, 30, 50]] for each in found])
    npt.assert_allclose(pulls.std(axis=0), 1, atol=3.5 / np.sqrt(2 * count))


@pytest.mark.parametrize("reflectance", [0.0, 0.05, 0.1, 0.3, 0.6] if FULL else [0.3])
def test_films_before_a_wall_that_reflects_cover(reflectance):
    """Many fixtures each: ends of the range, and films of it within one and two errors.

    Measured with fifty each: 70 to 73 % and 93 to 97 %.
    """
    rng, true = np.random.default_rng(11), through_filters(reflectance)
    pulls, count = [], 50 if FULL else 10
    for _ in range(count):
        found = calibrate_wedge(rng, noise=0.1, true=true)
        low, high = found.thickness_range
        assert low < 0.5  # um
        assert true(high, 1) > 0  # before the maximum of the true ratio
        pulls.append(find_pulls(found, np.linspace(1.0, 0.95 * high, 5), true))

    # neighbouring films share their error: five count as two
    assert abs(share_within(pulls, 1).mean() - 0.683) < 3 * np.sqrt(0.683 * 0.317 / (2 * count))
    assert share_within(pulls, 2).mean() > 0.954 - 3 * np.sqrt(0.954 * 0.046 / (2 * count))


ONE_STEP = np.where(WEDGE < 9, WEDGE / 2, WEDGE)
STAIRS = np.array([0.5, 2.0, 4.0, 7.0, 11.0, 16.0])[np.arange(WEDGE.size) * 6 // WEDGE.size]


@pytest.mark.parametrize("film", [ONE_STEP, STAIRS], ids=["one step", "six plateaus"])
def test_films_of_a_fixture_with_steps_cover(film):
    """The lens spreads each step over two pixels; films between the plateaus are measured too."""
    rng, pulls = np.random.default_rng(6), []
    position = np.arange(0, PITCH * film.size, 0.1)
    readings = film[np.minimum(np.rint(position / PITCH).astype(int), film.size - 1)]
    light = gaussian_filter1d(np.exp(log_ratio(film)), 1.0, mode="nearest")
    count = 50 if FULL else 7
    for _ in range(count):
        profile = Profile(
            position, readings + rng.normal(0, 0.1, position.size), np.full(position.size, 0.1)
        )
        found = calibrate(image(rng, np.log(light)), profile)
        low, high = found.thickness_range
        assert low < 0.6
        assert high > 0.9 * film.max()
        pulls.append(find_pulls(found, np.linspace(max(low, 1.0), 0.95 * high, 5)))

    # five films of a fixture share their error: they count as two
    assert_covers(np.ravel(pulls), count=2 * count)
