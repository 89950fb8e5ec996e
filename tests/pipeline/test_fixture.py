"""A fixture directory to a calibration, and the calibration of a run."""

import shutil
from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest

import erlif
from erlif.core.progress import silent
from erlif.io.ingest import open_run
from erlif.pipeline.fixture import calibrate, combine_all, find_calibration
from erlif.rig.dyes import BANDS, tabulate_signal


@pytest.mark.parametrize("film", [1.0, 3.0, 10.0])
def test_calibration_is_the_ratio_of_the_dyes(calibration, film):
    """Slope of the log ratio by the spectra of the rig, whose integral is not the fitted model."""
    one, two = (tabulate_signal(band) for band in BANDS)
    near = film + np.array([-0.05, 0.05])
    expected = np.diff(np.log(two(near) / one(near)))
    npt.assert_allclose(np.diff(calibration.predict_log(near)), expected, rtol=0.05)


def test_calibration_records_its_day_and_its_inputs(small_rig, calibration, monkeypatch):
    """SOURCE_DATE_EPOCH replaces the time of the first frame: 86400 s is 2 January 1970."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    made = calibrate(small_rig.fixture)
    assert made.date == "1970-01-02"
    assert made.profile_file == "profile.csv"
    assert {"fixture.toml", "profile.csv"} <= {
        name.rpartition("/")[2] for name in made.input_hashes
    }
    npt.assert_array_equal(made.parameters, calibration.parameters)


def test_frames_of_a_film_at_rest_are_combined(prepared):
    """The mean of all frames has less noise than one of them; every frame is kept by number."""
    steps = []
    chain = prepared.chain
    pairs = replace(chain.pairs, skipped=dict.fromkeys((0, 3, 4), "left out"))
    few = replace(chain, correct=replace(chain.correct, pairs=pairs))
    ratio, frames = combine_all(few, lambda *step: steps.append(step))
    assert [one.frame for one in frames] == [1, 2, 5]
    assert steps == [("ratio", 1, 3), ("ratio", 2, 3), ("ratio", 3, 3)]
    single = chain.measure(1).to_images()
    valid = (ratio.flags.values == 0) & (single.flags.values.squeeze() == 0)
    noise = [np.median(one.log_ratio_var.values.squeeze()[valid]) for one in (ratio, single)]
    npt.assert_allclose(noise[1] / noise[0], 3, rtol=0.2)


def test_missing_calibration_is_made_and_kept_outside_the_run_only_if_allowed(
    lab, calibration, caplog
):
    kept = lab.fixture / "calibration.nc"
    kept.unlink()
    fitted = {}
    with caplog.at_level("INFO", logger="erlif"):
        made, again = (
            find_calibration(open_run(lab.run), None, progress=silent, fitted=fitted)[0]
            for _ in range(2)
        )
    npt.assert_array_equal(made.calibration.parameters, calibration.parameters)
    assert not kept.exists()
    assert caplog.text.count(f"it is kept by: erlif calibrate {lab.fixture}\n") == 1

    # of several runs the first has it fitted
    assert caplog.text.count("fit: started") == 1
    npt.assert_array_equal(again.calibration.covariance, made.calibration.covariance)

    # a link in the run directory leads outside all the same
    (lab.run / "fixture").symlink_to(lab.fixture)
    lab.edit("run/run.toml", ("../fixture", "fixture"))
    find_calibration(open_run(lab.run), None, progress=silent)
    assert not kept.exists()
    find_calibration(open_run(lab.run), None, allow_outside=True, progress=silent)
    kept = erlif.open_calibration(kept)
    npt.assert_array_equal(kept.parameters, calibration.parameters)


def test_a_calibration_within_the_run_directory_is_kept(lab):
    shutil.copytree(lab.fixture, lab.run / "fixture")
    (lab.run / "fixture" / "calibration.nc").unlink()
    lab.edit("run/run.toml", ("../fixture", "fixture"))
    find_calibration(open_run(lab.run), None, progress=silent)
    assert (lab.run / "fixture" / "calibration.nc").exists()
