"""A patch of known film, and dyes that bleach, from frames to film."""

import numpy as np
import numpy.testing as npt
import pytest

import erlif
from conftest import Laboratory
from erlif.rig import RigSettings
from erlif.rig.dyes import BANDS, tabulate_signal

LOSS = (1e-3, 2e-3)
"""Shares of dye 1 and dye 2 that a pulse destroys."""

CORRECT = '\n[light]\nbleaching = "correct"\n'

RIG = RigSettings(
    width=128,
    height=96,
    spacing=6.0,
    cycles=3,
    fixture_frames=6,
    bubbles=0,
    reference=4.0,
    bleaching=LOSS,
)


@pytest.fixture(scope="module")
def dyes(tmp_path_factory):
    return Laboratory.simulated(tmp_path_factory.mktemp("reference"), seed=51, rig=RIG)


@pytest.fixture(scope="module")
def reported(dyes):
    return erlif.process(dyes.run, workers=2)


@pytest.fixture(scope="module")
def corrected(dyes):
    return dyes.process_copy("corrected", add=CORRECT)


def test_bleaching_is_that_of_the_dyes(reported, dyes):
    last = dyes.truth.sizes["frame"] - 1
    film = np.array(4.0)
    left = tuple((1 - loss) ** last for loss in LOSS)
    fresh, faded = (
        [float(tabulate_signal(band, share)(film)) for band in BANDS]
        for share in ((1.0, 1.0), left)
    )
    ratio = np.log(faded[1] / faded[0] * fresh[0] / fresh[1]) / last
    light = np.log(faded[0] / fresh[0]) / last
    assert abs(reported.bleaching_ratio - ratio) < 3 * reported.bleaching_ratio_std
    assert abs(reported.bleaching_light - light) < 3 * reported.bleaching_light_std
    assert abs(ratio) > 3 * reported.bleaching_ratio_std
    assert "as with dyes that bleach" in reported.attrs["notes"]
    assert "on the patch" in reported.attrs["notes"]


def test_cycles_show_the_bleaching_without_a_patch(dyes, reported):
    settings = (dyes.run / "run.toml").read_text(encoding="utf-8")
    patch = settings[settings.index("[reference]") :]
    plain = dyes.process_copy("cycles", (patch, ""))
    assert "reference_film" not in plain
    both = np.hypot(plain.bleaching_ratio_std, reported.bleaching_ratio_std)
    # the change depends a little on the film, which differs between patch and field
    slack = 0.5 * abs(float(reported.bleaching_ratio))
    assert abs(plain.bleaching_ratio - reported.bleaching_ratio) < 3 * both + slack
    assert plain.bleaching_ratio * reported.bleaching_ratio > 0
    assert "at equal triggers" in plain.attrs["notes"]


def test_film_of_the_patch_drifts_with_the_ratio_and_not_once_it_is_corrected(reported, corrected):
    off = float(abs(reported.reference_film - 4).mean())
    left = float(abs(corrected.reference_film - 4).mean())
    assert off > 2 * left
    npt.assert_array_less(
        abs(corrected.reference_film - 4), 3.5 * np.hypot(corrected.reference_film_std, 0.02)
    )
    assert "taken out of the ratio" in corrected.attrs["notes"]
    assert corrected.bleaching_ratio.attrs["corrected"] == "true"


def test_films_are_nearer_to_the_truth_once_it_is_corrected(dyes, reported, corrected):
    true = dyes.truth.film_min.values
    off, left = (float(abs(film.film_min - true).mean()) for film in (reported, corrected))
    assert left < 0.6 * off


def test_one_cycle_without_a_patch_cannot_be_corrected(lab):
    film = lab.process_copy("corrected", add=CORRECT)
    assert "cannot be separated from a change of the film" in film.attrs["notes"]


def test_a_wrong_film_of_the_patch_is_reported(dyes):
    """It is 0.6 um too thick, also where an error of the ratio of 5 % is allowed for."""
    changes = (
        ('thickness = "4 um"', 'thickness = "4.6 um"'),
        ('ratio = "0 %"', 'ratio = "5 %"'),
    )
    film = dyes.process_copy("wrong", *changes)
    assert "reference: " in film.attrs["notes"]
    assert "4.600 um known" in film.attrs["notes"].split("reference: ")[1]
    assert "Calibrate again" in film.attrs["notes"]
