"""`erlif process` killed at random moments: the film is the same, and nothing is left over."""

import time
from dataclasses import replace

import numpy as np
import pytest
from scenes.processes import leave_theory_out, start_command
from scenes.stores import contents

from conftest import FULL, SMALL, Laboratory

KILLS = 10 if FULL else 2
"""Of each kind of file; a fault that half of the moments bring out is missed by two with 25 %, of
both kinds with 6 %, by ten with 0.1 %."""


@pytest.fixture(scope="module")
def laboratory(tmp_path_factory):
    """A cycle of 24 triggers, or 50 in full, so that most moments lie among the triggers."""
    rig = replace(SMALL, spacing=0.96 if FULL else 1.92)
    return Laboratory.simulated(tmp_path_factory.mktemp("killed"), seed=13, rig=rig)


class Command:
    """The command in a process of its own that has begun to write, or has ended already."""

    def __init__(self, lab, output, log):
        self.log = log
        arguments = ("process", lab.run, "-o", output)
        self.process = start_command(log, *arguments, before=leave_theory_out)
        key = output.with_name(output.name + ".partial") / "key"
        while self.process.is_alive() and not key.is_file():
            time.sleep(0.01)

    def end(self, seconds=None):
        """Wait for the end, or kill the process; gives the exit status."""
        self.process.join(seconds)
        if self.process.is_alive():
            self.process.kill()
            self.process.join()
        return self.process.exitcode

    @property
    def message(self):
        return self.log.read_text()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["film.nc", "film.zarr"])
def test_a_film_survives_kills_at_random_moments(laboratory, tmp_path, name):
    """In full number, 24 November 2026: ten kills of each kind, no film differs."""
    rng = np.random.default_rng(2024)
    directory, aside = tmp_path / "out", tmp_path / "aside"
    directory.mkdir()
    aside.mkdir()
    output, log = directory / name, tmp_path / "log"

    # an uninterrupted run, and how long it takes from its first file to its end
    command = Command(laboratory, output, log)
    start = time.monotonic()
    assert command.end() == 0, command.message
    duration = time.monotonic() - start
    whole = contents(output)
    output.rename(aside / "whole")

    kills = complete = 0
    while kills < KILLS or not complete:
        command = Command(laboratory, output, log)
        killed = command.end(rng.uniform(0, duration) if kills < KILLS else None) == -9
        kills += killed
        if not output.exists():
            assert killed, command.message
            continue

        # complete: a start after that tidies up where the process was killed, and is refused
        if killed:
            command = Command(laboratory, output, log)
            assert command.end() == 2
            assert "exists already" in command.message
        assert contents(output) == whole
        assert [path.name for path in directory.iterdir()] == [name]
        complete += 1
        output.rename(aside / str(complete))
