"""A directory that is followed: what is in it, what comes, and the end."""

import json
import math
import shutil
import time
from pathlib import Path

from erlif.pipeline.watch import follow
from erlif.pipeline.watch.follow import Follower, as_plain
from erlif.pipeline.watch.live import LivePair


def wait_until(condition, follower, seconds=20.0):
    """Wait for a condition that follows a change of the follower."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        follower.wait(-1, 0.01)


def test_pairs_that_are_there_and_pairs_that_come_are_found(lab, tmp_path):
    kept = tmp_path / "kept"
    kept.mkdir()
    for n in (1, 2):
        shutil.move(lab.frames(n)[-1], kept / f"{n}.tif")
    follower = Follower(lab.run)
    with follower.running():
        wait_until(lambda: len(follower._arrived) == 5, follower)
        for n in (1, 2):
            shutil.copy(kept / f"{n}.tif", lab.run / f"camera{n}" / "frame_0005.tif")
        wait_until(lambda: len(follower._arrived) == 6, follower)
        assert follower._shape == (96, 128)
        assert 0 <= follower.silence < 20


def test_changes_that_no_system_reports_are_found_by_the_next_look(lab, monkeypatch):
    """A share of the network reports nothing of what another machine writes."""
    import watchfiles

    def silent(*arguments, stop_event, **options):
        while not stop_event.wait(0.01):
            yield set()

    monkeypatch.setattr(watchfiles, "watch", silent)
    monkeypatch.setattr(follow, "_RESCAN", 0.05)
    follower = Follower(lab.run)
    with follower.running():
        wait_until(lambda: len(follower._arrived) == 6, follower)


def test_a_directory_that_goes_away_and_comes_back_loses_nothing(lab, monkeypatch, tmp_path):
    monkeypatch.setattr(follow, "_RESCAN", 0.05)
    follower = Follower(lab.run)
    last = lab.frames(2)[-1]
    shutil.move(last, tmp_path / "last.tif")
    with follower.running():
        wait_until(lambda: len(follower._arrived) == 5, follower)
        lab.run.rename(tmp_path / "away")
        wait_until(lambda: "is away" in follower.faults().get("directory", ""), follower)
        (tmp_path / "away").rename(lab.run)
        shutil.move(tmp_path / "last.tif", last)
        wait_until(lambda: len(follower._arrived) == 6, follower)
        wait_until(lambda: not follower.faults(), follower)


def test_a_directory_in_the_place_of_another_is_followed(lab, monkeypatch, tmp_path):
    """As after a share was mounted again: changes of the old one are reported no more."""
    last = [lab.frames(n)[-1] for n in (1, 2)]
    kept = [path.rename(tmp_path / f"{path.parent.name}.tif") for path in last]
    follower = Follower(lab.run)
    with follower.running():
        wait_until(lambda: len(follower._arrived) == 5, follower)
        shutil.copytree(lab.run, tmp_path / "other")
        lab.run.rename(tmp_path / "away")
        (tmp_path / "other").rename(lab.run)
        looked = follower._next_look
        wait_until(lambda: follower._next_look > looked, follower)
        time.sleep(0.2)
        monkeypatch.setattr(follower, "_look_at_all", lambda: None)
        for source, path in zip(kept, last, strict=True):
            shutil.copy(source, path)
        wait_until(lambda: len(follower._arrived) == 6, follower)


def test_a_directory_named_from_here_has_each_file_once(lab, monkeypatch, tmp_path):
    shutil.move(lab.frames(2)[-1], tmp_path / "last.tif")
    monkeypatch.chdir(lab.directory)
    follower = Follower(Path("run"))
    with follower.running():
        wait_until(lambda: len(follower._arrived) == 5, follower)
        shutil.move(tmp_path / "last.tif", "run/camera2/frame_0005.tif")
        wait_until(lambda: len(follower._arrived) == 6, follower)
    assert follower._arrived[5].pages[1].path == Path("run/camera2/frame_0005.tif")


def test_a_row_for_the_page_has_no_value_that_json_lacks():
    pair = LivePair(
        3, "a.tif", 1.0, math.nan, 0.1, 2.0, 0.1, 1.0, (9.0, 8.0), (0.0, 0.0), (math.nan, 0.5)
    )
    row = as_plain(pair)
    assert row["film_min"] is None
    assert row["drift"] == [None, 0.5]
    assert json.loads(json.dumps(row, allow_nan=False)) == row
