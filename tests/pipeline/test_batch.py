"""Many runs: order, outcomes, defaults, resumption, and what is refused before any run begins."""

import importlib
import shutil

import pytest

import erlif
from erlif.core.errors import ConfigError
from erlif.io.ingest import RunEntry
from erlif.pipeline.batch import RunState, batch, list_runs

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("without_theory")]

MODULE = importlib.import_module("erlif.pipeline.batch")
"""The module; the package has the function under the same name."""


def days(series):
    return [series / name for name in ("monday", "tuesday", "wednesday")]


def states(outcomes):
    return [outcome.state for outcome in outcomes]


def test_outcomes_and_progress_are_reported_as_they_are_known(series):
    """The name of the run stands in the progress; an interruption ends all."""
    seen, steps = [], []

    def follow(*step):
        steps.append(step)
        if step[0] == "tuesday, registration":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        batch(days(series), report=seen.append, progress=follow, skip_bad_frames=True)
    assert [outcome.run_dir.name for outcome in seen] == ["monday"]
    assert ("monday, film", 6, 6) in steps


def test_a_defect_does_not_end_the_others(series, monkeypatch, caplog):
    def fail(*arguments, **options):
        monkeypatch.undo()
        raise ZeroDivisionError("a slip")

    monkeypatch.setattr(MODULE, "process_run", fail)
    outcomes = batch([days(series)[0], days(series)[2]])
    assert states(outcomes) == [RunState.DEFECT, RunState.FINISHED]
    assert "a slip" in outcomes[0].message
    assert "report" in caplog.text


# resumption


@pytest.fixture
def no_work(monkeypatch):
    """Fails where a run is computed."""

    def fail(*arguments, **options):
        raise AssertionError("work has started")

    return lambda: monkeypatch.setattr("erlif.pipeline.recording.prepare.prepare_chain", fail)


def test_a_finished_zarr_is_not_computed_again(series, no_work):
    entries = [RunEntry(series / "monday", output=series / "film.zarr")]
    batch(entries)
    before = (series / "film.zarr").stat().st_mtime_ns
    no_work()
    assert states(batch(entries, resume=True)) == [RunState.FINISHED_BEFORE]
    assert (series / "film.zarr").stat().st_mtime_ns == before


def change_settings(run):
    text = (run / "run.toml").read_text(encoding="utf-8")
    (run / "run.toml").write_text(text.replace("222.411 N", "200 N"), encoding="utf-8")


def change_log(run):
    with (run / "encoder.csv").open("a", encoding="utf-8") as file:
        file.write("\n")


@pytest.mark.parametrize("change", [change_settings, change_log])
def test_a_film_of_other_work_is_not_taken_for_this_one(series, film, change):
    run = series / "monday"
    shutil.copy(film, run / "film.nc")
    change(run)
    (outcome,) = batch([run], resume=True)
    assert outcome.state is RunState.REFUSED
    assert "other inputs or settings" in outcome.message


def test_a_failed_run_is_tried_again(series, film, small_rig):
    for name in ("monday", "wednesday"):
        shutil.copy(film, series / name / "film.nc")
    assert [outcome.failed for outcome in batch(days(series), resume=True)] == [False, True, False]
    shutil.copy(small_rig.frames(1)[2], series / "tuesday" / "camera1" / "frame_0002.tif")
    assert states(batch(days(series), resume=True)) == [
        RunState.FINISHED_BEFORE,
        RunState.FINISHED,
        RunState.FINISHED_BEFORE,
    ]


# tables


def test_rows_of_a_table_have_their_own_calibration_and_output(series, film):
    for run in ("monday", "wednesday"):
        text = (series / run / "run.toml").read_text(encoding="utf-8")
        (series / run / "run.toml").write_text(text.partition("\n")[2], encoding="utf-8")
    table = series / "runs.csv"
    table.write_text(
        "run_dir,calibration,output\n"
        "monday,fixture/calibration.nc,out/monday.nc\n"
        "wednesday,,out/wednesday.nc\n"
    )
    missing = batch([table])
    assert states(missing) == [RunState.REFUSED] * 2
    assert f"{series / 'out'} is none, of which {series} exists" in missing[0].message
    assert not (series / "out").exists()

    (series / "out").mkdir()
    outcomes = batch([table])
    assert states(outcomes) == [RunState.FINISHED, RunState.REFUSED]
    assert "run.toml names none" in outcomes[1].message
    (outcome,) = batch([series / "wednesday"], calibration=series / "fixture" / "calibration.nc")
    assert outcome.output == series / "wednesday" / "film.nc"
    with erlif.open_film(outcome.output) as one, erlif.open_film(series / "out/monday.nc") as two:
        assert one.thickness.identical(two.thickness)


def test_a_table_stands_among_directories_in_its_place(tmp_path):
    """A run directory may have the suffix of a table."""
    (tmp_path / "runs.csv").write_text("run_dir\nb\nc\n")
    (tmp_path / "d.csv").mkdir()
    found = list_runs([tmp_path / "a", tmp_path / "runs.csv", str(tmp_path / "d.csv")])
    assert [entry.run_dir.name for entry in found] == ["a", "b", "c", "d.csv"]
    assert found[1].output == tmp_path / "b" / "film.nc"


# refused before any run begins


def test_a_directory_given_by_a_link_as_well_is_refused(series):
    (series / "first").symlink_to(series / "monday")
    with pytest.raises(ConfigError, match=r"first is given twice, also as .*monday"):
        batch([series / "monday", series / "first"])


def test_no_run_is_refused():
    with pytest.raises(ConfigError, match="got none"):
        batch([])
