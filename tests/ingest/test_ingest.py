"""Run and fixture directories to frames and log, in all the forms in which a rig may write them."""

import contextlib
import json
import os
import shutil
from pathlib import Path, PurePath

import imageio.v3 as iio
import numpy as np
import pytest
import tifffile
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import erlif
from erlif.core.errors import EncoderError, ErlifError, FrameError
from erlif.ingest import (
    Page,
    hash_inputs,
    natural_key,
    open_fixture,
    open_run,
    read_encoder_log,
    read_frames,
)
from erlif.pipeline.cameras import characterise_cameras
from erlif.pipeline.joint import locate_run


def counts_of(directory, frames=range(6)):
    return read_frames(open_run(directory).pairs, list(frames)).counts.values


def pages_of(path):
    return tifffile.imread(path)


def write_pages(path, pages):
    with tifffile.TiffWriter(path) as file:
        for page in pages:
            file.write(page, contiguous=False, metadata=None, photometric="minisblack")


@pytest.fixture(scope="module")
def expected(small_rig):
    """(camera, frame, y, x), read by tifffile alone."""
    return np.stack(
        [[tifffile.imread(path) for path in small_rig.frames(camera)] for camera in (1, 2)]
    )


def test_frames_come_in_pairs_as_they_were_written(small_rig, expected):
    frames = read_frames(open_run(small_rig.run).pairs, [4, 1])
    assert frames.counts.dims == ("camera", "frame", "y", "x")
    assert frames.counts.attrs["units"] == "DN"
    assert frames.frame.values.tolist() == [4, 1]
    np.testing.assert_array_equal(frames.counts, expected[:, [4, 1]])


def test_frames_are_taken_in_natural_order(lab, expected):
    for camera in (1, 2):
        for k, path in enumerate(lab.frames(camera)):
            path.rename(
                path.with_name(f"frame_{k + 7}.tif")
            )  # 7 to 12: "10" sorts before "7" as text
    np.testing.assert_array_equal(counts_of(lab.run), expected)


@given(st.lists(st.integers(0, 10**12), min_size=1, max_size=9, unique=True))
@settings(deadline=None, database=None)
def test_natural_order_is_that_of_the_numbers(numbers):
    names = sorted((Path(f"a{number}b.tif") for number in numbers), key=natural_key)
    assert names == [Path(f"a{number}b.tif") for number in sorted(numbers)]


@given(st.lists(st.text(min_size=1), max_size=5))
@settings(deadline=None, database=None)
def test_any_names_can_be_ordered(names):
    sorted((PurePath(name) for name in [*names, "²", "x²3", "٣"]), key=natural_key)


def test_one_multi_page_file_stands_for_single_pages(lab, expected, film):
    for camera in (1, 2):
        shutil.rmtree(lab.run / f"camera{camera}")
        write_pages(lab.run / f"all{camera}.tiff", expected[camera - 1])
        lab.edit("run/run.toml", (f'"camera{camera}/*.tif"', f'"all{camera}.tiff"'))
    np.testing.assert_array_equal(counts_of(lab.run), expected)
    with erlif.open_film(film) as reference:
        np.testing.assert_array_equal(erlif.process(lab.run).thickness, reference.thickness)


def test_a_truncated_multi_page_file_loses_its_last_pairs_only(lab, expected):
    for camera in (1, 2):
        shutil.rmtree(lab.run / f"camera{camera}")
        write_pages(lab.run / f"all{camera}.tif", expected[camera - 1])
        lab.edit("run/run.toml", (f'"camera{camera}/*.tif"', f'"all{camera}.tif"'))
    whole = (lab.run / "all2.tif").read_bytes()
    (lab.run / "all2.tif").write_bytes(whole[: int(len(whole) * 0.6)])
    with pytest.raises(FrameError, match="truncated"):
        open_run(lab.run)
    recording = open_run(lab.run, skip_bad_frames=True)
    assert recording.pairs.usable == [0, 1, 2]
    assert all("truncated" in reason for reason in recording.pairs.skipped.values())


def test_frames_in_another_format_are_read(lab, expected):
    for camera in (1, 2):
        for k, path in enumerate(lab.frames(camera)):
            path.unlink()
            iio.imwrite(path.with_suffix(".png"), expected[camera - 1, k])
        lab.edit("run/run.toml", (f'"camera{camera}/*.tif"', f'"camera{camera}/*.png"'))
    np.testing.assert_array_equal(counts_of(lab.run), expected)


def test_eight_bit_frames_are_processed(lab, film):
    """4.4 electrons per count of 12 bits are 70.4 per count of 8 bits; coarser counts leave the mean film where it was."""
    for directory in (lab.run, lab.fixture):
        for path in directory.rglob("*.tif"):
            pages = pages_of(path)
            write_pages(
                path,
                [(page >> 4).astype(np.uint8) for page in (pages if pages.ndim == 3 else [pages])],
            )
        toml = directory / f"{directory.name}.toml"
        toml.write_text(
            toml.read_text()
            .replace("bit_depth = 12", "bit_depth = 8")
            .replace("4.4 electron/DN", "70.4 electron/DN")
            .replace(
                'dark = "camera1_dark.tif"', 'offset = "3.5 DN"'
            )  # 64 DN and the mean of what >> cuts off
            .replace('dark = "camera2_dark.tif"', 'offset = "3.5 DN"')
        )
    coarse = erlif.process(lab.run, calibration=erlif.calibrate(lab.fixture))
    with erlif.open_film(film) as fine:
        np.testing.assert_allclose(coarse.film_mean, fine.film_mean, rtol=0.02)
    assert (coarse.flags == 0).mean() > 0.5


def test_hidden_files_beside_the_frames_are_not_meant(lab, expected):
    (lab.run / "camera1" / "._frame_0000.tif").write_bytes(
        b"\x00\x05\x16\x07"
    )  # as macOS leaves on foreign disks
    np.testing.assert_array_equal(counts_of(lab.run), expected)


def test_absolute_patterns_and_strange_directory_names_are_found(lab, expected):
    strange = lab.directory / "Lauf [1] – 80W-90 µm ²"
    lab.run.rename(strange)
    toml = strange / "run.toml"
    toml.write_text(
        toml.read_text().replace('"camera1/*.tif"', json.dumps(f"{lab.directory}/camera1/*.tif"))
    )
    shutil.move(strange / "camera1", lab.directory / "camera1")
    np.testing.assert_array_equal(counts_of(strange), expected)
    hashes = hash_inputs(open_run(strange))
    assert not any(os.path.isabs(name) for name in hashes)
    (lab.directory / "camera1" / "frame_0003.tif").write_bytes(b"")
    with pytest.raises(FrameError, match=r"frame_0003\.tif: the file is empty"):
        open_run(strange)


def test_a_name_that_is_no_utf_8_can_be_written_down(tmp_path):
    assert (
        Page(Path(os.fsdecode(b"frame_\xff.tif")), 0).name == "frame_\N{REPLACEMENT CHARACTER}.tif"
    )
    assert Page(tmp_path / "größe.tif", 3).name == "größe.tif[3]"


def test_hashes_change_with_every_input(lab):
    before = hash_inputs(open_run(lab.run))
    assert set(before) == {
        "run.toml",
        "encoder.csv",
        *(f"camera{n}{rest}" for n in (1, 2) for rest in ("/*.tif", "_dark.tif", "_flat.tif")),
    }
    for name in before:
        path = lab.frames(int(name[6]))[5] if "*" in name else lab.run / name
        if path.suffix == ".tif":
            pages = pages_of(path)
            pages.flat[0] -= 1
            write_pages(path, pages if pages.ndim == 3 else [pages])
        else:
            path.write_text(path.read_text() + "\n")
        after = hash_inputs(open_run(lab.run))
        assert [key for key in before if before[key] != after[key]] == [name]
        before = after


def test_a_fixture_has_no_log(small_rig):
    recording = open_fixture(small_rig.fixture)
    assert len(recording.pairs.usable) == 3
    assert recording.pairs.shape == (96, 128)


# the log


@pytest.fixture
def write_log(tmp_path):
    def write(text):
        path = tmp_path / "encoder.csv"
        path.write_text(text, encoding="utf-8")
        return path

    return write


def test_known_columns_get_their_names_and_units(write_log):
    log = read_encoder_log(
        write_log(
            "frame,time_s,angle_deg,load_N,temperature_C\n7,0.5,1.5,200,25\n8,0.6,2.5,210,26\n"
        )
    )
    assert {str(name): log[name].attrs.get("units") for name in log} == {
        "number": None,
        "time": "s",
        "angle": "degree",
        "load": "N",
        "temperature": "degree_Celsius",
    }
    assert log.number.values.tolist() == [7, 8]
    assert log["load"].values.tolist() == [200, 210]


def test_two_columns_are_enough_in_any_order(write_log):
    log = read_encoder_log(write_log("angle_deg,frame\n1.5,0\n"))
    assert sorted(map(str, log)) == ["angle", "number"]


def test_further_columns_travel_along(write_log):
    log = read_encoder_log(
        write_log("frame,angle_deg,laser mJ,Kraft 2,note,\n0,1,5.5,,a,\n1,2,5.6,3,,\n")
    )
    assert log["laser mJ"].values.tolist() == [5.5, 5.6]
    np.testing.assert_array_equal(log["Kraft 2"], [np.nan, 3])
    assert log["note"].values.tolist() == ["a", ""]
    assert "" not in log


def test_a_mark_of_utf_8_and_windows_line_ends_are_no_fault(write_log):
    path = write_log("")
    path.write_bytes("\ufeffframe,angle_deg\r\n0,1\r\n1,2\r\n\r\n".encode())
    assert read_encoder_log(path).angle.values.tolist() == [1, 2]


@pytest.mark.parametrize(
    "content", [b"\xff\xfef\x00", b"\x00\x00", b"frame,angle_deg\n0,\x00\n", b'frame,"angle_deg\n']
)
def test_what_is_no_log_is_refused(tmp_path, content):
    (tmp_path / "encoder.csv").write_bytes(content)
    with pytest.raises(EncoderError, match=r"encoder\.csv"):
        read_encoder_log(tmp_path / "encoder.csv")


@pytest.mark.parametrize("name", ["none.csv", "."])
def test_a_log_that_cannot_be_read_is_refused(tmp_path, name):
    with pytest.raises(EncoderError, match="cannot be read"):
        read_encoder_log(tmp_path / name)


# anything at all

fuzz = settings(
    deadline=None, database=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


@pytest.fixture(scope="module")
def scratch(small_rig, tmp_path_factory):
    directory = tmp_path_factory.mktemp("fuzz") / "run"
    shutil.copytree(small_rig.run, directory)
    return directory


def damage(data, path, original, most=4):
    content = bytearray(original)
    for _ in range(data.draw(st.integers(1, most))):
        place = data.draw(
            st.integers(0, min(len(content) - 1, 400)) | st.integers(0, len(content) - 1)
        )
        content[place] = data.draw(st.integers(0, 255))
    path.write_bytes(content[: data.draw(st.integers(0, len(content)) | st.just(len(content)))])


@settings(fuzz, max_examples=80)
@given(st.data())
def test_a_log_with_any_bytes_changed_is_read_or_refused(small_rig, scratch, data):
    damage(data, scratch / "encoder.csv", (small_rig.run / "encoder.csv").read_bytes())
    try:
        with contextlib.suppress(ErlifError):
            recording = open_run(scratch)
            located = locate_run(recording)
            assert np.isfinite(located.rocker_speed).all()
    finally:
        shutil.copy(small_rig.run / "encoder.csv", scratch)


@settings(fuzz, max_examples=80)
@given(st.data(), st.booleans())
def test_a_frame_with_any_bytes_changed_is_read_left_out_or_refused(small_rig, scratch, data, skip):
    path = scratch / "camera2" / "frame_0002.tif"
    damage(data, path, small_rig.frames(2)[2].read_bytes())
    try:
        with contextlib.suppress(ErlifError):
            recording = open_run(scratch, skip_bad_frames=skip)
            assert read_frames(recording.pairs, recording.pairs.usable).counts.shape == (
                2,
                len(recording.pairs.usable),
                96,
                128,
            )
            assert {0, 1, 3, 4, 5} <= set(recording.pairs.usable)
    finally:
        shutil.copy(small_rig.frames(2)[2], path)


@settings(fuzz, max_examples=25)
@given(st.data())
def test_a_dark_with_any_bytes_changed_is_read_or_refused(small_rig, scratch, data):
    path = scratch / "camera1_dark.tif"
    damage(data, path, (small_rig.run / "camera1_dark.tif").read_bytes())
    try:
        with contextlib.suppress(ErlifError):
            assert np.isfinite(characterise_cameras(open_run(scratch)).references.dark).all()
    finally:
        shutil.copy(small_rig.run / "camera1_dark.tif", path)
