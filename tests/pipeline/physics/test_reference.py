"""A patch of known film, and dyes that bleach, from frames to film."""

import shutil

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

import erlif
from erlif.rig import RigSettings, simulate
from erlif.rig.dyes import BANDS, tabulate_signal

LOSS = (1e-3, 2e-3)
"""Shares of dye 1 and dye 2 that a pulse destroys."""

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
def lab(tmp_path_factory):
    out = simulate(tmp_path_factory.mktemp("reference") / "lab", seed=51, rig=RIG)
    erlif.save_calibration(erlif.calibrate(out / "fixture"), out / "fixture" / "calibration.nc")
    return out


def process(lab, name, *, patch=True, light="", workers=1):
    """The run under other settings."""
    copy = shutil.copytree(lab / "run", lab / name)
    settings = copy / "run.toml"
    text = settings.read_text()
    if not patch:
        text = text[: text.index("[reference]")]
    settings.write_text(f"{text}\n[light]\n{light}\n")
    return erlif.process(copy, workers=workers)


@pytest.fixture(scope="module")
def reported(lab):
    return process(lab, "reported", workers=2)


@pytest.fixture(scope="module")
def corrected(lab):
    return process(lab, "corrected", light='bleaching = "correct"')


def test_bleaching_is_that_of_the_dyes(reported, lab):
    with xr.open_dataset(lab / "truth.nc", engine="h5netcdf") as truth:
        last = truth.sizes["frame"] - 1
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


def test_cycles_show_the_bleaching_without_a_patch(lab, reported):
    plain = process(lab, "cycles", patch=False)
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


def test_films_are_nearer_to_the_truth_once_it_is_corrected(lab, reported, corrected):
    with xr.open_dataset(lab / "truth.nc", engine="h5netcdf") as truth:
        true = truth.film_min.values
    errors = [float(abs(film.film_min - true).mean()) for film in (reported, corrected)]
    assert errors[1] < 0.6 * errors[0]


def test_one_cycle_without_a_patch_cannot_be_corrected(small_rig, tmp_path):
    copy = shutil.copytree(small_rig.run, tmp_path / "run")
    with (copy / "run.toml").open("a") as settings:
        settings.write('\n[light]\nbleaching = "correct"\n')
    calibration = small_rig.fixture / "calibration.nc"
    film = erlif.process(copy, calibration=calibration, workers=1)
    assert "cannot be separated from a change of the film" in film.attrs["notes"]


def test_a_wrong_film_of_the_patch_is_reported(lab):
    copy = shutil.copytree(lab / "run", lab / "wrong")
    settings = copy / "run.toml"
    text = settings.read_text()
    settings.write_text(text.replace('thickness = "4 um"', 'thickness = "4.6 um"'))
    film = erlif.process(copy, workers=1)
    assert "reference: " in film.attrs["notes"]
    assert "4.600 um known" in film.attrs["notes"].split("reference: ")[1]
    assert "Calibrate again" in film.attrs["notes"]
