"""Which errors the calibrations of two runs have in common."""

import json
from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import with_systematics

from erlif.calibration import NO_SYSTEMATICS, RunCurve, record_calibration
from erlif.review.comparison import average_difference, difference_map, read_run
from erlif.review.comparison.calibrations import joint_covariance, key_of
from erlif.show.plots import example_calibration

FIXTURE = {"position": 0.05, "size": 0.005}
"""Origin of the profile to 0.05 um, its scale to 0.5 %."""


def run_with(light=(1.0, 1.0), **widths):
    return with_systematics(example_calibration(), light=light, **FIXTURE, **widths)


@pytest.fixture
def run():
    return run_with(ratio=0.01, background=0.015)


def test_runs_of_one_fixture_have_one_key(run):
    assert key_of(run) == key_of(run_with(light=(2.0, 1.5), ratio=0.002))
    assert key_of(run) == key_of(replace(run, systematics=NO_SYSTEMATICS))
    assert key_of(run) != key_of(RunCurve.of(replace(run.calibration, ratio_at_zero=0.7)))


def test_errors_of_the_fixture_are_common_and_those_of_the_run_are_not(run):
    other = run_with(ratio=0.01, background=0.015, course=0.07)
    size, whole = len(run.full_covariance), joint_covariance([run, other], ["a", "a"])
    common = whole[:size, size:]

    npt.assert_allclose(common[:3, :3], run.fitted_covariance)
    for name, std in FIXTURE.items():
        here, there = (3 + one.systematics.terms.index(name) for one in (run, other))
        assert common[here, there] == pytest.approx(std**2)
        common[here, there] = 0.0
    assert not common[3:].any()
    assert not joint_covariance([run, other], ["a", "b"])[:size, size:].any()


def test_a_measured_background_is_correlated_between_runs_by_their_fixture():
    """Half of the variance of both backgrounds is an error of K."""
    std = example_calibration().standard_deviations[0]
    run = run_with(background=0.02)
    first = run.systematics.terms.index("background")
    cross = run.systematics.cross.copy()
    cross[0, first : first + 2] = std * 0.02 / np.sqrt(2)
    run = replace(run, systematics=replace(run.systematics, cross=cross))

    size, whole = len(run.full_covariance), joint_covariance([run, run], ["a", "a"])
    assert whole[3 + first, size + 3 + first] == pytest.approx(0.02**2 / 2, rel=1e-6)

    root = np.sqrt(np.diag(whole))
    assert np.linalg.eigvalsh(whole / np.outer(root, root)).min() > -1e-9


def test_the_scale_of_the_ratio_does_not_cancel_between_two_runs(film):
    """The films are equal: the errors of the fixture cancel, 1 % of the ratio in each does not."""
    run = run_with(ratio=0.01)
    pair = [
        film.assign_attrs(calibration=record_calibration(one), input_hashes=json.dumps(hashes))
        for one, hashes in ((run, {}), (run_with(ratio=0.01, light=(2.0, 1.5)), {"a": "b"}))
    ]
    records = [read_run(one) for one in pair]

    found = average_difference(*records, "film_mean", angle=records[0].angle)
    shared = np.sqrt(found.std**2 - found.own_std**2)
    ratio = np.abs(records[0].gradient["film_mean"][:, 3]).mean() * 0.01
    assert shared == pytest.approx(np.sqrt(2) * ratio, rel=1e-3)

    # 1 % of the ratio shifts a film by 0.01 over the slope of the curve
    found = average_difference(*records, "film_min", angle=records[0].angle)
    shared = np.sqrt(found.std**2 - found.own_std**2)
    film_min, step = film.film_min.values, 1e-4  # um
    slope = (run.predict_log(film_min + step) - run.predict_log(film_min - step)) / (2 * step)
    assert shared == pytest.approx(np.sqrt(2) * 0.01 * np.mean(1 / slope), rel=1e-3)

    mapped = difference_map(*pair, triggers=(0, 0))
    assert float(mapped.difference_std.min()) > 0.01 / run.slope(1.0)
