"""Fixtures photographed before and after a run whose dyes bleach and whose oil warms."""

import json

import numpy as np
import numpy.testing as npt
import pytest
from scenes.rig import small_rig

import erlif
from conftest import processed, simulated
from erlif.calibration import calibration_of

pytestmark = pytest.mark.usefixtures("without_theory")

PULSES = 9
RIG = small_rig(
    spacing=6.0,
    film_reference=4.0,
    bleaching=(1 - 0.975 ** (1 / PULSES), 1 - 0.95 ** (1 / PULSES)),
    warming=-10.0,
    fixture_after=True,
)
"""Cold oil adds to what bleaching does; a fixture before the run alone leaves 0.5 um at the end."""


lab = simulated(RIG, seed=41)
film = processed("lab")


def median_errors(film, lab):
    """Median error of films of 3 to 7 um at each trigger, and its stated shared std. [um]"""
    inside, error = lab.errors(film, above=3, below=7)
    return (
        np.array([np.median(one[good]) for one, good in zip(each, inside, strict=True)])
        for each in (error, film.thickness_std_shared.values)
    )


def test_films_follow_the_curve_between_both_fixtures(lab, film):
    run = lab.copy_run("first", add='\n[light]\nerrors = "report"\n')
    first = erlif.process(run, calibration=lab.fixture / "calibration.nc", workers=1)
    before, _ = median_errors(first, lab)
    after, std = median_errors(film, lab)

    assert abs(before[-1]) > 0.3
    assert np.abs(after / std).max() < 2
    assert np.abs(after).max() < 0.05

    # what remains is the course between: nothing at both ends of the run
    assert std[[0, -1]].max() < 0.6 * std[len(std) // 2]
    course = film.film_mean_error.sel(error_term="course").values
    assert course[[0, -1]].max() < 0.05 * course.max()
    assert "bleaching" in first.error_term
    assert "bleaching" not in film.error_term


def test_film_records_both_fixtures(lab, film):
    opened = [erlif.calibrate(lab.directory / name) for name in ("fixture", "fixture_after")]
    kept = json.loads(film.attrs["calibration"])
    hashes = [json.loads(one.attributes["input_hashes"]) for one in opened]
    assert [kept["input_hashes"], kept["later"]["input_hashes"]] == hashes
    assert hashes[0] != hashes[1]

    # the curve at the last frame is that of the fixture after the run
    last = calibration_of(film).at(1.0)
    npt.assert_allclose(last.predict_log(5.0), opened[1].predict_log(5.0), rtol=1e-12)


def test_budget_is_that_of_the_film(lab, film):
    trigger = film.sizes["trigger"] // 2
    budget = erlif.budget(lab.run, trigger=trigger)
    shared = float(budget["std"].sel(term="shared part", quantity="mean film"))
    terms = film.film_mean_error.isel(trigger=trigger).drop_sel(error_term=["noise", "marks"])
    assert shared == pytest.approx(float(np.sqrt((terms**2).sum())), rel=0.05)

    mean = float(budget.value.sel(quantity="mean film"))
    assert mean == pytest.approx(float(film.film_mean[trigger]), abs=0.005)


def test_bleaching_is_not_corrected_twice(lab, refused):
    run = lab.copy_run("twice", add='\n[light]\nbleaching = "correct"\n')
    assert "remove bleaching from [light], or name one calibration" in refused("process", run)
