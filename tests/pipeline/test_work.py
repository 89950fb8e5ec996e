"""What identifies the work on a film, and unfinished work of other frames."""

from dataclasses import replace

from erlif.calibration import RunCurve
from erlif.io.ingest import hash_files_beside_frames, open_run, sign_inputs
from erlif.pipeline.work import FilmWork


def change_settings(work):
    joint = work.run.settings.joint.model_copy(update={"load": 200.0})
    settings = work.run.settings.model_copy(update={"joint": joint})
    return replace(work, run=replace(work.run, settings=settings))


def change_pairs(work):
    pairs = replace(work.run.pairs, skipped={3: "damaged"})
    return replace(work, run=replace(work.run, pairs=pairs))


def change_calibration(work):
    fixture = work.curve.calibration
    other = replace(fixture, ratio_at_zero=1.001 * fixture.ratio_at_zero)
    return replace(work, curve=replace(work.curve, calibration=other))


def test_work_is_known_by_its_inputs(run, calibration, tmp_path):
    work = FilmWork.of(run, RunCurve.of(calibration), tmp_path / "film.nc")
    known = work.identify("inputs")
    assert replace(work, run=replace(run)).identify("inputs") == known
    assert work.identify("other inputs") != known
    for change in (change_settings, change_pairs, change_calibration):
        assert change(work).identify("inputs") != known


def test_a_changed_frame_is_other_unfinished_work(lab):
    def key():
        recording = open_run(lab.run)
        return sign_inputs(recording, hash_files_beside_frames(recording))

    before = key()
    assert key() == before
    path = lab.frames(2)[1]
    path.write_bytes(path.read_bytes())  # the same bytes, written later: not known to be the same
    assert key() != before
