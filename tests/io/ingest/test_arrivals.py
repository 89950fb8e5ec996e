"""Pairs of a recording that grows: files are written here one by one, whole or in part."""

import errno
import importlib
import os
from pathlib import Path

import numpy as np
import pytest
import tifffile

from erlif.io.ingest.arrivals import PATIENCE, Arrivals
from erlif.io.settings import read_run_settings
from tests.scenes.camera_files import write_cine, write_mraw

module = importlib.import_module("erlif.io.ingest.arrivals")

RNG = np.random.default_rng(3)


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


class Rig:
    """A run directory without frames, and what is written into it."""

    def __init__(self, lab):
        self.run, self.clock = lab.run, Clock()
        self.files = {n: [path.read_bytes() for path in lab.frames(n)] for n in (1, 2)}
        for n in (1, 2):
            for path in lab.frames(n):
                path.unlink()
        self.arrivals = Arrivals(self.run, read_run_settings(self.run), clock=self.clock)

    def write(self, camera, number, *, name=None, part=None):
        path = self.run / f"camera{camera}" / (name or f"frame_{number:04d}.tif")
        path.write_bytes(self.files[camera][number % 6][:part])
        return path

    def look(self, changed=None):
        return [one.place for one in self.arrivals.look(changed)]


@pytest.fixture
def rig(lab):
    return Rig(lab)


def test_a_pair_comes_once_when_both_frames_are_there(rig):
    assert rig.look() == []
    rig.write(1, 0)
    assert rig.look() == []
    rig.write(2, 0)
    rig.clock.now = 107.0
    (pair,) = rig.arrivals.look()
    assert (pair.place, pair.time) == (0, 107.0)
    assert [page.path.parent.name for page in pair.pages] == ["camera1", "camera2"]
    assert rig.look() == []


def test_only_the_files_that_are_named_are_looked_at(rig):
    first, second = rig.write(1, 0), rig.write(2, 0)
    assert rig.look([first]) == []
    assert rig.look([first, second, rig.run / "encoder.csv"]) == [0]


def test_a_file_that_is_half_written_waits_until_it_is_whole(rig):
    rig.write(1, 0)
    size = len(rig.files[2][0])
    for part in (0, 4, 100, size // 2, size - 1):
        rig.write(2, 0, part=part)
        assert rig.look() == []
    rig.write(2, 0)
    assert rig.look() == [0]


def test_a_file_that_stays_damaged_is_reported_after_a_while(rig):
    rig.write(1, 0)
    rig.write(2, 0, part=50)
    rig.look()
    assert rig.arrivals.doubtful() == []
    rig.clock.now += PATIENCE + 0.1
    (text,) = rig.arrivals.doubtful()
    assert text.startswith("camera2/frame_0000.tif: ")
    rig.write(2, 0)
    assert rig.look() == [0]
    assert rig.arrivals.doubtful() == []


def test_a_file_whose_opening_failed_is_read_without_a_change(rig, monkeypatch):
    rig.write(1, 0)
    rig.write(2, 0)
    opening = Path.open

    def fail(path, *args, **options):
        if str(path).endswith("camera2/frame_0000.tif"):
            raise OSError(errno.EMFILE, os.strerror(errno.EMFILE), str(path))
        return opening(path, *args, **options)

    monkeypatch.setattr(Path, "open", fail)
    assert rig.look() == []
    rig.clock.now += PATIENCE + 0.1
    assert rig.look() == []
    (text,) = rig.arrivals.doubtful()
    assert "Too many open files" in text
    monkeypatch.setattr(Path, "open", opening)
    assert rig.look() == [0]
    assert rig.arrivals.doubtful() == []


def test_a_file_that_grows_slowly_is_not_reported(rig):
    rig.write(1, 0)
    for part in range(100, len(rig.files[2][0]), 5000):
        rig.write(2, 0, part=part)
        assert rig.look() == []
        rig.clock.now += PATIENCE / 2
        assert rig.arrivals.doubtful() == []
    rig.write(2, 0)
    assert rig.look() == [0]


def test_a_frame_that_is_written_again_later_is_reported(rig):
    paths = [rig.write(camera, number) for camera in (1, 2) for number in (0, 1)]
    assert rig.look() == [0, 1]
    state = paths[2].stat()
    os.utime(paths[2], ns=(state.st_atime_ns, state.st_mtime_ns + int(0.5e9 * PATIENCE)))
    assert rig.look(paths) == []
    assert rig.arrivals.doubtful() == []  # the program that wrote it has set its time
    os.utime(paths[2], ns=(state.st_atime_ns, state.st_mtime_ns + int(2e9 * PATIENCE)))
    assert rig.look(paths) == []
    (text,) = rig.arrivals.doubtful()
    assert text == "camera2/frame_0000.tif: it was written again after its pair was taken"


def test_a_frame_has_the_name_that_its_file_has_in_the_end(rig):
    rig.write(1, 0)
    first = rig.write(2, 0, name="part_0000.tif")
    hidden = rig.write(1, 1, name=".frame_0001.tif")
    (pair,) = rig.arrivals.look([*rig.run.glob("camera?/*"), hidden])
    assert pair.pages[1].path == first
    last = first.rename(first.with_name("frame_0000.tif"))
    assert rig.look() == []
    assert rig.arrivals.counts() == (1, 1)
    assert rig.arrivals.renew(pair).pages[1].path == last


def test_a_look_at_all_files_reads_those_that_are_new(rig, monkeypatch):
    for number in range(20):
        rig.write(1, number)
        rig.write(2, number)
        rig.look()
    read = []
    stamp = module.file_stamp
    monkeypatch.setattr(module, "file_stamp", lambda path: read.append(path.name) or stamp(path))
    rig.write(1, 20)
    rig.write(2, 20)
    assert rig.look() == [20]
    # the last one may become a stack
    assert sorted({*read}) == ["frame_0019.tif", "frame_0020.tif"]


def test_a_lost_frame_is_missed_by_number_and_camera_and_shifts_no_pair(rig):
    for number in range(6):
        rig.write(1, number)
        if number != 3:
            rig.write(2, number)
    assert rig.look() == [0, 1, 2, 4, 5]
    assert rig.arrivals.missing() == {}
    rig.clock.now += PATIENCE + 0.1
    assert rig.arrivals.missing() == {"frame_0003.tif": 2}
    assert rig.arrivals.counts() == (6, 5)
    rig.write(2, 3)
    (late,) = rig.arrivals.look()
    assert late.place == 3
    assert rig.arrivals.missing() == {}


def test_a_number_that_neither_camera_has_is_missed(rig):
    for number in (0, 1, 2, 4, 5):
        rig.write(1, number)
        rig.write(2, number)
    assert rig.look() == [0, 1, 2, 4, 5]
    assert rig.arrivals.missing() == {}
    rig.clock.now += PATIENCE + 0.1
    assert rig.arrivals.missing() == {"frame_0003.tif": 0}
    rig.write(1, 3)
    assert rig.look() == []
    rig.clock.now += PATIENCE + 0.1
    assert rig.arrivals.missing() == {"frame_0003.tif": 2}
    rig.write(2, 3)
    assert rig.look() == [3]
    assert rig.arrivals.missing() == {}


def test_a_camera_that_stops_is_named_after_a_while(rig):
    for number in range(6):
        rig.write(1, number)
        if number < 3:
            rig.write(2, number)
    rig.look()
    assert rig.arrivals.stopped() is None
    rig.clock.now += PATIENCE + 0.1
    assert rig.arrivals.stopped() == (2, 3)
    assert rig.arrivals.missing() == {}
    for number in range(3, 6):
        rig.write(2, number)
    rig.look()
    assert rig.arrivals.stopped() is None


def test_cameras_may_count_from_different_first_numbers(rig):
    for number in range(4):
        rig.write(1, number)
        rig.write(2, number, name=f"frame_{number + 100:04d}.tif")
        rig.look()
    rig.write(1, 5)
    rig.write(2, 5, name="frame_0105.tif")
    pairs = rig.arrivals.look()
    assert [pair.pages[1].path.name for pair in pairs] == ["frame_0105.tif"]
    assert rig.arrivals.counts() == (5, 5)


def test_a_camera_that_counts_from_one_pairs_as_in_a_finished_recording(rig):
    for number in range(4):
        rig.write(1, number)
        rig.write(2, number + 1)
    pairs = rig.arrivals.look()
    assert [[page.path.stem[-1] for page in pair.pages] for pair in pairs] == [
        [str(n), str(n + 1)] for n in range(4)
    ]


@pytest.mark.parametrize("lacking", [1, 2])
def test_a_first_frame_that_is_lost_shifts_no_pair(rig, lacking):
    places = []
    for number in range(5):
        for camera in (1, 2):
            if number or camera != lacking:
                rig.write(camera, number)
        places += rig.look()
    assert places == [1, 2, 3, 4]
    rig.clock.now += PATIENCE + 0.1
    assert rig.arrivals.missing() == {"frame_0000.tif": lacking}


@pytest.mark.parametrize(
    ("patterns", "names", "late"),
    [
        (("one.tif", "two.tif"), ("one.tif", "two.tif"), 0),
        (("camera1/*.tif", "camera2/*.tif"), ("camera1/run_7.tif", "camera2/run_7.tif"), 0),
        # single images of these names are not known to be a pair
        (("camera1/*.tif", "camera2/*.tif"), ("camera1/a_580.tif", "camera2/a_610.tif"), 1),
    ],
)
def test_a_stack_that_grows_gives_its_whole_pages(lab, patterns, names, late):
    for n in (1, 2):
        for path in lab.frames(n):
            path.unlink()
        lab.edit("run/run.toml", (f"camera{n}/*.tif", patterns[n - 1]))
    arrivals = Arrivals(lab.run, read_run_settings(lab.run))
    images = RNG.integers(100, 2000, (5, 96, 128)).astype(np.uint16)
    seen = []
    for k in range(5):
        for name in names:
            tifffile.imwrite(
                lab.run / name, images[k], append=k > 0, photometric="minisblack", metadata=None
            )
        for pair in arrivals.look():
            seen.append(pair.place)
            assert [page.index for page in pair.pages] == [pair.place] * 2
        assert seen == list(range(k + 1 if k >= late else 0))
    assert arrivals.counts() == (5, 5)


def test_a_stack_that_never_rests_gives_the_pages_before_the_last_one(lab, monkeypatch):
    """The headers of thousands of pages take longer than the next page."""
    for n, name in enumerate(("one.tif", "two.tif"), 1):
        lab.edit("run/run.toml", (f"camera{n}/*.tif", name))
    arrivals = Arrivals(lab.run, read_run_settings(lab.run))
    image = RNG.integers(100, 2000, (96, 128)).astype(np.uint16)
    read = module.read_headers

    def write(path):
        tifffile.imwrite(path, image, append=path.exists(), photometric="minisblack", metadata=None)

    def read_and_write(paths, selection):
        found = read(paths, selection)
        write(paths[0])
        return found

    for name in ("one.tif", "two.tif"):
        write(lab.run / name)
    monkeypatch.setattr(module, "read_headers", read_and_write)
    assert [[pair.place for pair in arrivals.look()] for _ in range(4)] == [[], [0], [1], [2]]
    monkeypatch.setattr(module, "read_headers", read)
    assert [pair.place for pair in arrivals.look()] == [3, 4]


@pytest.mark.parametrize("kind", ["cine", "mraw"])
def test_a_recording_that_is_copied_gives_its_frames_as_they_are_complete(lab, tmp_path, kind):
    names = [f"c{n}.{kind}" for n in (1, 2)]
    for n, name in enumerate(names, 1):
        lab.edit("run/run.toml", (f"camera{n}/*.tif", name))
        writer = {"cine": write_cine, "mraw": write_mraw}[kind]
        writer(tmp_path / name, RNG.integers(100, 2000, (10, 96, 128)).astype(np.uint16))
    arrivals = Arrivals(lab.run, read_run_settings(lab.run))
    size = 96 * 128 * 2
    seen = []
    for share in (0.01, 0.3, 0.55, 0.9, 1.0):
        for path in tmp_path.glob("c?.*"):
            content = path.read_bytes()
            part = int(share * len(content)) if path.suffix == f".{kind}" else len(content)
            (lab.run / path.name).write_bytes(content[:part])
        seen += [pair.place for pair in arrivals.look()]
        assert seen == list(range(len(seen)))
        whole = (lab.run / names[0]).stat().st_size // size
        assert len(seen) <= whole
        assert len(seen) >= share * 10 - 2
    assert len(seen) == 10
