"""A run that is watched while another thread writes it."""

import errno
import importlib
import os
import shutil
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import tifffile

import erlif
from erlif.core.errors import FrameError
from erlif.pipeline.watch.alarms import Alarms
from erlif.pipeline.watch.live import LiveFilm, LivePair
from erlif.pipeline.watch.watch import Watch
from tests.pipeline.watch.test_follow import wait_until

module = importlib.import_module("erlif.pipeline.watch.watch")


@pytest.fixture
def empty_run(lab, tmp_path):
    """The run without frames and without rows in its log, and a function that writes one pair."""
    kept = tmp_path / "kept"
    for n in (1, 2):
        shutil.move(lab.run / f"camera{n}", kept / f"camera{n}")
        (lab.run / f"camera{n}").mkdir()
    log = lab.run / "encoder.csv"
    head, *rows = log.read_text().splitlines()
    log.unlink()

    def write(frame, *cameras):
        for n in cameras or (1, 2):
            name = f"frame_{frame:04d}.tif"
            shutil.copy(kept / f"camera{n}" / name, lab.run / f"camera{n}" / name)
        log.write_text("\n".join([head, *rows[: frame + 1]]) + "\n")

    return lab.run, write


def test_every_pair_is_measured_as_it_comes_and_the_angles_follow(empty_run, film):
    run_dir, write = empty_run
    watch = Watch(run_dir, workers=2)
    with watch.running():
        assert watch.state().latest is None
        for frame in range(6):
            write(frame)
        wait_until(lambda: len(watch.state().measured) == 6, watch)
        wait_until(lambda: len(watch.state().logged.get("angle", ())) == 6, watch)
        state = watch.state()
        logged = watch.news(-1, 0, 0, 0.0)["logged"]
    last = np.genfromtxt(run_dir / "encoder.csv", delimiter=",", names=True)[-1]
    assert logged["joint_load"] == last["load_N"]
    assert logged["temperature"] == last["temperature_C"]
    assert state.frames == (6, 6)
    assert state.latest.place == 5
    assert state.newest.title == "pair 5, frame_0005.tif"
    assert state.faults == {}
    assert state.registered_on >= 2
    with erlif.open_film(film) as finished:
        for pair in state.measured:
            # the map of the cameras comes from fewer pairs than in the finished film
            tolerance = 2 * float(finished.film_mean_std[pair.place])
            assert pair.film_mean == pytest.approx(
                float(finished.film_mean[pair.place]), abs=tolerance
            )
        assert state.logged["angle"][3] == pytest.approx(float(finished.encoder_angle[3]))


def test_news_hold_what_is_new_and_wait_for_it(empty_run):
    run_dir, write = empty_run
    watch = Watch(run_dir, workers=1)
    with watch.running():
        writer = threading.Thread(target=lambda: [write(frame) for frame in range(6)])
        writer.start()
        version, rows = -1, []
        end = time.monotonic() + 30
        while len(rows) < 6 and time.monotonic() < end:
            news = watch.news(version, len(rows), 0, 1.0)
            assert news["version"] >= version
            version = news["version"]
            rows += news["pairs"]
        writer.join()
    assert sorted(row["place"] for row in rows) == list(range(6))
    place, title, thickness, flags = watch.newest("thickness")
    assert place == 5
    assert title == "pair 5, frame_0005.tif"
    assert thickness.shape == flags.shape == (96, 128)
    assert watch.news(-1, 0, 0, 0.0)["closed"] is False
    begun = time.monotonic()
    watch.wait_for_map(4, 30.0)
    assert time.monotonic() - begun < 5
    watch.wait_for_map(5, 0.2)
    assert time.monotonic() - begun > 0.15


def test_an_alarm_is_raised_kept_and_named(empty_run):
    run_dir, write = empty_run
    watch = Watch(run_dir, workers=1, alarms=Alarms(film_below=1000.0, no_pulse_for=0.3))
    with watch.running():
        for frame in range(3):
            write(frame)
        wait_until(lambda: watch.state().measured, watch)
        assert watch.alarmed["film"].endswith("(limit 1000 um)")
        # a silence counts once another pair has ended it: the last one is the end of the run
        wait_until(lambda: "no pulse" in watch.state().alarms, watch)
        # the page is woken although no pair comes
        version = watch.state().version
        wait_until(lambda: watch.state().version >= version + 3, watch)
        assert "no pulse" not in watch.alarmed
        write(3)
        wait_until(lambda: "no pulse" in watch.alarmed, watch)


def test_the_alarm_of_one_pair_is_shown_for_a_while(empty_run):
    zero = (0.0, 0.0)
    thick = LivePair(7, "", 0.0, 3.0, 0.1, 3.5, 0.1, 1.0, zero, zero, zero)
    watch = Watch(empty_run[0], alarms=Alarms(film_below=2.0))
    watch._keep_alarms([thick._replace(place=6, film_min=1.5)])
    watch._keep_alarms([thick])
    assert watch.state().alarms == {"film": "minimum film 1.50 um in pair 6 (limit 2 um)"}


def test_the_end_is_a_quiet_time_or_a_file(empty_run):
    run_dir, write = empty_run
    watch = Watch(run_dir, workers=1)
    with watch.running():
        assert not watch.is_quiet(0.1)
        write(0)
        wait_until(lambda: watch.state().arrived, watch)
        assert not watch.is_quiet(None)
        wait_until(lambda: watch.is_quiet(0.1), watch)
        # a share that is away is no end
        run_dir.rename(run_dir.with_name("away"))
        assert not watch.is_quiet(0.1)
        run_dir.with_name("away").rename(run_dir)
        assert not watch.is_quiet(0.1)
        wait_until(lambda: watch.is_quiet(0.1), watch)
        (run_dir / "stop").touch()
        assert watch.is_quiet(None)


def test_no_quiet_time_ends_it_while_pairs_that_have_come_are_measured(empty_run, monkeypatch):
    run_dir, write = empty_run
    measure, held = LiveFilm.measure, threading.Event()

    def measure_once_free(film, *pair):
        held.wait(60)
        return measure(film, *pair)

    monkeypatch.setattr(LiveFilm, "measure", measure_once_free)
    watch = Watch(run_dir, workers=1)
    with watch.running():
        for frame in range(3):
            write(frame)
        wait_until(lambda: watch.state().arrived == 3 and watch.silence > 0.2, watch)
        assert not watch.is_quiet(0.1)
        held.set()
        wait_until(lambda: watch.is_quiet(0.1), watch)
        assert len(watch.state().measured) == 3


def test_a_pair_that_cannot_be_used_is_named_and_the_others_go_on(empty_run):
    run_dir, write = empty_run
    watch = Watch(run_dir, workers=1)
    with watch.running():
        for frame in range(4):
            write(frame)
        wait_until(lambda: len(watch.state().measured) == 4, watch)
        # another shape than all other frames
        for n in (1, 2):
            tifffile.imwrite(run_dir / f"camera{n}" / "frame_0004.tif", np.ones((8, 8), np.uint16))
        wait_until(lambda: any("96" in fault for fault in watch.state().faults.values()), watch)
        write(5)
        wait_until(lambda: watch.state().latest.place == 5, watch)


def test_pairs_on_a_share_that_goes_away_are_measured_when_it_is_back(empty_run, monkeypatch):
    run_dir, write = empty_run
    monkeypatch.setattr(module, "_AGAIN", 0.05)
    watch = Watch(run_dir, workers=1)
    measure, away = LiveFilm.measure, run_dir.with_name("away")

    def measure_and_lose(film, pairs, frame, arrival):
        if arrival.place == 3 and not away.exists() and not lost:
            lost.append(frame)
            run_dir.rename(away)
        return measure(film, pairs, frame, arrival)

    lost: list[int] = []
    monkeypatch.setattr(LiveFilm, "measure", measure_and_lose)
    with watch.running():
        for frame in range(4):
            write(frame)
        wait_until(lambda: lost and "share" in watch.state().faults, watch)
        away.rename(run_dir)
        wait_until(lambda: len(watch.state().measured) == 4, watch)
        assert "share" not in watch.state().faults


def test_a_pair_whose_files_came_back_in_between_is_measured(empty_run, monkeypatch):
    run_dir, write = empty_run
    watch = Watch(run_dir, workers=1)
    measure, failed = LiveFilm.measure, []

    def measure_or_fail(film, pairs, frame, arrival):
        if arrival.place == 1 and not failed:
            failed.append(frame)
            raise FrameError("the share was away")
        return measure(film, pairs, frame, arrival)

    monkeypatch.setattr(LiveFilm, "measure", measure_or_fail)
    with watch.running():
        for frame in range(3):
            write(frame)
        wait_until(lambda: len(watch.state().measured) == 3, watch)
    assert failed
    assert not watch.state().faults


@pytest.mark.parametrize("stage", ["header", "pair"])
def test_a_pair_whose_files_could_not_be_opened_is_measured_later(empty_run, monkeypatch, stage):
    """The first attempts fail as where a program has all its files open."""
    run_dir, write = empty_run
    monkeypatch.setattr(module, "_AGAIN", 0.05)
    watch, opening, measure, failed = Watch(run_dir, workers=1), Path.open, LiveFilm.measure, []

    def refuse(name, path):
        if name == stage and path.name == "frame_0002.tif" and len(failed) < 3:
            failed.append(path)
            raise OSError(errno.EMFILE, os.strerror(errno.EMFILE), str(path))

    def open_or_fail(path, *args, **options):
        refuse("header", path)
        return opening(path, *args, **options)

    def measure_or_fail(film, pairs, frame, arrival):
        try:
            refuse("pair", arrival.pages[0].path)
        except OSError as error:
            raise FrameError("the file cannot be read") from error
        return measure(film, pairs, frame, arrival)

    monkeypatch.setattr(Path, "open", open_or_fail)
    monkeypatch.setattr(LiveFilm, "measure", measure_or_fail)
    with watch.running():
        for frame in range(3):
            write(frame)
        wait_until(lambda: len(watch.state().measured) == 3, watch)
        wait_until(lambda: not watch.state().faults, watch)
    assert len(failed) == 3


def test_pairs_whose_files_got_other_names_are_measured(empty_run, monkeypatch):
    """Cameras that write under another name which the pattern matches too."""
    run_dir, write = empty_run
    monkeypatch.setattr(module, "_AGAIN", 0.05)
    watch = Watch(run_dir, workers=1)
    with watch.running():
        for frame in range(4):
            write(frame)
            first = run_dir / "camera2" / f"frame_{frame:04d}.tif"
            part = first.rename(first.with_name(f"part_{frame:04d}.tif"))
            wait_until(lambda: watch.state().arrived == frame + 1, watch)  # noqa: B023
            part.rename(first)
        wait_until(lambda: len(watch.state().measured) == 4, watch)
        assert "share" not in watch.state().faults


def test_a_frame_lost_without_a_gap_in_the_numbers_is_stated(lab, monkeypatch):
    monkeypatch.setattr(module, "_PULSES", 4)
    frames = lab.frames(2)
    for frame in range(1, 5):
        shutil.move(frames[frame + 1], frames[frame])
    watch = Watch(lab.run, workers=1)
    with watch.running():
        wait_until(lambda: "pulses" in watch.state().faults, watch)
    assert watch.state().faults["pulses"] == (
        "the cameras show different laser pulses in 4 of the pairs 1 to 4: their film is wrong"
    )
