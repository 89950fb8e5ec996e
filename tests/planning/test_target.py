"""The shortest list of remedies: closed forms of single terms, and targets that nothing reaches."""

import numpy as np
import numpy.testing as npt
import pytest
import scipy

from erlif.calibration import Reabsorption, Systematics
from erlif.core.errors import ConfigError
from erlif.planning.target import (
    FILMS,
    NINE_OF_TEN,
    FilmErrors,
    information_of,
    read_target,
    shortest_list,
)

MODEL = Reabsorption(np.array([0.65, 0.4, 0.25]))
MEDIAN, PATCH = 4.0, 6.0
SHARES = {"energy": 0.05, "course": 0.07}


def slope_at(films):
    """By differences of the curve."""
    step = 1e-5
    return (MODEL.predict(films + step) - MODEL.predict(films - step)) / (2 * step)


def errors_of(noise=0.0, patch_std=0.02, **widths):
    films = np.array([*FILMS, MEDIAN, PATCH])
    systematics, slope = Systematics.of(widths, parameters=0), slope_at(films)
    acts = systematics.gradient(films, MODEL, slope, 0 * films, passed=np.array([0.5]))
    covariance = systematics.anywhere(systematics.covariance)
    return FilmErrors(
        films, acts, slope, systematics, covariance, None, SHARES, frozenset(), noise, patch_std
    )


def test_targets_are_shares_or_lengths():
    npt.assert_allclose([read_target("2.5 %"), read_target("0.1 um")], [[0.025, 0], [0, 0.1]])


@pytest.mark.parametrize("text", ["1 kg", "1", "0 %", "-5 nm", "one per cent"])
def test_other_targets_are_refused_with_both_forms(text):
    with pytest.raises(ConfigError, match='such as "1 %" of the film or "50 nm"'):
        read_target(text)


def test_a_scale_of_the_ratio_between_two_fixtures_is_the_course_of_its_change():
    found, slope = errors_of(ratio=0.01), slope_at(np.array([*FILMS, MEDIAN]))
    npt.assert_allclose(found.std(), 0.01 / slope, rtol=1e-6)
    npt.assert_allclose(found.std(["fixture_after"]), 0.07 * 0.01 / slope, rtol=1e-6)


def test_what_grows_has_half_of_its_width_in_the_middle_and_its_course_by_all_of_it():
    found = errors_of(bleaching=0.01)
    npt.assert_allclose(found.std(["fixture_after"]), 0.14 * found.std(), rtol=1e-9)


def test_of_dry_frames_the_energy_of_their_pulses_remains():
    found = errors_of(background=0.015)
    npt.assert_allclose(found.std(["dry_frames"]), 0.05 * found.std(), rtol=1e-9)


def test_a_width_that_is_stated_smaller_stays():
    found = errors_of(wall=0.002)
    npt.assert_allclose(found.std(["walls"]), found.std(), rtol=1e-12)


def test_a_patch_leaves_its_film_and_the_field_at_two_places():
    """Posterior of a single error by its width and by what the patch shows of it."""
    films = np.array([*FILMS, MEDIAN])
    slope, at_patch = slope_at(films), float(slope_at(np.array(PATCH)))
    shown, width = 0.02 * at_patch, np.hypot(0.01, 0.005)
    scale = shown * width / np.hypot(shown, width)
    npt.assert_allclose(errors_of(ratio=0.01, lag=0.005).std(["patch"]), scale / slope, rtol=1e-6)
    even = errors_of(ratio=0.01, field=0.005, patch_std=0.0).std(["patch"])
    left = np.hypot(0.01 * 0.005 / np.hypot(0.01, 0.005), 0.005)
    npt.assert_allclose(even, left / slope, rtol=1e-6)
    width = 0.005 * PATCH * at_patch
    size = shown * width / np.hypot(shown, width) * films / (PATCH * at_patch)
    npt.assert_allclose(errors_of(size=0.005).std(["patch"]), size, rtol=1e-5)


def test_information_holds_for_other_widths():
    """Posterior of y = A e + noise by its normal equations."""
    rng = np.random.default_rng(5)
    A, prior = rng.normal(size=(7, 3)), np.diag([1.0, 4.0, 0.25])
    posterior = np.linalg.inv(np.linalg.inv(prior) + A.T @ A)
    npt.assert_allclose(information_of(prior, posterior), A.T @ A, rtol=1e-8)


def test_an_error_without_a_width_has_no_information():
    found = information_of(np.diag([1.0, 0.0]), np.diag([0.2, 0.0]))
    npt.assert_allclose(found, np.diag([4.0, 0.0]), atol=1e-12)


def test_the_shortest_list_names_what_is_needed_and_no_more():
    """1 % of 4 um, 40 nm: lag alone makes more than that, linearity less."""
    found = shortest_list(errors_of(patch_std=1.0, lag=0.01, linearity=0.0005), (0.01, 0.0))
    assert list(found["remedy"].values) == ["", "dark_after_light"]
    assert found[0, -1] > 0.04 >= found[1, -1]


def test_a_list_of_which_nine_of_ten_runs_lie_within_the_target_is_longer():
    """40 nm of 4 um: lag of 0.16 % makes 36 nm, of which 73 % lie within; left are 23 nm."""
    errors = errors_of(patch_std=1.0, lag=0.0016)
    assert shortest_list(errors, (0.01, 0.0)).sizes["remedy"] == 1
    found = shortest_list(errors, (0.01, 0.0), within=NINE_OF_TEN)
    assert list(found["remedy"].values) == ["", "dark_after_light"]
    npt.assert_allclose(NINE_OF_TEN, scipy.stats.norm.ppf(0.95), rtol=1e-3)


def test_where_the_run_reaches_the_target_nothing_is_listed():
    assert shortest_list(errors_of(lag=0.01), (0.5, 0.0)).sizes["remedy"] == 1


def test_a_target_that_nothing_reaches_leaves_the_largest_term():
    """Noise has no remedy: the list is what lowers the rest, and the noise is named."""
    found = shortest_list(errors_of(0.01, patch_std=1.0, lag=0.01), (0.0, 0.001))
    assert list(found["remedy"].values) == ["", "dark_after_light"]
    assert found.attrs["largest"] == "noise"
    npt.assert_allclose(found.attrs["largest_std"], 0.01 / slope_at(np.array(MEDIAN)), rtol=1e-6)


def test_films_that_are_not_covered_have_no_number():
    found = errors_of(lag=0.01)
    found.acts[:, 3] = np.nan
    table = shortest_list(found, (0.01, 0.0))
    assert np.isnan(table[:, 3]).all()
    assert np.isfinite(table[:, 4]).all()
