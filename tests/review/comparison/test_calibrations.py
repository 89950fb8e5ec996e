"""Which errors the calibrations of two runs have in common."""

import json
from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import with_systematics

from erlif.calibration import NO_SYSTEMATICS, RunCurve, record_calibration
from erlif.review.comparison import average_difference, difference_map, read_run
from erlif.review.comparison.calibrations import (
    RunErrors,
    difference_var,
    joint_covariance,
    key_of,
    largest_term,
)
from erlif.show.plots import example_calibration

FIXTURE = {"position": 0.05, "size": 0.005}
"""Origin of the profile to 0.05 um, its scale to 0.5 %."""


def run_with(light=(1.0, 1.0), **widths):
    return with_systematics(example_calibration(), light=light, **FIXTURE, **widths)


WIDTHS = {"ratio": 0.01, "background": 0.015, "wall": 0.02, "linearity": 0.01, "bleaching": 0.01}
WIDTHS |= {"temperature": 0.005, "lag": 0.005}
"""The defaults of [systematics]. [1]"""


def errors_of(run, fixture="a", rig="r", **widths):
    return RunErrors(run, fixture, {"calibration": fixture, "rig": rig}, WIDTHS | widths)


@pytest.fixture
def run():
    return run_with(ratio=0.01, background=0.015)


def test_runs_of_one_fixture_have_one_key(run):
    assert key_of(run) == key_of(run_with(light=(2.0, 1.5), ratio=0.002))
    assert key_of(run) == key_of(replace(run, systematics=NO_SYSTEMATICS))
    assert key_of(run) != key_of(RunCurve.of(replace(run.calibration, ratio_at_zero=0.7)))


def test_errors_of_the_fixture_are_common_and_those_of_the_run_are_not(run):
    other = run_with(ratio=0.01, background=0.015, course=0.07)
    size, whole = (
        len(run.full_covariance),
        joint_covariance([errors_of(run), errors_of(other, rig="s")]),
    )
    common = whole[:size, size:]

    npt.assert_allclose(common[:3, :3], run.fitted_covariance)
    for name, std in FIXTURE.items():
        here, there = (3 + one.systematics.terms.index(name) for one in (run, other))
        assert common[here, there] == pytest.approx(std**2)
        common[here, there] = 0.0
    assert not common[3:].any()
    apart = [errors_of(run), errors_of(other, "b", "s")]
    assert not joint_covariance(apart)[:size, size:].any()


def test_a_measured_background_is_correlated_between_runs_by_their_fixture():
    """Half of the variance of both backgrounds is an error of K."""
    std = example_calibration().standard_deviations[0]
    run = run_with(background=0.02)
    first = run.systematics.terms.index("background")
    cross = run.systematics.cross.copy()
    cross[0, first : first + 2] = std * 0.02 / np.sqrt(2)
    run = replace(run, systematics=replace(run.systematics, cross=cross))

    size, whole = len(run.full_covariance), joint_covariance([errors_of(run)] * 2)
    assert whole[3 + first, size + 3 + first] == pytest.approx(0.02**2 / 2, rel=1e-6)

    root = np.sqrt(np.diag(whole))
    assert np.linalg.eigvalsh(whole / np.outer(root, root)).min() > -1e-9


def test_on_one_rig_a_difference_holds_what_changes_from_run_to_run():
    """Equal films: wall, lag and linearity cancel; temperature and bleaching are new in both."""
    run = run_with(**WIDTHS)
    gradient = run.film_gradient(5.0)
    terms = np.array(["", "", "", *run.systematics.terms])
    own = {key: gradient[terms == key] for key in dict.fromkeys(terms)}
    new = sum(2 * WIDTHS[key] ** 2 * (own[key] ** 2).sum() for key in ("temperature", "bleaching"))
    changed = (0.003 * own["ratio"]) ** 2 + (0.002 * own["wall"]) ** 2
    one, two = 0.003 * own["background"]
    background = one**2 + two**2 + 2 * 0.9 * one * two
    expected = float(new + changed.sum() + background)

    pair = errors_of(run), errors_of(run)
    npt.assert_allclose(difference_var(gradient, gradient, pair), expected, rtol=1e-6)
    assert largest_term(gradient, gradient, pair) == "bleaching"

    # on two rigs all of it is new
    other = errors_of(run), errors_of(run, rig="s")
    assert difference_var(gradient, gradient, other) > 3 * expected
    # what a laboratory has measured to less than it changes does not become larger
    narrow = run_with(**WIDTHS | {"ratio": 0.001})
    pair = (errors_of(narrow, ratio=0.001),) * 2
    assert difference_var(gradient, gradient, pair) < expected


def test_calibrations_that_drift_widen_the_change_between_days_but_not_of_one_day():
    """Scale of the ratio alone; its calibrations changed by 0.8 % from day to day."""
    run = run_with(ratio=0.01)
    gradient = run.film_gradient(5.0)
    ratio = float(np.abs(gradient[3 + run.systematics.terms.index("ratio")]))
    first = replace(errors_of(run), date="2026-03-01", drift=0.008)
    for date, change in (("2026-03-01", 0.003), ("2026-05-02", 0.008)):
        stated = difference_var(gradient, gradient, (first, replace(first, date=date)))
        assert np.sqrt(stated) == pytest.approx(change * ratio, rel=1e-6)


def test_runs_with_other_cameras_are_not_of_one_rig(film):
    """Serial numbers; a number that one run alone has is no other camera for certain."""

    def rig_of(numbers):
        return read_run(film.assign_attrs(camera_serials=json.dumps(numbers))).errors.rig

    assert rig_of(["11", "12"]) == rig_of(["11", "12"])
    assert rig_of(["", ""]) == read_run(film).errors.rig
    assert rig_of(["11", "12"]) != rig_of(["11", "13"])
    assert rig_of(["11", "12"]) != rig_of(["", ""])


def test_the_load_of_a_run_makes_no_other_rig(film):
    def rig_with(*change):
        return read_run(
            film.assign_attrs(settings=film.attrs["settings"].replace(*change))
        ).errors.rig

    assert "50 lbf" in film.attrs["settings"]
    assert rig_with("50 lbf", "100 lbf") == read_run(film).errors.rig
    assert rig_with("33.59 mm", "33.60 mm") != read_run(film).errors.rig


def test_a_difference_of_runs_of_one_rig_covers_the_true_one():
    """Rigs drawn by their widths, both runs by what changes; films of exact curves, 3 and 6 um."""
    run, rng, count = run_with(**WIDTHS), np.random.default_rng(7), 4000
    names = [
        (term, one.name)
        for term, one in zip(run.systematics.terms, run.systematics.parameters, strict=True)
    ]
    root = np.linalg.cholesky(run.full_covariance + 1e-18 * np.eye(len(run.full_covariance)))
    common = rng.normal(size=(count, len(root))) @ root.T
    apart = {"ratio": 0.003, "wall": 0.002, "background": 0.003, "lag": 0.0, "linearity": 0.0}
    drawn = []
    for _ in range(2):
        errors, new = common.copy(), rng.normal(size=(count, len(root))) @ root.T
        for n, (term, _) in enumerate(names, 3):
            if term in apart:
                share = 0.5 * (apart[term] / WIDTHS[term]) ** 2
                errors[:, n] = np.sqrt(1 - share) * common[:, n] + np.sqrt(share) * new[:, n]
            elif term not in FIXTURE:
                errors[:, n] = new[:, n]
        drawn.append(errors)
    thin, thick = run.film_gradient(3.0), run.film_gradient(6.0)
    off = drawn[1] @ thick - drawn[0] @ thin
    pull = off / np.sqrt(difference_var(thin, thick, (errors_of(run), errors_of(run))))
    assert (np.abs(pull) < 1).mean() == pytest.approx(0.683, abs=0.022)
    assert (np.abs(pull) < 1.96).mean() == pytest.approx(0.95, abs=0.0104)


def test_what_two_runs_leave_of_their_common_errors_cancels():
    """Both take out what they measure of their errors, each with noise of its own."""
    run, rng, count = run_with(**WIDTHS), np.random.default_rng(11), 20000
    prior = run.full_covariance
    size, std = len(prior), np.sqrt(np.diag(prior))
    seen = rng.normal(size=(6, size)) / std
    gain = prior @ seen.T @ np.linalg.inv(seen @ prior @ seen.T + 0.09 * np.eye(6))
    after = prior - gain @ seen @ prior
    value = np.zeros(size)
    corrected = run.systematics.with_errors(
        after, value, before=prior, scatter=0.09 * gain @ gain.T
    )
    pair = (errors_of(replace(run, systematics=corrected)),) * 2

    common = joint_covariance([errors_of(run)] * 2)
    both = np.linalg.cholesky(common + 1e-9 * np.diag(np.tile(std, 2) ** 2))
    drawn = (rng.normal(size=(count, 2 * size)) @ both.T).reshape(count, 2, size)
    measured = drawn @ seen.T + 0.3 * rng.normal(size=(count, 2, 6))
    left = drawn - measured @ gain.T
    thin, thick = run.film_gradient(3.0), run.film_gradient(4.0)
    off = left[:, 1] @ thick - left[:, 0] @ thin
    stated = difference_var(thin, thick, pair)
    npt.assert_allclose(off.var(), stated, rtol=0.04)
    alone = thin @ after @ thin + thick @ after @ thick
    assert stated < 0.8 * alone


def test_the_scale_of_the_ratio_does_not_cancel_between_two_runs(film):
    """The films are equal: the errors of the fixture cancel, 0.3 % of the ratio does not."""
    run = run_with(ratio=0.01)
    pair = [
        film.assign_attrs(calibration=record_calibration(one), input_hashes=json.dumps(hashes))
        for one, hashes in ((run, {}), (run_with(ratio=0.01, light=(2.0, 1.5)), {"a": "b"}))
    ]
    records = [read_run(one) for one in pair]

    found = average_difference(*records, "film_mean", angle=records[0].angle)
    shared = np.sqrt(found.std**2 - found.own_std**2)
    ratio = np.abs(records[0].gradient["film_mean"][:, 3]).mean() * 0.003
    assert shared == pytest.approx(ratio, rel=1e-3)

    # 0.3 % of the ratio shifts a film by 0.003 over the slope of the curve
    found = average_difference(*records, "film_min", angle=records[0].angle)
    shared = np.sqrt(found.std**2 - found.own_std**2)
    film_min, step = film.film_min.values, 1e-4  # um
    slope = (run.predict_log(film_min + step) - run.predict_log(film_min - step)) / (2 * step)
    assert shared == pytest.approx(0.003 * np.mean(1 / slope), rel=1e-3)

    mapped = difference_map(*pair, triggers=(0, 0))
    assert float(mapped.difference_std.min()) > 0.003 / run.slope(1.0)

    # between two days what the calibrations of the rig show, in every cell
    dated = [one.assign_attrs(recorded=f"2026-05-0{day}") for day, one in enumerate(pair, 1)]
    drifted = difference_map(*dated, triggers=(0, 0), drift=0.009)
    assert float(mapped.difference_std.min()) < 0.009 / run.slope(1.0)
    assert float(drifted.difference_std.min()) > 0.009 / run.slope(1.0)
