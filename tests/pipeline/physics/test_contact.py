"""One gap for all triggers of a run, and notes on it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scenes.results import make_result

from erlif.core.notes import Level
from erlif.pipeline.physics.contact import note_contact, settle_contact
from erlif.show.plots import example_calibration
from erlif.trend import FilmNumber, GapMinimum, GapShape

CALIBRATION = example_calibration()
CONTACTS = (GapShape.PLANE, GapShape.LINE, GapShape.POINT, GapShape.PLATEAU)


def minimum(value, bend=(0.0, 0.0), misfit=0.1):
    """Minimum of a gap whose curvatures are known to 0.1 um."""
    gradient, known = np.ones(len(CALIBRATION.full_covariance)), np.full(2, 0.005)
    film = FilmNumber(value, 0.01, 0.02, gradient)
    return GapMinimum(*(film,) * 4, np.zeros(2), misfit, np.array(bend), known, known)


def result(bend, value=1.0, misfit=0.1):
    """A trigger whose plane, line and point contact have 1, 2 and 3 times a value."""
    minima = {one: minimum(n * value, bend, misfit) for n, one in enumerate(CONTACTS, 1)}
    return replace(make_result(0), minima=minima)


@pytest.mark.parametrize(
    ("bend", "contact", "factor"),
    [((0.0, 0.1), "plane", 1), ((1.0, 0.1), "line", 2), ((0.0, 1.0), "point", 3)],
)
def test_all_triggers_have_the_minimum_of_one_gap(bend, contact, factor):
    results, chosen = settle_contact([result(bend), result(bend, 1.5)], CONTACTS)
    assert chosen == contact
    assert [one.statistics.gap.minimum.value for one in results] == [factor, 1.5 * factor]
    shared = CALIBRATION.full_covariance.sum()  # of a gradient of ones
    assert results[0].statistics.gap.minimum.std(CALIBRATION.full_covariance) == pytest.approx(
        math.sqrt(5e-4 + shared)
    )
    (note,) = note_contact(results, chosen)
    assert (note.level, note.subject) == (Level.NOTE, "film_min")


@pytest.mark.parametrize(
    ("bend", "contact"), [((0.1, -0.1), "line"), ((0.5, 0.1), "journal"), ((0.1, -0.5), "journal")]
)
def test_a_pin_is_bent_where_its_triggers_show_it(bend, contact):
    """Four triggers, each known to 0.1 um by noise and 0.07 um by marks that all share."""
    shapes = GapShape.LINE, GapShape.JOURNAL
    minima = {shape: minimum(n, bend) for n, shape in enumerate(shapes, 1)}
    results, chosen = settle_contact([replace(make_result(0), minima=minima)] * 4, shapes)
    assert chosen == contact
    assert results[0].statistics.gap.minimum.value == (1.0 if contact == "line" else 2.0)
    assert len(note_contact(results, chosen)) == (contact == "journal")


def test_a_pin_in_a_bore_of_stated_shape_keeps_its_minimum():
    results = [make_result(0)]
    assert settle_contact(results, [GapShape.LINE]) == (results, GapShape.LINE)
    assert note_contact(results, GapShape.LINE) == []


def test_triggers_without_a_smooth_gap_are_counted():
    results, chosen = settle_contact(
        [result((1.0, 1.0)), result((1.0, 1.0), math.nan, misfit=8.0)], CONTACTS
    )
    _, note = note_contact(results, chosen)
    assert note.level is Level.WARNING
    assert "NaN at 1 of 2 triggers" in note.text


def test_a_contact_that_the_region_cuts_keeps_its_centre():
    cut = result((1.0, 1.0), misfit=8.0)
    unknown = FilmNumber.unknown(len(CALIBRATION.full_covariance))
    flat = cut.minima[GapShape.PLATEAU]._replace(minimum=unknown, misfit=0.0)
    cut = replace(cut, minima={**cut.minima, GapShape.PLATEAU: flat})
    results, chosen = settle_contact([cut, cut], CONTACTS)
    assert chosen is GapShape.PLATEAU
    assert results[0].statistics.gap.central.value == 4.0
    remarked, warned = note_contact(results, chosen)
    assert "plateau" in remarked.text
    assert warned.level is Level.WARNING
    assert "NaN at 2 of 2 triggers: the region of interest does not hold" in warned.text
