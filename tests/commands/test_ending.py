"""Commands that are ended by a signal, and commands whose standard streams are closed."""

import io
import os
import signal
import subprocess
import sys

import pytest
from scenes.processes import end_command, lose_the_reader_of_messages, signal_at_the_third_trigger

from erlif.commands.ending import EndedBySignal, echo_refusal, signals_interrupt

ERLIF = (sys.executable, "-m", "erlif")

SIGNALS = pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])


def test_a_signal_ends_with_one_message_and_the_film_is_resumed(lab, film, command, tmp_path):
    status, message = end_command(
        tmp_path / "log", "process", lab.run, "--workers", 1, before=signal_at_the_third_trigger
    )
    assert status == 128 + signal.SIGTERM
    last = message.strip().splitlines()[-1]
    assert last.startswith("erlif: ended by SIGTERM.")
    assert "the same command resumes" in last
    assert "Traceback" not in message

    # the lock is free
    assert not [path for path in lab.run.iterdir() if path.suffix == ".lock"]
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


def test_a_limit_of_memory_under_which_libraries_abort_is_refused(lab):
    command = f"ulimit -v 600000; exec {sys.executable} -m erlif process {lab.run}"
    ended = subprocess.run(["sh", "-c", command], capture_output=True, text=True, check=False)
    assert ended.returncode == 2
    assert ended.stderr.startswith("erlif: Expected an address space of 1 GB or more")
    assert "0.61 GB" in ended.stderr


def test_a_run_without_standard_streams_gives_the_same_film(lab, film):
    """The film must not take the descriptor of a closed stream: messages would enter it."""
    arguments = [*ERLIF, "-v", "process", str(lab.run)]
    line = 'exec "$@" 0<&- 1>&- 2>&-'
    done = subprocess.run(["sh", "-c", line, "sh", *arguments], capture_output=True, check=False)
    assert done.returncode == 0
    assert lab.film.read_bytes() == film.read_bytes()


def test_a_run_goes_on_when_nobody_reads_its_messages_any_more(lab, film, tmp_path):
    arguments = ("-v", "process", lab.run)
    status, _ = end_command(tmp_path / "log", *arguments, before=lose_the_reader_of_messages)
    assert status == 0
    assert lab.film.read_bytes() == film.read_bytes()


def test_a_reader_of_the_result_that_is_gone_leaves_no_traceback(own):
    reader, writer = os.pipe()
    os.close(reader)
    arguments = [*ERLIF, "export", str(own), "--to", "csv"]
    done = subprocess.run(arguments, stdout=writer, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writer)
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    assert "Exception ignored" not in done.stderr
    assert own.with_suffix(".csv").is_file()


class Stream(io.StringIO):
    terminal = False

    def isatty(self):
        return self.terminal


@pytest.mark.parametrize("terminal", [True, False])
def test_a_message_is_broken_for_a_terminal_only(monkeypatch, terminal):
    stream = Stream()
    stream.terminal = terminal
    monkeypatch.setattr(sys, "stderr", stream)
    text = "erlif: " + "word " * 40 + "end."
    echo_refusal(text)
    lines = stream.getvalue().splitlines()
    assert " ".join(stream.getvalue().split()) == text
    assert (max(map(len, lines)) <= 80) == terminal
