"""Errors that the gap of a joint shows, from frames to film."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scenes.film import run_settings
from scenes.fixture import with_systematics
from scenes.measured import statistics_of
from scenes.rig import small_rig

from conftest import Laboratory, processed, simulated
from erlif.core.notes import Level
from erlif.pipeline.physics.gap import cells_of_region, describe_gap, find_errors
from erlif.pipeline.physics.light import is_beyond_widths
from erlif.pipeline.plane import ObjectPlane
from erlif.ratio import LightCells
from erlif.show.plots import example_calibration
from erlif.trend import CourseChange, Region, Trend

pytestmark = pytest.mark.usefixtures("without_theory")

RIG = small_rig(
    width=160,
    height=128,
    spacing=3.0,
    dark_pages=4,
    flat_pages=3,
    brightness=(1.0, 1.02),
    write_systematics=False,
)
"""Camera 2 is 2 % brighter in the run than at the calibration; 16 frames, nothing stated."""


lab = simulated(RIG, seed=43)
corrected = processed("lab")
reported = processed("lab", "reported", add='\n[light]\nerrors = "report"\n')


def median_error(lab, film):
    """Of the pixels between 6 and 8 um. [um]"""
    inside, error = lab.errors(film, above=6, below=8)
    return float(np.median(error[inside]))


def test_a_scale_of_the_ratio_is_reported_and_stays_in_the_maps(lab, reported):
    error = median_error(lab, reported)
    assert error > 0.5
    (note,) = [line for line in reported.attrs["notes"].splitlines() if "pin and bore" in line]
    assert 'errors = "report"' in note
    pull = (reported.film_min - lab.truth.film_min) / reported.film_min_std
    assert 0.5 < float(np.abs(pull).median()) < 1.5


def test_by_default_it_is_taken_out_and_its_error_remains(lab, reported, corrected):
    before, after = median_error(lab, reported), median_error(lab, corrected)
    assert abs(after) < 0.5 * before
    inside, _ = lab.errors(corrected, above=6, below=8)
    std = float(np.median(corrected.thickness_std_shared.values[inside]))
    assert abs(after) < 2.5 * std
    wide = float(np.median(reported.thickness_std_shared.values[inside]))
    assert std < 0.5 * wide

    pull = (corrected.film_min - lab.truth.film_min) / corrected.film_min_std
    assert float(np.abs(pull).max()) < 3
    assert float(corrected.film_min_std.median()) < 0.5 * float(reported.film_min_std.median())
    assert "taken out of the films" in corrected.attrs["notes"]


def test_errors_beyond_their_widths_are_not_taken_out(tmp_path):
    """Camera 2 is 6 % brighter: the bars hold the shift, and the text says so."""
    rig = replace(RIG, brightness=(1.0, 1.06))
    lab = Laboratory.simulated(tmp_path, seed=45, rig=rig)
    film = statistics_of(lab.run)
    assert "more than [systematics] allows" in film.attrs["notes"]
    assert "taken out" not in film.attrs["notes"]
    pull = (film.film_min - lab.truth.film_min) / film.film_min_std
    assert 0.5 < float(np.abs(pull).median()) < 2


@pytest.mark.slow
def test_a_window_over_one_camera_is_an_error_that_the_gap_shows(tmp_path):
    """1.4 % rms over the field, along and across: films stay within their error bars."""
    rig = replace(RIG, brightness=(1.0, 1.0), shading=(0.0173, 0, 0, 0, 0.034))
    lab = Laboratory.simulated(tmp_path, seed=46, rig=rig)
    film = statistics_of(lab.run)
    pull = (film.film_min - lab.truth.film_min) / film.film_min_std
    assert float(np.abs(pull).median()) < 2
    assert float(film.film_min_std.median()) < 0.4
    terms = film.film_min_error.sel(error_term="field")
    assert float(terms.median()) > 0.02


@pytest.mark.parametrize("widths", [{}, {"ratio": 0.0, "wall": 0.0}])
def test_excluded_errors_are_not_looked_for(widths):
    """The frames are not even read."""
    calibration = with_systematics(example_calibration(), **widths)
    assert find_errors(None, calibration, None, pairs=50) is None


def test_a_run_without_a_joint_shows_no_errors():
    calibration = with_systematics(example_calibration(), ratio=0.01)
    plane = ObjectPlane(run_settings().model_copy(update={"joint": None}), (96, 128))
    assert plane.view is None
    assert find_errors({}, calibration, plane, pairs=50) is None
    (note,) = describe_gap(None, calibration, corrected=True)
    assert note.level is Level.WARNING
    assert describe_gap(None, calibration, corrected=False) == []


@pytest.mark.parametrize(
    ("shift", "words"), [(0.492, "492 ± 9 nm too thick"), (-0.492, "492 ± 9 nm too thin")]
)
def test_the_shift_of_the_films_is_thick_or_thin_without_a_sign(shift, words):
    errors = SimpleNamespace(
        film=2.7,
        film_shift=lambda film, middle: shift,
        film_std=lambda film, middle, before: 0.009,
        exceeds_widths=lambda calibration: False,
    )
    (note,) = describe_gap(errors, example_calibration(), corrected=False)
    assert words in note.text


@pytest.mark.parametrize(
    ("frame", "size", "beyond"),
    [(None, 0.03, False), (None, 0.04, True), (12, 0.01, False), (12, 0.02, True)],
)
def test_a_drift_of_three_widths_and_a_step_of_one_leave_the_gap_alone(frame, size, beyond):
    """Bleaching of 1 % and a temperature of 0.5 % drift by 1.1 % together."""
    calibration = with_systematics(example_calibration(), bleaching=0.01, temperature=0.005)
    course = CourseChange(frame=frame, size=size, std=0.001, significance=9.0)
    assert is_beyond_widths(calibration, None, None, course, 50) is beyond
    chance = CourseChange(frame=frame, size=size, std=0.02, significance=2.0)
    assert not is_beyond_widths(calibration, None, None, chance, 50)


@pytest.mark.parametrize(("per_pulse", "beyond"), [(-5e-4, False), (-1e-3, True)])
def test_bleaching_far_beyond_its_width_leaves_the_gap_alone(per_pulse, beyond):
    """Over 50 pulses, of a width of 1 %."""
    calibration = with_systematics(example_calibration(), bleaching=0.01)
    trend = Trend(per_pulse, 1e-5, np.nan, np.nan)
    assert is_beyond_widths(calibration, None, trend, None, 50) is beyond


def test_a_wrong_dark_leaves_the_errors_to_their_widths(tmp_path):
    """30 DN in camera 2: nothing is taken out, and the note and the error bars say so."""
    rig = replace(RIG, brightness=(1.0, 1.0), dark_drift=(0.0, 30.0))
    lab = Laboratory.simulated(tmp_path, seed=44, rig=rig)
    film = statistics_of(lab.copy_run("dark", add='\n[light]\nerrors = "correct"\n'))
    notes = film.attrs["notes"]
    assert "nothing was taken out" in notes
    assert "dark" in notes
    pull = (film.film_min - lab.truth.film_min) / film.film_min_std
    assert float(np.abs(pull).max()) < 2


def test_without_light_there_are_no_cells():
    assert cells_of_region([], None) is None


def test_cells_that_touch_a_patch_are_not_those_of_the_joint():
    lights = [LightCells(*np.ones((4, 120)))]
    plane = SimpleNamespace(shape=(240, 320), region=Region(slice(0, 240), slice(66, 320)))
    whole, (x, y) = cells_of_region(lights, SimpleNamespace(**vars(plane), patch=None))
    # its last column is in the cells from 54 to 81
    patch = Region(slice(96, 160), slice(24, 56))
    beside, _ = cells_of_region(lights, SimpleNamespace(**vars(plane), patch=patch))
    lost = np.isfinite(whole.log_ratio[0]) & np.isnan(beside.log_ratio[0])
    assert lost.any()
    assert (x[lost] < 82).all()
    assert ((y[lost] > 76) & (y[lost] < 180)).all()
