"""Commands that are ended by a signal, and commands whose standard streams are closed."""

import os
import shutil
import signal
import subprocess
import sys

import pytest

from erlif.commands.ending import EndedBySignal, signals_interrupt

ERLIF = (sys.executable, "-m", "erlif")

SIGNALS = pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])


@pytest.fixture(scope="module")
def signalled(small_rig, tmp_path_factory):
    """`erlif process` in a process that receives a signal at its third trigger; gives its run."""
    lab = type(small_rig)(tmp_path_factory.mktemp("signalled"))
    for name in ("run", "fixture"):
        shutil.copytree(small_rig.directory / name, lab.directory / name)
    script = f"""
import os
from erlif.io.files import netcdf_maps as store
calls = 0
write = store.write_record
def write_and_receive(*arguments):
    global calls
    calls += 1
    if calls == 3:
        os.kill(os.getpid(), {int(signal.SIGTERM)})
    return write(*arguments)
store.write_record = write_and_receive
from erlif.commands.main import main
main({["process", str(lab.run), "--workers", "1"]!r})
"""
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False
    )
    return lab, done


def test_a_signal_ends_with_one_message_and_its_status(signalled):
    _, done = signalled
    assert done.returncode == 128 + signal.SIGTERM
    last = done.stderr.strip().splitlines()[-1]
    assert last.startswith("erlif: ended by SIGTERM.")
    assert "the same command resumes" in last
    assert "Traceback" not in done.stderr


def test_after_a_signal_the_lock_is_free_and_the_film_is_resumed(signalled, film, command):
    lab, _ = signalled
    assert not list(lab.run.glob("*.lock"))
    assert not list(lab.run.glob(".*.lock"))
    assert (lab.run / "film.nc.partial").is_dir()
    command("process", lab.run, "--workers", 1)
    assert lab.film.read_bytes() == film.read_bytes()


@SIGNALS
def test_a_signal_that_the_caller_ignores_stays_ignored(number):
    before = signal.signal(number, signal.SIG_IGN)
    try:
        with signals_interrupt():
            os.kill(os.getpid(), number)
        assert signal.getsignal(number) is signal.SIG_IGN
    finally:
        signal.signal(number, before)


@SIGNALS
def test_signals_have_their_default_again_after_the_command(number):
    before = signal.signal(number, signal.SIG_DFL)
    try:
        with pytest.raises(EndedBySignal), signals_interrupt():
            signal.raise_signal(number)
        assert signal.getsignal(number) is signal.SIG_DFL
    finally:
        signal.signal(number, before)


def test_a_run_without_standard_streams_gives_the_same_film(lab, film):
    """The film must not take the descriptor of a closed stream: messages would enter it."""
    arguments = [*ERLIF, "-v", "process", str(lab.run)]
    line = 'exec "$@" 0<&- 1>&- 2>&-'
    done = subprocess.run(["sh", "-c", line, "sh", *arguments], capture_output=True, check=False)
    assert done.returncode == 0
    assert lab.film.read_bytes() == film.read_bytes()


def test_a_run_goes_on_when_nobody_reads_its_messages_any_more(lab, film):
    reader, writer = os.pipe()
    os.close(reader)
    arguments = [*ERLIF, "-v", "process", str(lab.run)]
    done = subprocess.run(arguments, stdout=subprocess.PIPE, stderr=writer, text=True, check=False)
    os.close(writer)
    assert done.returncode == 0
    assert "written" in done.stdout
    assert lab.film.read_bytes() == film.read_bytes()


def test_a_reader_of_the_summary_that_is_gone_leaves_the_film_and_no_traceback(lab, film):
    reader, writer = os.pipe()
    os.close(reader)
    arguments = [*ERLIF, "process", str(lab.run)]
    done = subprocess.run(arguments, stdout=writer, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writer)
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    assert "Exception ignored" not in done.stderr
    assert lab.film.read_bytes() == film.read_bytes()
