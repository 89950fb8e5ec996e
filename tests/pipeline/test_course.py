"""A run whose camera 2 grows brighter and is bumped, from frames to film."""

import numpy as np
import pytest

import erlif
from conftest import Laboratory
from erlif.rig import RigSettings

RIG = RigSettings(
    width=128,
    height=96,
    spacing=1.2,
    fixture_frames=6,
    bubbles=0,
    gain_step=(18, 1.05),
    bump=(25, 6.0, 0.0),
)
"""Forty frames of one cycle."""


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    return Laboratory.simulated(tmp_path_factory.mktemp("course"), seed=41, rig=RIG)


@pytest.fixture(scope="module")
def film(lab):
    # as a lab that trusts its gains: nothing but the run shows the step
    return erlif.process(lab.copy_run("trusted", ("[systematics]", '[systematics]\nratio = "0 %"')))


def notes_on(film, subject):
    return [line for line in film.attrs["notes"].splitlines() if f"{subject}: from" in line]


def test_step_and_bump_are_named_with_their_frames(film):
    (step,) = notes_on(film, "course")
    assert any(f"from frame {frame} on" in step for frame in (17, 18, 19))
    (bump,) = notes_on(film, "registration")
    assert "from frame 25 on" in bump
    assert "along x" in bump


def test_error_of_the_mean_film_holds_the_step(lab, film):
    """Of the films after the step, which read a third too thick, most are within two std."""
    true = lab.truth.film.values
    off = [
        np.nanmean(np.where(film.thickness[k] > 0, film.thickness[k] - true[k], np.nan))
        for k in range(film.sizes["trigger"])
    ]
    after = np.arange(len(off)) >= 20
    known = after & np.isfinite(film.film_mean_std.values) & np.isfinite(off)
    pull = np.abs(off)[known] / film.film_mean_std.values[known]
    assert np.median(np.array(off)[known]) > 0.5
    assert np.mean(pull < 2) > 0.9
    assert "scale of the ratio" in film.attrs["largest_error"]
