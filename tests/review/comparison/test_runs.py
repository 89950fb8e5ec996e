"""Runs compared, as one dataset."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import with_systematics

import erlif
from erlif.calibration import record_calibration, save_calibration
from erlif.core.errors import ErlifError
from erlif.io.files import open_netcdf, write_dataset
from erlif.review.comparison import compare
from erlif.review.comparison.runs import duty_parameters, fit_runs
from erlif.show.plots import example_calibration, example_film, write_example


def test_a_known_difference_is_found_with_its_sign(film, other):
    found = erlif.compare([film, other])
    npt.assert_allclose(found.difference.values, 0.5)
    assert found.differs.values.all()
    assert found["first"].item() == "example (1)"
    npt.assert_allclose(found.map_difference.mean(), 0.5, atol=0.01)
    assert found.attrs["map_first_run"] == "example (1)"


def test_equal_runs_do_not_differ_and_all_units_are_stated(film, tmp_path):
    found = compare([film, film])
    assert not found.differs.values.any()
    assert (found.difference_std > 0).all()
    write_dataset(found, tmp_path / "compare.nc")
    with open_netcdf(tmp_path / "compare.nc") as read:
        for name in read.data_vars:
            if read[name].dtype.kind == "f":
                assert "units" in read[name].attrs, name


def test_a_drift_between_calibrations_widens_the_errors_of_statistics_and_map(film, tmp_path):
    """The ratio changes by 1 % between two days; without calibrations of both by 0.3 %."""
    run = with_systematics(example_calibration(), ratio=0.02)
    days = ("2026-05-02", "2026-11-30")
    record = {"calibration": record_calibration(run)}
    films = [film.assign_attrs(record, recorded=day) for day in days]
    first = example_calibration()
    later = replace(first, ratio_at_zero=1.012 * first.ratio_at_zero, date="2026-12-01")
    save_calibration(later, tmp_path / "later.nc")

    before, after = (compare(films, calibrations=each) for each in ([], [tmp_path / "later.nc"]))
    wider = after.calibration_drift / 0.003
    assert wider > 2
    for name in ("difference_std", "map_difference_std"):
        assert (after[name] > 0.8 * wider * before[name]).all()


def test_the_page_lists_every_variable(film, other):
    page = (Path(__file__).parents[3] / "docs" / "compare.md").read_text(encoding="utf-8")
    later = film.attrs["calibration"].replace('"date": ""', '"date": "2026-05-01"')
    later = later.replace("0.66", "0.67")
    patch = {"reference_film": ("trigger", np.linspace(4.9, 5.1, 6), {"units": "um"})}
    films = [film.assign(patch), other.assign(patch).assign_attrs(calibration=later)]
    found = compare(films)
    assert {"patch_ratio", "calibration_ratio", "duty", "film_theory"} <= set(found.data_vars)
    assert not [name for name in found.data_vars if f"`{name}`" not in page]


def test_films_are_read_from_files_and_the_map_is_that_of_the_angle(film, other, tmp_path):
    path = write_example(tmp_path / "film.nc")
    found = compare([path, other], crank_angle=112.0, pair=(1, 0))
    assert found.attrs["map_first_trigger"] == 4
    assert found.attrs["map_first_run"] == "example (2)"
    npt.assert_allclose(found.map_difference.mean(), -0.5, atol=0.01)


def test_what_is_no_pair_of_runs_is_refused(film):
    with pytest.raises(ErlifError, match="Name the films"):
        compare([film])
    with pytest.raises(ErlifError, match="a film as films=, got a pressure"):
        compare([film, erlif.plots.example_pressure()])


def test_films_without_a_motion_are_compared_trigger_by_trigger():
    film = example_film()
    gone = ["crank_angle", "encoder_angle", "rocker_speed", "sliding_speed", "stroke", "joint_load"]
    text = film.attrs["settings"]
    start, end = text.index("[mechanism]"), text.index("[oil]")
    still = film.drop_vars([name for name in film.variables if name in gone])
    still = still.assign_attrs(settings=text[:start] + text[end:])
    found = compare([still, still.assign(film_min=still.film_min + np.float64(0.1))])
    assert "duty" not in found
    npt.assert_allclose(found.difference.sel(statistic="film_min"), 0.1)


def with_film(record, film, **changes):
    value = dict.fromkeys(record.value, film)
    return replace(record, value=value, **changes)


def test_runs_of_one_law_at_two_loads_have_one_power(record):
    """0.6 of viscosity times speed over load, whatever the load of a run."""
    runs = []
    for load in (111.0, 222.0):
        duty = record.viscosity * record.speed / load
        runs.append(with_film(record, 800 * duty**0.6, load=np.full(6, load)))
    duties, unit, _ = duty_parameters(runs)
    assert unit == "Pa s rad s-1 N-1"
    for name in ("film_min", "film_mean"):
        fits = fit_runs(runs, duties, name)
        npt.assert_allclose([one.value for one in fits], 0.6, atol=2e-3)
        assert fits[-1].triggers == sum(one.triggers for one in fits[:-1])
        assert np.exp(fits[-1].log_scale) == pytest.approx(800, rel=0.02)


def test_without_a_viscosity_the_duty_parameter_is_speed_over_load(record):
    values, unit, meaning = duty_parameters([record, replace(record, viscosity=None)])
    npt.assert_allclose(values[0], record.speed / record.load)
    assert (unit, meaning) == ("rad s-1 N-1", "|rocker_speed| over load")
    assert duty_parameters([record, replace(record, load=None)])[0] == []
    assert duty_parameters([record, replace(record, speed_name="")])[0] == []


def test_triggers_without_speed_or_load_are_left_out(record):
    nothing = np.arange(6) != 2
    speed = np.where(nothing, record.speed, np.nan)
    without = replace(record, speed=speed)
    duties, *_ = duty_parameters([record, without])
    one, other, joint = fit_runs([record, without], duties, "film_min")
    assert (one.triggers, other.triggers, joint.triggers) == (6, 5, 11)
    npt.assert_allclose([other.value, joint.value], 0.6, atol=1e-6)

    for nothing in ({"speed": np.zeros(6)}, {"load": np.zeros(6)}):
        still = replace(record, **nothing)
        duties, *_ = duty_parameters([record, still])
        fits = fit_runs([record, still], duties, "film_min")
        assert np.isnan(fits[1].value)
        assert fits[2].triggers == 6


def test_the_error_of_a_calibration_is_that_of_all_its_runs(record):
    """Two runs determine the power no better than one where the shared error dominates."""
    duties, *_ = duty_parameters([record, record])
    quiet = replace(record, own_std={name: np.full(6, 1e-5) for name in record.value})
    one, _, joint = fit_runs([quiet, quiet], duties, "film_mean")
    apart = fit_runs(
        [quiet, replace(quiet, errors=replace(quiet.errors, fixture="b"))], duties, "film_mean"
    )[-1]
    assert apart.std < 0.8 * joint.std
    assert joint.std == pytest.approx(one.std, rel=0.3)
