"""Differences of runs drawn from the error model: coverage, false alarms, common angles."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import numpy.testing as npt
import pytest

from conftest import FULL
from erlif.core.errors import ErlifError
from erlif.review.comparison import average_difference, correct_for_many, difference_map
from erlif.review.comparison.difference import common_angles, weights

MARKS, NOISE, SHARE = 0.03, 0.004, 0.08
"""Errors of minimum and mean film [um], and the share of the variance of the mean that repeats."""


def draw(record, rng, *, true=0.0, one_calibration=True, runs=2):
    """Runs with new errors; all but the first are thicker by `true`."""
    spread = np.linalg.cholesky(record.errors.curve.full_covariance)
    common = spread @ rng.standard_normal(len(spread))
    drawn = []
    for k in range(runs):
        error = common if one_calibration else spread @ rng.standard_normal(len(spread))
        size = record.angle.size
        own = {
            "film_min": MARKS * np.full(size, rng.standard_normal()),
            "film_mean": NOISE
            * (
                np.sqrt(1 - SHARE) * rng.standard_normal(size)
                + np.sqrt(SHARE) * rng.standard_normal()
            ),
        }
        value = {
            name: record.value[name] + true * (k > 0) + own[name] + record.gradient[name] @ error
            for name in own
        }
        stated = {"film_min": np.full(size, MARKS), "film_mean": np.full(size, NOISE)}
        key = "one" if one_calibration else str(k)
        errors = replace(record.errors, fixture=key, rig={"calibration": key})
        drawn.append(replace(record, value=value, own_std=stated, errors=errors))
    return drawn


@pytest.mark.parametrize("one_calibration", [True, False])
def test_a_stated_difference_covers_the_true_one(record, one_calibration):
    rng = np.random.default_rng(3)
    count, true = 300, 0.2
    for name in ("film_min", "film_mean"):
        pull = np.empty(count)
        for n in range(count):
            pair = draw(record, rng, true=true, one_calibration=one_calibration)
            found = average_difference(*pair, name, angle=record.angle)
            pull[n] = (found.value - true) / found.std
        # three binomial standard deviations of 300 draws
        assert (np.abs(pull) < 1).mean() == pytest.approx(0.683, abs=0.081)
        assert (np.abs(pull) < 1.96).mean() == pytest.approx(0.95, abs=0.038)


def test_runs_that_do_not_differ_are_stated_to_in_five_per_cent_of_comparisons_at_most(record):
    rng = np.random.default_rng(4)
    count, alarms = 200 if FULL else 100, 0
    for _ in range(count):
        runs = draw(record, rng, runs=3)
        probability = [
            average_difference(one, other, name, angle=record.angle).probability
            for one, other in combinations(runs, 2)
            for name in ("film_min", "film_mean")
        ]
        alarms += bool((correct_for_many(np.array(probability)) < 0.05).any())
    assert alarms / count < 0.05 + 3 * np.sqrt(0.05 * 0.95 / count)


def test_the_error_of_one_calibration_cancels_and_that_of_two_does_not(record):
    same = average_difference(record, record, "film_mean", angle=record.angle)
    assert same.std == pytest.approx(same.own_std)
    later = replace(
        record, errors=replace(record.errors, fixture="another", rig={"calibration": "another"})
    )
    apart = average_difference(record, later, "film_mean", angle=record.angle)
    mean = record.gradient["film_mean"].mean(axis=0)
    shared = mean @ record.errors.curve.full_covariance @ mean
    assert apart.std**2 - apart.own_std**2 == pytest.approx(2 * shared)


def test_a_calibration_cancels_only_as_far_as_the_films_are_equal(record):
    thicker = record.gradient["film_mean"] * 2
    other = replace(record, gradient={**record.gradient, "film_mean": thicker})
    found = average_difference(record, other, "film_mean", angle=record.angle)
    mean = record.gradient["film_mean"].mean(axis=0)
    shared = mean @ record.errors.curve.full_covariance @ mean
    assert found.std**2 - found.own_std**2 == pytest.approx(shared)


def test_runs_at_other_angles_are_interpolated_between_their_triggers(record):
    angle = np.arange(0.0, 360.0, 10.0)
    ramp = {name: np.sin(np.radians(angle)) + 3 for name in record.value}
    error = {name: np.full(36, 0.01) for name in record.value}
    gradient = {name: np.zeros((36, 3)) for name in record.value}
    one = replace(record, angle=angle, value=ramp, own_std=error, gradient=gradient)
    shifted = angle + 4.0
    values = {name: np.sin(np.radians(shifted)) + 3 for name in record.value}
    other = replace(one, angle=shifted, value=values)
    common = common_angles([one, other])
    assert common.size == 36  # the circle is closed
    found = average_difference(one, other, "film_min", angle=common)
    assert np.abs(found.at).max() < np.radians(10) ** 2 / 8


def test_triggers_beyond_those_of_another_run_are_left_out(record):
    near, share = weights(np.array([10.0, 20.0, 30.0]), np.array([5.0, 15.0, 30.0, 200.0]))
    assert near.tolist() == [False, True, True, False]
    npt.assert_allclose(share[1:3], [[0.5, 0.5, 0.0], [0.0, 0.0, 1.0]])
    far = replace(record, angle=record.angle + 17.0)
    with pytest.raises(ErlifError, match="3 common crank angles or more; there are 0"):
        common_angles([replace(record, angle=np.array([1.0, 2, 3, 70, 71, 72])), far])


def test_runs_without_crank_angle_need_one_number_of_triggers(record):
    still = replace(record, by_angle=False, angle=np.arange(6.0))
    assert common_angles([still, still]).size == 6
    with pytest.raises(ErlifError, match="they have 5 and 6"):
        common_angles([still, replace(still, angle=np.arange(5.0))])


def test_a_trigger_without_a_film_has_no_difference(record):
    value = record.value["film_mean"].copy()
    value[2] = np.nan
    part = replace(record, value={**record.value, "film_mean": value})
    found = average_difference(record, part, "film_mean", angle=record.angle)
    assert np.isnan(found.at).tolist() == [False, False, True, False, False, False]
    assert found.value == 0
    none = replace(record, value={**record.value, "film_mean": np.full(6, np.nan)})
    empty = average_difference(record, none, "film_mean", angle=record.angle)
    assert np.isnan(empty.probability)


def test_probabilities_are_corrected_as_by_holm():
    # example of Holm's procedure: sorted 0.005, 0.01, 0.03, 0.04 times 4, 3, 2, 1, never falling
    corrected = correct_for_many(np.array([0.01, 0.04, np.nan, 0.03, 0.005]))
    npt.assert_allclose(corrected, [0.03, 0.06, np.nan, 0.06, 0.02])


def with_noise(film, seed, thicker=0.0):
    """The film with new noise of 0.05 um, and a step in its right half."""
    rng = np.random.default_rng(seed)
    smooth = 3.0 + np.zeros(film.thickness.shape)
    smooth[..., 32:] += thicker
    noisy = smooth + 0.05 * rng.standard_normal(smooth.shape)
    values = np.where(film.flags.values == 0, noisy, np.nan).astype(np.float32)
    return film.assign(thickness=(film.thickness.dims, values, film.thickness.attrs))


def test_a_step_is_found_where_it_is_and_with_its_size(film):
    false, stated = 0, 0
    for n in range(20):
        pair = with_noise(film, 2 * n), with_noise(film, 2 * n + 1, 0.2)
        found = difference_map(*pair, triggers=(0, 0))
        right = found.x.values > film.x.values[31]
        npt.assert_allclose(found.difference.values[:, right], 0.2, atol=0.06)
        assert (found.differs.values[:, right] == 1).all()
        false += int(found.differs.values[:, ~right].sum())
        stated += int(found.differs.values.sum())
    # 5 % of the cells stated to differ may be false, here with three binomial standard deviations
    assert false / stated < 0.05 + 3 * np.sqrt(0.05 / stated)


def test_the_scatter_of_equal_films_is_as_stated(film):
    pulls = np.concatenate(
        [
            difference_map(
                with_noise(film, 2 * n), with_noise(film, 2 * n + 1), triggers=(0, 0)
            ).significance.values.ravel()
            for n in range(15)
        ]
    )
    pulls = pulls[np.isfinite(pulls)]
    assert 0.65 < (np.abs(pulls) < 1).mean() < 0.85  # the stated error has a part of registration
    assert (np.abs(pulls) < 1.96).mean() > 0.94


def test_two_calibrations_add_their_errors(film):
    other = film.assign_attrs(calibration=film.attrs["calibration"].replace("wedge", "wedge 2"))
    assert other.attrs["calibration"] != film.attrs["calibration"]
    same = difference_map(film, film, triggers=(0, 1))
    apart = difference_map(film, other, triggers=(0, 1))
    assert (same.attrs["same_calibration"], apart.attrs["same_calibration"]) == (1, 0)
    known = np.isfinite(same.difference_std.values)
    assert (apart.difference_std.values[known] > same.difference_std.values[known]).all()


def test_images_that_lie_along_other_axes_are_refused(film):
    turned = film.attrs["settings"].replace('x_axis = "sliding"', 'x_axis = "axial"')
    with pytest.raises(ErlifError, match="x_axis in"):
        difference_map(film, film.assign_attrs(settings=turned), triggers=(0, 0))
