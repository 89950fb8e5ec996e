"""``erlif watch``: from an empty directory to film.nc; what ends it, and what it leaves."""

import functools
import os
import random
import shutil
import signal
import threading
import time
from types import SimpleNamespace

import pytest

import erlif
from erlif.commands import watch
from erlif.commands.watch import ALARMED
from erlif.pipeline.watch.watch import Watch
from erlif.rig.live import Fault, write_live
from tests.conftest import FULL
from tests.scenes.processes import leave_theory_out, start_command


@pytest.fixture
def run_watch(command):
    return functools.partial(command, "watch", "--no-browser")


@pytest.fixture
def recording(lab):
    """Starts a thread that writes the run in real time; gives the directory."""
    threads = []
    usual = {"rate": 20.0, "gain": 4.4, "read_noise": 9.0, "delay": 0.3}

    def start(**options):
        thread = threading.Thread(target=write_live, args=(lab.run,), kwargs=usual | options)
        thread.start()
        threads.append(thread)
        while len(list((lab.run / "camera1").iterdir())) == 6:
            time.sleep(0.01)
        return lab.run

    yield start
    for thread in threads:
        thread.join()


def test_the_film_of_a_watched_run_is_that_of_process(recording, run_watch, film):
    result = run_watch(recording(), "--quiet", "1 s", "--workers", "2")
    assert "The page is at http://127.0.0.1:" in result.stdout
    assert "pair 5: min " in result.stdout
    assert "6 triggers from 6 frame pairs" in result.stdout
    written = result.stdout.split("written: ")[1].split("\n")[0]
    with open(written, "rb") as made, open(film, "rb") as expected:
        assert made.read() == expected.read()


@pytest.mark.usefixtures("maps_alone")
def test_a_file_named_stop_ends_it(lab, recording, run_watch):
    run = recording(rate=50.0, delay=0.0)
    threading.Timer(2.0, (run / "stop").touch).start()
    run_watch(run)
    assert lab.film.exists()


@pytest.mark.usefixtures("maps_alone")
def test_an_alarm_gives_the_exit_status_and_runs_the_command(recording, run_watch, tmp_path):
    ran = tmp_path / "ran"
    result = run_watch(
        recording(rate=50.0),
        *("--quiet", "1 s", "--film-below", "1 mm", "--on-alarm", f"touch {ran}"),
        status=ALARMED,
    )
    assert "ALARM minimum film" in result.stderr
    assert "alarm: minimum film" in result.stderr
    assert ran.exists()


def interrupt(_):
    raise KeyboardInterrupt


@pytest.mark.parametrize("end", [lambda _: True, interrupt], ids=["quiet", "Ctrl-C"])
def test_an_alarm_of_the_last_pair_is_given_where_the_run_ends_with_it(end, capsys, tmp_path):
    """The pair is measured after the last look."""
    ran = tmp_path / "ran"
    state = SimpleNamespace(
        alarms={"film": "minimum film of pair 5"},
        faults={"frames": "camera 2 lacks frame_0005.tif"},
        latest=None,
        arrived=6,
    )
    watched = SimpleNamespace(is_quiet=end, state=lambda: state)
    watch._follow(watched, 1.0, f"touch {ran}")
    printed = capsys.readouterr().err
    assert "ALARM minimum film of pair 5" in printed
    assert "camera 2 lacks frame_0005.tif" in printed
    latest = time.monotonic() + 20
    while not ran.exists():
        assert time.monotonic() < latest
        time.sleep(0.01)


@pytest.mark.usefixtures("maps_alone")
def test_frames_that_are_lost_or_cannot_be_read_are_left_out(recording, run_watch, command):
    run = recording(faults=[Fault("camera2-loses", 2)])
    broken, following = (run / "camera2" / f"frame_{n:04d}.tif" for n in (3, 4))
    while not following.exists():  # then the one before is whole
        time.sleep(0.005)
    broken.write_bytes(broken.read_bytes()[:5000])
    result = run_watch(run, "--quiet", "1.5 s", "--workers", "1")
    assert "Frames are left out, as by --skip-bad-frames of erlif process." in result.stderr
    assert "camera 2 lacks the partner of frame_0002.tif" in result.stderr
    assert "frame_0003.tif: the file is truncated" in result.stderr
    assert "6 triggers from 4 frame pairs" in result.stdout
    watched = (run / "film.nc").read_bytes()
    command("process", run, "--skip-bad-frames", "--overwrite", "--workers", "1")
    assert (run / "film.nc").read_bytes() == watched


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--quiet", "10"), "such as \"5 s\"; got '10'"),
        (("--film-below", "2 s"), "um"),
        (("-o", "film.txt"), r".nc or .zarr"),
    ],
)
def test_bad_options_are_refused_before_anything_starts(lab, run_watch, options, message):
    assert message in run_watch(lab.run, *options, status=2).stderr
    assert not lab.film.exists()


@pytest.mark.usefixtures("maps_alone")
def test_it_waits_for_a_directory_that_does_not_exist_yet(lab, run_watch, monkeypatch):
    """The page states that the run is processed, then the numbers of the film and how to see it."""
    stated = []
    monkeypatch.setattr(Watch, "announce", lambda self, text, **end: stated.append((text, end)))
    elsewhere = lab.run.rename(lab.run.with_name("elsewhere"))
    threading.Timer(1.0, elsewhere.rename, (lab.run,)).start()
    result = run_watch(lab.run, "--quiet", "1 s", "--workers", "1")
    assert f"waiting for {lab.run / 'run.toml'}" in result.stderr
    (first, _), (last, end) = stated
    assert first == "The recording has ended; the run is being processed."
    assert end == {"closed": True}
    head, *numbers, way = last.splitlines()
    assert (head, way) == ("film.nc is written.", f"Look at it: erlif view {lab.film}")
    assert "\n".join(numbers) in result.stdout
    assert any("min " in line for line in numbers)


def test_a_film_that_exists_is_not_replaced(lab, refused):
    lab.film.write_bytes(b"mine")
    assert "--overwrite" in refused("watch", lab.run, "--no-browser")


def test_without_a_pair_there_is_nothing_to_process(lab, run_watch):
    for n in (1, 2):
        for path in lab.frames(n):
            path.unlink()
    (lab.run / "stop").touch()
    assert "none has come" in run_watch(lab.run, status=2).stderr


@pytest.mark.slow
@pytest.mark.usefixtures("maps_alone")
def test_killed_at_any_moment_it_goes_on_and_ends_with_the_same_film(lab, tmp_path):
    rng, film = random.Random(27), tmp_path / "film.nc"
    erlif.process(lab.run, output=film, workers=1).close()
    kept = {n: [path.read_bytes() for path in lab.frames(n)] for n in (1, 2)}
    for _ in range(20 if FULL else 2):
        for n in (1, 2):
            shutil.rmtree(lab.run / f"camera{n}")
            (lab.run / f"camera{n}").mkdir()
        arguments = ("watch", lab.run, "--no-browser", "--quiet", "1 s", "--workers", "1")
        process = start_command(tmp_path / "log", *arguments, before=leave_theory_out)
        end = time.monotonic() + rng.uniform(0.0, 3.0)
        for k in range(6):
            for n in (1, 2):
                (lab.run / f"camera{n}" / f"frame_{k:04d}.tif").write_bytes(kept[n][k])
            time.sleep(0.1)
        time.sleep(max(0.0, end - time.monotonic()))
        if process.is_alive():
            os.kill(process.pid, signal.SIGKILL)
        process.join()
        lab.film.unlink(missing_ok=True)
        again = start_command(tmp_path / "log", *arguments, before=leave_theory_out)
        again.join()
        assert again.exitcode == 0, (tmp_path / "log").read_text()
        assert lab.film.read_bytes() == film.read_bytes()
