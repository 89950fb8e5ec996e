"""The audit of a directory: findings in order, warnings where a result suffers, the first error."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scenes.tiff_pages import rewrite

import erlif
from conftest import SMALL, Laboratory
from erlif.core.notes import Level
from erlif.io.ingest import FramePairs, Page, frames, open_fixture
from erlif.review.check import examine
from erlif.review.check.directory import note_numbers, tabulate_pairs
from erlif.rig import simulate

content_of = frames.read_content


def about(notes, subject):
    return [note for note in notes if note.subject == subject]


def test_a_good_run_is_described_in_the_order_of_the_audit(lab):
    notes = erlif.check(lab.run)
    subjects = list(dict.fromkeys(note.subject for note in notes))
    main = ["frames", "counts", "pairs", "darks and flats", "registration", "encoder log"]
    assert [subject for subject in subjects if subject in main] == main
    assert subjects[-2:] == ["calibration", "ratio"]
    assert all(note.level is Level.NOTE for note in notes)


def test_a_fixture_is_examined_beside_a_run(lab):
    shutil.copy(lab.fixture / "fixture.toml", lab.run)
    shutil.copy(lab.fixture / "profile.csv", lab.run)
    run, fixture = examine(lab.run), examine(lab.run, fixture=True)
    assert about(run.notes, "encoder log")
    assert not about(run.notes, "profile")
    assert about(fixture.notes, "profile")
    assert not about(fixture.notes, "encoder log")


def test_a_frame_that_a_camera_has_lost_is_left_out_on_request(lab):
    lab.frames(2)[3].unlink()
    assert [note.level for note in erlif.check(lab.run)] == [Level.ERROR]
    notes = erlif.check(lab.run, skip_bad_frames=True)
    (left,) = [note for note in notes if note.level is not Level.NOTE]
    assert str(left) == "frame pair 3 left out: camera2/frame_0003.tif: the file is missing"
    assert about(notes, "frames")[0].text.startswith("5 ")


def test_highest_counts_and_saturation_of_each_camera_are_reported(lab):
    def saturate(counts):
        counts = counts.copy()
        counts[:2] = 4095  # two of 96 rows
        return counts

    rewrite(lab.frames(2)[3], saturate)
    one, two = about(erlif.check(lab.run), "counts")
    assert one.level is Level.NOTE
    assert two.level is Level.WARNING
    assert "highest count 4095 of 4095, at most 2.08% of a frame saturated. Shorten" in two.text


def test_the_triggers_of_a_run_without_a_log_are_not_those_of_a_log(tmp_path):
    """Without angles no cycle is known."""
    rig = replace(SMALL, mechanism="rotation", pictures=4, fixture_frames=1)
    lab = Laboratory(tmp_path)
    simulate(tmp_path, seed=3, rig=rig)
    text = (lab.run / "run.toml").read_text()
    (lab.run / "run.toml").write_text(re.sub(r"\[encoder\]\n(.+\n)+", "", text))
    about_triggers = [note for note in erlif.check(lab.run) if "4 triggers" in note.text]
    assert [note.subject for note in about_triggers] == ["no encoder log"]
    assert "cycle" not in about_triggers[0].text


@pytest.mark.parametrize("line", ["", 'calibration = "nowhere/calibration.nc"\n'])
def test_a_missing_calibration_is_a_warning(lab, line):
    lab.edit("run/run.toml", ('calibration = "../fixture/calibration.nc"\n', line))
    (note,) = about(erlif.check(lab.run), "calibration")
    assert note.level is Level.WARNING
    assert "--calibration" in note.text


def test_a_profile_out_of_order_is_a_warning_with_one_mention_of_its_subject(lab):
    path = lab.fixture / "profile.csv"
    header, *rows = path.read_text().splitlines()
    path.write_text("\n".join([header, *reversed(rows)]))
    note = about(erlif.check(lab.fixture), "profile")[0]
    assert note.level is Level.WARNING
    assert "sorted" in note.text
    assert str(note).count("profile:") == 1


def test_the_record_holds_findings_pairs_and_frames(lab):
    record = examine(lab.run).to_record()
    assert (record["errors"], record["warnings"]) == (0, 0)
    assert record["pairs"][0]["camera2"] == "frame_0000.tif"
    assert [one["frame"] for one in record["frames"]] == list(range(6))


def test_frames_of_a_long_recording_are_read_a_bounded_number_of_times(lab, monkeypatch):
    """One hundred pairs, all of them the six of the rig."""
    content = {n: [path.read_bytes() for path in lab.frames(n)] for n in (1, 2)}
    for n in (1, 2):
        for k in range(100):
            path = lab.run / f"camera{n}" / f"frame_{k:04d}.tif"
            path.write_bytes(content[n][k % 6])
    text = "frame,angle_deg\n" + "".join(f"{k},{10.0 * (k % 36)}\n" for k in range(100))
    (lab.run / "encoder.csv").write_text(text)
    lab.edit("run/run.toml", ('"rocker"', '"crank"'), ("triggers_per_cycle = 6", ""))

    read = []
    monkeypatch.setattr(
        frames, "read_content", lambda *a, **k: read.append(a) or content_of(*a, **k)
    )
    found = examine(lab.run)
    assert "counts of 24 of them, evenly spread, are examined" in found.notes[0].text
    assert len(found.survey.frames) == 24
    # 24 for the counts, 8 for darks and flats (twice), 12 to register, 4 as a sample, 16 in a row
    assert len(read) <= 2 * (24 + 8 + 8 + 12 + 4 + 16)


def test_the_audits_of_process_belong_to_check(two_cycles, tmp_path):
    shutil.copytree(two_cycles.run, tmp_path / "run")
    settings = tmp_path / "run" / "run.toml"
    text = settings.read_text(encoding="utf-8")
    settings.write_text(
        text.replace('mounted_on = "rocker"', 'mounted_on = "crank"'), encoding="utf-8"
    )
    texts = [note.text for note in examine(tmp_path / "run").notes if note.level == "warning"]
    assert sum("Set mounted_on = " in text for text in texts) == 1
    assert len(set(texts)) == len(texts)


def test_a_missing_number_is_named_for_each_camera():
    pages = tuple(
        tuple(Page(Path(f"camera{c}/frame_{k:04d}.tif"), 0) for k in (0, 1, 2, 4, 5))
        for c in (1, 2)
    )
    one, two = note_numbers(FramePairs(Path(), pages, (64, 64), (12, 12)))
    assert one.text.startswith("camera1: no file has the number 3, between frame_0000.tif and")
    assert two.text.startswith("camera2: no file has the number 3")


def test_the_table_has_files_rows_angles_and_times_of_the_log(run, small_rig):
    rows = tabulate_pairs(run, odd=[3])
    assert [row.pair for row in rows] == [0, 1, 3, 5]
    log = np.genfromtxt(small_rig.run / "encoder.csv", delimiter=",", names=True)
    row = rows[2]
    assert (row.camera1, row.camera2, row.row) == ("frame_0003.tif", "frame_0003.tif", 3)
    assert (row.angle, row.time) == (log["angle_deg"][3], log["time_s"][3])
    assert str(row).startswith("pair 3: frame_0003.tif with frame_0003.tif, log frame 3, ")


def test_a_fixture_has_no_log(small_rig):
    assert tabulate_pairs(open_fixture(small_rig.fixture))[0].row is None
