"""The list of audits; mistakes and sound runs through `process`."""

import re
import shutil
import time
from dataclasses import replace

import pytest
from damages.mistakes import MISTAKES, RIGS
from damages.sound import draw_sound, use_instruments
from scenes.measured import statistics_of

import erlif
from conftest import FULL, Laboratory
from erlif.core.errors import ErlifError
from erlif.core.notes import Level, Note, split_notes, warn
from erlif.pipeline.audit.audits import AUDITS, audit_run, note_copied_cameras
from erlif.pipeline.audit.evidence import Evidence
from erlif.pipeline.engines.results import FrameResult, frames_in
from erlif.rig import simulate

LONGEST = 0.3
"""Processor time of all audits of a run. [s]"""

CHOSEN = (
    "bit 5 of camera 1 is never set",
    "load in kgf under load_N",
    "time in ms, law",
    "load of row 20 times 1000",
    "reading of row 12 off by -8 degrees, law",
    "log late by 1, law",
    "3 pairs of the fixture from pair 20, law",
    "stated on the crank, logged on the rocker",
    "calibration of erlif 99.0.0",
)


def test_each_audit_has_a_name_of_its_own():
    assert len({audit.name for audit in AUDITS}) == len(AUDITS)


def warnings_of(film):
    notes = split_notes(film.attrs["notes"])
    return [text for level, text in notes if level is not Level.NOTE]


@pytest.fixture(scope="module")
def law(tmp_path_factory):
    """A sound run whose film is a power of the speed; never to be changed."""
    directory = tmp_path_factory.mktemp("law")
    return Laboratory.simulated(directory, seed=40, rig=RIGS["law"])


@pytest.fixture(scope="module")
def evidence(law):
    """What the audits look at, as `process` gives it to them; never to be changed."""
    given = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            "erlif.pipeline.film.audit_run", lambda one: given.append(one) or audit_run(one)
        )
        assert warnings_of(statistics_of(law.run)) == []
    return given[0]


def test_a_sound_run_has_no_warning_and_its_audits_take_no_time(evidence):
    audit_run(evidence)  # what is slow to load is loaded
    start = time.process_time()
    assert audit_run(evidence) == []
    assert time.process_time() - start < LONGEST


def test_a_warning_stands_once_whatever_finds_it(evidence):
    doubled = replace(
        evidence, faults=(*evidence.faults, *2 * [Note(Level.WARNING, "bits", "bit 5")])
    )
    assert [note.text for note in audit_run(doubled)] == ["bit 5"]


def test_a_dark_stands_between_what_looks_like_one_and_what_follows_from_it(evidence):
    dark, bit = warn("camera1", "off by the dark"), warn("bits", "bit 5")
    log = evidence.run.log.assign(joint_load=evidence.run.log.joint_load / 1e3)
    run = replace(evidence.run, log=log)
    found = audit_run(replace(evidence, run=run, faults=[bit], darks=[dark]))
    assert found[:2] == [bit, dark]
    assert "kN" in found[2].text


def test_a_failure_of_an_audit_is_a_warning(evidence):
    broken = replace(evidence, located=evidence.located.isel(frame=slice(0, 20)))
    assert any(
        note.text.startswith("readings of the encoder could not") for note in audit_run(broken)
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", CHOSEN)
def test_the_mistake_is_named_first(law, tmp_path, name):
    """Of a film without theory, whose notes come last."""
    (mistake,) = (one for one in MISTAKES if one.name == name)
    for part in ("run", "fixture"):
        shutil.copytree(law.directory / part, tmp_path / part)
    mistake.change(tmp_path)
    try:
        found = warnings_of(statistics_of(tmp_path / "run"))
    except ErlifError as error:
        found = [str(error)]
    assert re.search(mistake.cause, found[0])
    assert len(set(found)) == len(found)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(40 if FULL else 3))
def test_a_sound_rig_of_any_kind_has_no_alarm(monkeypatch, tmp_path, seed):
    found = []

    def end(ready, triggers, results):
        evidence = Evidence(ready.run, ready.cycle, frames_in(results), ready.faults)
        found.append(audit_run(evidence))
        raise ErlifError("enough")

    monkeypatch.setattr("erlif.pipeline.run.summarise_triggers", end)
    rig, instruments = draw_sound(seed)
    simulate(tmp_path / "rig", seed=700 + seed, rig=rig)
    use_instruments(tmp_path / "rig" / "run", instruments)
    with pytest.raises(ErlifError, match="enough"):
        erlif.process(tmp_path / "rig" / "run", workers=1)
    assert found == [[]]


def pair(number, one, two):
    return FrameResult(number, (0.0, 0.0), (0, 0), digests=(one, two))


def test_pairs_of_one_file_are_named():
    (note,) = note_copied_cameras([pair(0, "a", "b"), pair(1, "c", "c"), pair(2, "", "")])
    assert note.level == "warning"
    assert "both cameras show the same image in frame pairs 1, whose films" in note.text
    assert list(note_copied_cameras([pair(0, "a", "b"), pair(2, "", "")])) == []
