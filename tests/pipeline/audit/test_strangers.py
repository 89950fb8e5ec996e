"""Pairs of other recordings by the form of their film."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from erlif.pipeline.audit.evidence import Evidence
from erlif.pipeline.audit.strangers import find_groups, form_changes, note_strangers
from erlif.pipeline.engines.results import FrameResult
from erlif.ratio import NO_DARK, NO_PULSE

PLACES = np.linspace(-1, 1, 64)


def ratios(count=50, *, seed=1, own=lambda h: np.log1p(h[:, None] + 0.6 * PLACES**2)):
    """Logarithms of ratios of a gap that opens and closes, with the noise of a small frame."""
    film = 1 + np.abs(np.sin(np.arange(count) / 8))
    return own(film) + 0.003 * np.random.default_rng(seed).normal(size=(count, 64))


def wedge(count):
    return np.tile(np.log1p(1.5 + PLACES), (count, 1))


def evidence(found, *, border=None, **log):
    """Frames with these ratios, and light [DN] of both cameras on pixels at their border."""
    frames = [
        FrameResult(
            frame=k,
            drift=(0.0, 0.0),
            peaks=(3000, 2500),
            pulse=NO_PULSE._replace(log_ratio=row),
            dark=NO_DARK if border is None else tuple((light, 9.0) for light in border[k]),
        )
        for k, row in enumerate(found)
    ]
    table = xr.Dataset({name: ("frame", one) for name, one in log.items()})
    return Evidence(SimpleNamespace(log=table), xr.Dataset(), frames)


@pytest.mark.parametrize("seed", range(10))
def test_a_gap_that_opens_and_closes_has_no_jump(seed):
    assert form_changes(ratios(seed=seed)).max() < 2


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ([20, 21, 22], "pairs 20 to 22 are of another run or of the fixture"),
        ([30], "pair 30 is of another run or of the fixture"),
        ([0, 1, 2], "pairs 0 to 2 "),
        ([47, 48, 49], "pairs 47 to 49 "),
    ],
)
def test_pairs_of_a_wedge_are_found(rows, words):
    found = ratios()
    found[rows] = wedge(len(rows))
    (note,) = note_strangers(evidence(found))
    assert words in note.text
    assert note.level == "warning"


def test_pairs_of_a_wedge_are_found_as_recorded_where_frames_of_cycles_are_in_groups():
    """Frames 0, 12, 24 of three cycles are of one trigger; within a group no film changes."""
    found = np.tile(ratios(12), (3, 1))
    found[14:17] = wedge(3)
    grouped = np.arange(36).reshape(3, 12).T.ravel()
    whole = evidence(found)
    (note,) = note_strangers(replace(whole, frames=[whole.frames[k] for k in grouped]))
    assert "pairs 14 to 16 are" in note.text


@pytest.mark.parametrize(("rows", "words"), [([5], "pair 5 is"), ([10, 11], "pairs 10 to 11 are")])
def test_pairs_of_a_wedge_are_found_where_the_film_is_at_rest(rows, words):
    found = ratios(20, own=lambda h: np.tile(np.log1p(1.5 + 0.6 * PLACES**2), (h.size, 1)))
    assert list(note_strangers(evidence(found))) == []
    found[rows] = wedge(len(rows))
    (note,) = note_strangers(evidence(found))
    assert words in note.text


@pytest.mark.parametrize(
    ("rows", "light", "words"),
    [
        ([7], (1800, 1700), "pair 7 is of another run"),
        (list(range(5, 15)), (1800, 1700), "pairs 5, 6"),
        (list(range(20)), (1800, 1700), ""),  # an offset of all frames
        ([7, 8], (60, 55), ""),  # a lamp in the room
        ([7, 8], (1800, 0), ""),  # one camera
    ],
)
def test_pairs_with_light_where_the_others_have_none_are_named(rows, light, words):
    border = np.random.default_rng(2).normal(0, 2, (20, 2))
    border[rows] += light
    found = [note.text for note in note_strangers(evidence(ratios(20), border=border))]
    assert len(found) == bool(words)
    assert all(text.startswith(words) and "in both cameras" in text for text in found)


def test_places_without_film_do_not_count():
    found = ratios()
    found[np.random.default_rng(4).random(found.shape) < 0.2] = np.nan
    assert list(note_strangers(evidence(found))) == []


def test_a_step_of_the_load_is_no_stranger():
    found = ratios()
    found[40:] += np.log1p(0.2 * PLACES)
    assert len(list(note_strangers(evidence(found)))) == 1
    load = np.where(np.arange(50) < 40, 200.0, 400.0)
    assert list(note_strangers(evidence(found, joint_load=load))) == []


def test_a_load_that_rises_and_falls_again_makes_no_strangers():
    """A program of 200, 400 and 200 N, with a tilt under the higher load."""
    found = ratios()
    found[25:40] += np.log1p(0.2 * PLACES)
    (note,) = note_strangers(evidence(found))
    assert "pairs 25 to 39 " in note.text
    load = np.full(50, 200.0)
    load[25:40] = 400.0
    assert list(note_strangers(evidence(found, joint_load=load))) == []

    # a step of the load on one side alone explains one jump of the two
    load[:25] = 400.0
    assert len(list(note_strangers(evidence(found, joint_load=load)))) == 1


def test_the_longest_part_is_the_run():
    assert find_groups(np.array([9, 10, 24, 25]), 50) == [(10, 10), (25, 25)]
    assert find_groups(np.array([24]), 50) == []
