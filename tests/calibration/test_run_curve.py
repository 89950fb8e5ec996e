"""The curve of a run: between two fixtures, at its shares, and what it takes from a calibration."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
from scenes.fixture import with_systematics

from erlif.calibration import RunCurve
from erlif.calibration.soundness import check_calibration
from erlif.show.plots.example import example_calibration


def test_curve_between_two_fixtures_is_their_mixture():
    before = example_calibration()
    later = replace(before, ratio_at_zero=0.6, attenuation_camera2=0.24, thickness_range=(1.0, 9.0))
    run = RunCurve.of(before, later)
    films = np.linspace(1.0, 9.0, 9)
    expected = 0.7 * before.predict_log(films) + 0.3 * later.predict_log(films)
    npt.assert_allclose(run.at(0.3).predict_log(films), expected, rtol=1e-12)
    slope = (run.at(0.3).predict_log(films + 1e-5) - run.at(0.3).predict_log(films - 1e-5)) / 2e-5
    npt.assert_allclose(run.at(0.3).slope(films), slope, rtol=1e-6)
    npt.assert_allclose(run.at(0.3).inverse.look_up(expected), films, atol=1e-4)
    assert run.thickness_range == (1.0, 9.0)


def test_a_calibration_is_the_curve_of_a_run_that_adds_nothing():
    """Its errors are those of the fixture, which do not change during the run."""
    fixture = with_systematics(example_calibration(), position=0.05, size=0.01).calibration
    run, films = RunCurve.of(fixture), np.linspace(1.0, 9.0, 9)
    npt.assert_array_equal(run.predict_log(films), fixture.predict_log(films))
    npt.assert_array_equal(run.thickness_std(films), fixture.thickness_std(films))
    assert run.at(0.5) is run
    assert (run.moves, run.varies) == (False, False)


def test_errors_that_grow_change_a_run_and_leave_its_curve():
    run = with_systematics(example_calibration(), bleaching=0.02)
    assert (run.moves, run.varies) == (False, True)
    assert run.at(0.0).log_ratio_std(5.0) < run.at(1.0).log_ratio_std(5.0)
    assert run.at(0.0).predict_log(5.0) == run.at(1.0).predict_log(5.0)


def test_what_a_run_adds_holds_to_films_without_end():
    """The maximum of a ratio is judged by the ratio of a very thick film."""
    run = with_systematics(example_calibration(), background=0.05)
    value = np.zeros(len(run.full_covariance))
    value[len(run.fitted_covariance) :] = [0.02, 0.01]
    changed = replace(run, systematics=replace(run.systematics, value=value))
    films = np.array([0.5, 5.0, 30.0, 100.0, 900.0])
    added = np.tensordot(value, run.gradient(films), axes=1)
    assert abs(added[-1]) > 1e-3
    npt.assert_allclose(changed.predict_log(films) - run.predict_log(films), added, atol=1e-8)


def test_a_curve_that_falls_in_thin_film_is_used_where_it_rises():
    """By a background of a negative size, whose share of the light grows as the film vanishes."""
    run = with_systematics(example_calibration(), background=0.05)
    value = np.zeros(len(run.full_covariance))
    value[len(run.fitted_covariance) :] = [-0.05, 0.0]
    falling = replace(run, systematics=replace(run.systematics, value=value))
    low, high = run.thickness_range
    films = np.linspace(low, high, 4001)
    assert falling.slope(films)[0] < 0 < falling.slope(films)[-1]

    found = falling.where_it_rises()
    turn = films[np.flatnonzero(falling.slope(films) <= 0)[-1]]
    assert turn < found.thickness_range[0] < turn + 2e-3 * (high - low)
    assert found.thickness_range[1] == high
    check_calibration(found.calibration, found)
    assert run.where_it_rises().thickness_range == run.thickness_range
