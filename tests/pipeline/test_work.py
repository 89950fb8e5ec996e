"""What identifies the work on a film."""

from dataclasses import replace

from erlif.calibration import RunCurve
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
