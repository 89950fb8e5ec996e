"""Fixtures photographed before and after a run whose dyes bleach and whose oil warms."""

import json

import numpy as np
import pytest

import erlif
from conftest import Laboratory
from erlif.calibration import calibration_of
from erlif.rig import RigSettings

PULSES = 17
RIG = RigSettings(
    width=128,
    height=96,
    spacing=3.0,
    fixture_frames=6,
    bubbles=0,
    film_reference=4.0,
    bleaching=(1 - 0.975 ** (1 / PULSES), 1 - 0.95 ** (1 / PULSES)),
    warming=-10.0,
    fixture_after=True,
)
"""Cold oil adds to what bleaching does; a fixture before the run alone leaves 0.5 um at the end."""


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    return Laboratory.simulated(tmp_path_factory.mktemp("before_after"), seed=41, rig=RIG)


@pytest.fixture(scope="module")
def film(lab):
    return erlif.process(lab.run, workers=1)


def errors(film, lab):
    """Median error of films of 3 to 7 um at each trigger, and its stated shared std. [um]"""
    true = lab.truth.film.values
    inside = (film["flags"].values == 0) & (true > 3) & (true < 7)
    values = film.thickness.values - true, film.thickness_std_shared.values
    return (
        np.array([np.median(one[good]) for one, good in zip(each, inside, strict=True)])
        for each in values
    )


def test_films_follow_the_curve_between_both_fixtures(lab, film):
    first = erlif.process(lab.run, calibration=lab.fixture / "calibration.nc", workers=1)
    before, _ = errors(first, lab)
    after, std = errors(film, lab)
    assert abs(before[-1]) > 0.3
    assert np.abs(after / std).max() < 2
    assert np.abs(after).max() < 0.05

    # what remains is the course between: nothing at both ends of the run
    assert std[[0, -1]].max() < 0.6 * std[len(std) // 2]
    course = film.film_mean_error.sel(error_term="course").values
    assert course[[0, -1]].max() < 0.05 * course.max()
    assert "bleaching" not in film.error_term


def test_film_records_both_fixtures(lab, film):
    kept = json.loads(film.attrs["calibration"])
    files = [
        json.loads(
            erlif.open_calibration(lab.directory / name / "calibration.nc").attributes[
                "input_hashes"
            ]
        )
        for name in ("fixture", "fixture_after")
    ]
    assert [kept["input_hashes"], kept["later"]["input_hashes"]] == files
    assert files[0] != files[1]
    read = calibration_of(film)
    opened = erlif.open_calibration(lab.directory / "fixture_after" / "calibration.nc")
    np.testing.assert_allclose(read.at(1.0).predict_log(5.0), opened.predict_log(5.0), rtol=1e-12)


def test_budget_is_that_of_the_film(lab, film):
    trigger = film.sizes["trigger"] // 2
    budget = erlif.budget(lab.run, trigger=trigger)
    shared = float(budget["std"].sel(term="shared part", quantity="mean film"))
    stated = float(np.sqrt((film.film_mean_error[2:, trigger] ** 2).sum()))
    assert shared == pytest.approx(stated, rel=0.05)
    mean = float(budget.value.sel(quantity="mean film"))
    assert mean == pytest.approx(float(film.film_mean[trigger]), abs=0.005)


def test_bleaching_is_not_corrected_twice(lab, refused):
    run = lab.copy_run("twice", add='\n[light]\nbleaching = "correct"\n')
    assert "remove bleaching from [light], or name one calibration" in refused("process", run)
