"""Run and fixture directories, in the forms in which a rig may write them."""

import json
import shutil

import numpy as np
import pytest
import tifffile

from erlif.core.errors import EncoderError, FrameError
from erlif.io.ingest import open_run, read_frames
from erlif.io.ingest.recording import read_so_far
from erlif.io.settings import EncoderSettings


def test_a_run_has_settings_frames_and_log(lab):
    recording = open_run(lab.run)
    assert recording.directory == lab.run
    assert [camera.band for camera in recording.cameras] == [580, 610]
    assert recording.pairs.usable == list(range(6))
    assert recording.pairs.shape == (96, 128)
    written = np.genfromtxt(lab.run / "encoder.csv", delimiter=",", names=True)
    np.testing.assert_array_equal(recording.log.angle, written["angle_deg"])
    np.testing.assert_array_equal(recording.log.time, written["time_s"])


def test_absolute_patterns_and_unusual_directory_names_are_found(lab, tmp_path):
    unusual = tmp_path / "Lauf [1] – 80W-90 µm ²"
    lab.edit("run/run.toml", ('"camera1/*.tif"', json.dumps(f"{tmp_path}/camera1/*.tif")))
    recorded = [[tifffile.imread(path) for path in lab.frames(camera)] for camera in (1, 2)]
    lab.run.rename(unusual)
    shutil.move(unusual / "camera1", tmp_path / "camera1")
    pairs = open_run(unusual, allow_outside=True).pairs
    np.testing.assert_array_equal(read_frames(pairs, range(6)).counts.values, recorded)
    (tmp_path / "camera1" / "frame_0003.tif").write_bytes(b"")
    with pytest.raises(FrameError, match=r"frame_0003\.tif: the file is empty"):
        open_run(unusual, allow_outside=True)


@pytest.mark.parametrize("cameras", [(1,), (2,), (1, 2)])
def test_a_pulse_without_its_frames_keeps_its_row(lab, cameras):
    for camera in cameras:
        lab.frames(camera)[2].unlink()
    with pytest.raises((FrameError, EncoderError), match="Use --skip-bad-frames to leave"):
        open_run(lab.run)
    run = open_run(lab.run, skip_bad_frames=True)
    assert run.pairs.usable == [0, 1, 3, 4, 5]
    written = np.genfromtxt(lab.run / "encoder.csv", delimiter=",", names=True)
    np.testing.assert_array_equal(run.log.angle, written["angle_deg"])


def test_rows_after_the_last_frame_are_left_out_where_the_numbers_are_those_of_the_files(lab):
    for camera in (1, 2):
        for path in lab.frames(camera)[4:]:
            path.unlink()
    with pytest.raises(EncoderError, match=r"4 frames each.*Use --skip-bad-frames to leave out"):
        open_run(lab.run)
    run = open_run(lab.run, skip_bad_frames=True)
    written = np.genfromtxt(lab.run / "encoder.csv", delimiter=",", names=True)
    np.testing.assert_array_equal(run.log.angle, written["angle_deg"][:4])
    assert "frames 4 to 5 have no files and are left out" in [note.text for note in run.log_notes]
    # with other numbers of the files the first row may be the one without a frame
    for camera in (1, 2):
        for path in lab.frames(camera)[::-1]:
            path.rename(path.with_name(f"frame_{int(path.stem[-4:]) + 1:04d}.tif"))
    with pytest.raises(EncoderError, match="6 rows, the cameras have 4 frames"):
        open_run(lab.run, skip_bad_frames=True)


def test_a_log_without_the_row_of_a_pulse_that_both_cameras_lack_fits_the_others(lab):
    for camera in (1, 2):
        lab.frames(camera)[2].unlink()
    log = lab.run / "encoder.csv"
    head, *rows = log.read_text().splitlines()
    del rows[2]
    rows = [f"{n},{row.partition(',')[2]}" for n, row in enumerate(rows)]
    log.write_text("\n".join([head, *rows]) + "\n")
    run = open_run(lab.run, skip_bad_frames=True)
    assert run.pairs.usable == list(range(5))
    np.testing.assert_array_equal(run.log.angle, open_run(lab.run).log.angle)
    # one row less: neither count fits
    log.write_text("\n".join([head, *rows[:-1]]) + "\n")
    with pytest.raises(EncoderError, match="has 4 rows, the cameras have 5 frames"):
        open_run(lab.run, skip_bad_frames=True)


def test_a_run_without_an_encoder_opens(lab):
    text = (lab.run / "run.toml").read_text(encoding="utf-8")
    kept = text.partition("[encoder]")[0] + "[thickness]" + text.partition("[thickness]")[2]
    (lab.run / "run.toml").write_text(kept, encoding="utf-8")
    run = open_run(lab.run)
    assert set(run.log) == {"number"}
    assert run.log_notes == []


def test_a_log_that_lacks_a_row_is_not_taken_for_one_in_time(lab):
    """Six frames, and five rows without numbers of frames."""
    header, *rows = (lab.run / "encoder.csv").read_text(encoding="utf-8").splitlines()
    rows = [row.split(",", 1)[1] for row in (header, *rows[:3], *rows[4:])]
    (lab.run / "encoder.csv").write_text("\n".join(rows), encoding="utf-8")
    before = float(rows[3].split(",")[rows[0].split(",").index("time_s")])
    with pytest.raises(EncoderError) as refused:
        open_run(lab.run)
    found = f"5 rows for 6 frames: a row is missing, perhaps after the one at {before:.6g} s"
    assert found in str(refused.value)


def test_darks_and_flats_under_the_pattern_of_the_frames_are_named(lab):
    lab.edit("run/run.toml", ('"camera1/*.tif"', '"**/*1*.tif"'))
    with pytest.raises(FrameError) as refused:
        open_run(lab.run)
    assert "among them camera1_dark.tif (dark), camera1_flat.tif (flat)" in str(refused.value)


# a log that is being written

TIMES = np.arange(200) / 100
ANGLES = 20 * np.sin(TIMES)


def write_in_time(lab, columns, keys, rows=200, pulses=None):
    """A log of 100 rows a second; gives the settings."""
    values = [TIMES, ANGLES] if pulses is None else [TIMES, ANGLES, pulses]
    table = np.column_stack(values)[:rows]
    head = f"time_s,angle_deg{columns}"
    np.savetxt(lab.run / "encoder.csv", table, delimiter=",", header=head, comments="")
    return EncoderSettings(file="encoder.csv", **keys)


def test_angles_of_a_log_by_frame_come_row_by_row(lab):
    log = lab.run / "encoder.csv"
    encoder = EncoderSettings(file="encoder.csv")
    text = log.read_text()
    angles = np.genfromtxt(log, delimiter=",", names=True)["angle_deg"]
    np.testing.assert_array_equal(read_so_far(lab.run, encoder, 6)["angle"], angles)
    np.testing.assert_array_equal(read_so_far(lab.run, encoder, 4)["angle"], angles[:4])
    loads = np.genfromtxt(log, delimiter=",", names=True)["load_N"]
    np.testing.assert_array_equal(read_so_far(lab.run, encoder, 6)["joint_load"], loads)
    log.write_text(text[:-3])  # the last row is begun
    np.testing.assert_array_equal(read_so_far(lab.run, encoder, 6)["angle"], angles[:5])
    log.unlink()
    with pytest.raises(OSError, match="encoder"):
        read_so_far(lab.run, encoder, 6)


@pytest.mark.parametrize("rows", [60, 200])
def test_angles_of_a_log_in_time_come_as_far_as_it_has_the_pulses(lab, rows):
    pulse = np.where(np.arange(200) % 25 == 12, 5.0, 0.01)
    expected = 20 * np.sin((np.arange(8) * 25 + 11.5) / 100)[: (rows - 13) // 25 + 1]
    encoder = write_in_time(lab, ",trigger_V", {"pulse": "trigger_V"}, rows, pulse)
    found = read_so_far(lab.run, encoder, 8)["angle"]
    np.testing.assert_allclose(found, expected, atol=1e-3)
    assert read_so_far(lab.run, encoder, 2)["angle"].size == 2

    encoder = write_in_time(lab, "", {"frame_rate": "4 Hz", "start": "0.115 s"}, rows)
    np.testing.assert_allclose(read_so_far(lab.run, encoder, 8)["angle"], expected, atol=1e-3)
    encoder = write_in_time(lab, "", {"frame_rate": "4 Hz", "start": "fit"}, rows)
    assert read_so_far(lab.run, encoder, 8)["angle"].size == 0
