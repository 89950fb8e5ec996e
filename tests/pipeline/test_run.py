"""A run to its film: what is returned, what identifies the work, what -v shows."""

import importlib
import logging
import re
from dataclasses import replace

import pytest
import xarray as xr
from click.testing import CliRunner

import erlif
from erlif.commands.log import show_log
from erlif.commands.main import main
from erlif.core.errors import OutputError
from erlif.io.files import describe_hashes
from erlif.io.ingest import InputChangedError, hash_files_beside_frames, hash_inputs, open_run
from erlif.pipeline.work import identify_start, identify_work

STAGES = ("darks and flats", "registration", "sharpness and noise", "film", "writing")

DECISIONS = {
    "frame pairs": r"6 frame pairs of 128 x 96 pixels, 0 left out",
    "triggers and cycles": r"6 triggers in 1 cycle, joint speed up to 2\.\d+ rad/s",
    "gain of camera 1": r"camera1 gain 4\.\d+ ± 0\.\d+ electron/DN",
    "gain of camera 2": r"camera2 gain 4\.\d+ ± 0\.\d+ electron/DN",
    "camera map": r"rms displacement \d+\.\d+ px, correlation of the textures 0\.\d+",
    "blur difference": r"difference of blur variance \S+ px2 along x, \S+ px2 along y",
    "calibration and range": r"calibration '.+' of .+, calibrated range \d+\.\d+ to \d+\.\d+ um",
    "exponent": r"minimum film thickness \d+\.\d+ to \d+\.\d+ um, speed exponent \S+ ± \S+",
    "file": r"film\.nc written, \d+\.\d+ MB",
}


@pytest.fixture(scope="module")
def lines(small_rig, tmp_path_factory):
    """Lines on standard error of `erlif process`, with -v and without."""
    out, shown = tmp_path_factory.mktemp("log"), {}
    for name, options in (("-v", ["-v"]), ("plain", [])):
        target = out / name / "film.nc"
        target.parent.mkdir()
        result = CliRunner().invoke(
            main, [*options, "process", str(small_rig.run), "-o", str(target)]
        )
        assert result.exit_code == 0, result.output
        shown[name] = result.stderr.splitlines()
    show_log(0)
    return shown


@pytest.mark.parametrize("name", STAGES)
def test_each_stage_is_shown_with_its_duration(lines, name):
    found = [line for line in lines["-v"] if re.search(rf": {name}: finished after", line)]
    assert len(found) == 1
    assert re.search(r"finished after \d+\.\d\d s, processor \d+\.\d\d s", found[0])


def test_stages_are_shown_in_their_order(lines):
    text = "\n".join(lines["-v"])
    places = [text.index(f": {name}: started") for name in STAGES]
    assert places == sorted(places)


@pytest.mark.parametrize("decision", DECISIONS)
def test_decisions_are_shown(lines, decision):
    assert any(re.search(DECISIONS[decision], line) for line in lines["-v"])


@pytest.mark.parametrize("text", ["started", "finished after", *DECISIONS.values()])
def test_without_v_nothing_of_it_is_shown(lines, text):
    assert not any(re.search(text, line) for line in lines["plain"])


def test_log_stays_quiet_afterwards():
    assert logging.getLogger("erlif").getEffectiveLevel() >= logging.WARNING


# results


def test_film_without_an_output_is_the_one_that_is_written(small_rig, film):
    with erlif.open_film(film) as written:
        xr.testing.assert_identical(erlif.process(small_rig.run), written.load())


def test_existing_output_is_refused_before_the_work_starts(small_rig, film):
    def fail(*step):
        raise AssertionError("work has started")

    with pytest.raises(OutputError, match="--overwrite"):
        erlif.process(small_rig.run, output=film, progress=fail)


# identity of the work

HASHES = {"run.toml": "ab" * 32}


def test_same_inputs_are_the_same_work(run, calibration):
    assert identify_work(run, calibration, HASHES) == identify_work(
        replace(run), replace(calibration), dict(HASHES)
    )


def change_settings(run, calibration):
    joint = run.settings.joint.model_copy(update={"load": 200.0})
    return replace(run, settings=run.settings.model_copy(update={"joint": joint})), calibration


def change_pairs(run, calibration):
    return replace(run, pairs=replace(run.pairs, skipped={3: "damaged"})), calibration


def change_calibration(run, calibration):
    return run, replace(calibration, ratio_at_zero=calibration.ratio_at_zero * 1.001)


@pytest.mark.parametrize("change", [change_settings, change_pairs, change_calibration])
def test_other_inputs_are_other_work(run, calibration, change):
    other = identify_work(*change(run, calibration), HASHES)
    assert other != identify_work(run, calibration, HASHES)


def test_other_files_are_other_work(run, calibration):
    other = identify_work(run, calibration, {"run.toml": "cd" * 32})
    assert other != identify_work(run, calibration, HASHES)


def test_a_frame_replaced_after_its_film_was_computed_is_refused(lab):
    def spoil(what, done, total):
        """Replace a frame once the film is computed."""
        if (what, done) == ("film", total):
            lab.frames(1)[3].write_bytes(lab.frames(1)[2].read_bytes())

    with pytest.raises(InputChangedError, match=r"frame_0003\.tif was changed or replaced"):
        erlif.process(lab.run, progress=spoil)


def test_a_film_has_the_hashes_of_its_inputs(lab):
    film = erlif.process(lab.run)
    assert film.attrs["input_hashes"] == describe_hashes(hash_inputs(open_run(lab.run)))


def test_a_changed_frame_is_other_unfinished_work(lab, calibration):
    def key():
        recording = open_run(lab.run)
        return identify_start(recording, calibration, hash_files_beside_frames(recording))

    before = key()
    assert key() == before
    path = lab.frames(2)[1]
    path.write_bytes(path.read_bytes())  # the same bytes, written later: not known to be the same
    assert key() != before


@pytest.mark.parametrize("name", ["camera2/frame_0001.tif", "camera1_flat.tif", "encoder.csv"])
def test_an_input_replaced_while_it_is_processed_is_refused(lab, monkeypatch, name):
    """The frame is replaced between the camera map and its film."""
    module = importlib.import_module("erlif.pipeline.run")
    measure_run = module.measure_run

    def replace_and_run(*arguments, **options):
        path = lab.run / name
        path.write_bytes(path.read_bytes())
        return measure_run(*arguments, **options)

    monkeypatch.setattr(module, "measure_run", replace_and_run)
    result = CliRunner().invoke(main, ["process", str(lab.run)])
    assert result.exit_code == 2
    assert f"{name} was changed or replaced" in result.stderr
    assert not list(lab.run.glob("film.nc*"))
