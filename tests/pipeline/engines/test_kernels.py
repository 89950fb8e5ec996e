"""The second process that compiles the kernels of the film in a fresh environment."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from numba.types import BaseNamedTuple

from erlif.core.flags import Flag
from erlif.pipeline.engines import kernels


def kernels_of(cache: Path) -> set[str]:
    """Names of the kernels in a cache of numba."""
    return {path.name.split("-")[0].split(".")[-1] for path in cache.rglob("*.nbi")}


@pytest.mark.slow
def test_it_compiles_what_the_film_needs(tmp_path):
    """The kernels of a film and of its ratio are in the cache, no others of the registration."""
    command = [sys.executable, "-c", kernels._COMMAND]
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    subprocess.run(command, env=environment, check=True, timeout=300)
    names = kernels_of(tmp_path)
    assert {"_measure", "_ratio_rows", "fill_noise", "spread_flags"} <= names
    assert not {"_cell_sums", "_flatten", "_round_and_shuffle"} & names


MEANWHILE = ("_compile_plain_ratio", "_compile_sum", "_compile_cells", "_compile_encoding")
"""What the first process compiles while it would wait for the second."""


class Sleeper:
    """Stands for a process that takes as long as it is told."""

    def __init__(self, seconds: float) -> None:
        self.command = [sys.executable, "-c", f"import time; time.sleep({seconds})"]
        self.made: list[subprocess.Popen[bytes]] = []

    def __call__(self, _command, **options):
        self.made.append(_popen(self.command, **options))
        return self.made[-1]


_popen = subprocess.Popen


def test_the_film_waits_for_it(monkeypatch):
    sleeper = Sleeper(0.2)
    monkeypatch.setattr(kernels.os, "cpu_count", lambda: 2)
    monkeypatch.setattr(kernels.subprocess, "Popen", sleeper)
    with kernels.second_compiler():
        kernels.compile_aside()
        kernels.compile_aside()  # there is only one
        kernels.wait_for_kernels()
        assert [process.returncode for process in sleeper.made] == [0]


@pytest.mark.parametrize(("seconds", "parts"), [(0.5, 4), (0.0, 0)])
def test_meanwhile_the_first_process_compiles_what_comes_next(monkeypatch, seconds, parts):
    sleeper, done = Sleeper(seconds), []
    monkeypatch.setattr(kernels.os, "cpu_count", lambda: 2)
    monkeypatch.setattr(kernels.subprocess, "Popen", sleeper)
    for name in MEANWHILE:
        monkeypatch.setattr(kernels, name, lambda name=name: done.append(name))
    with kernels.second_compiler():
        kernels.compile_aside()
        if not seconds:
            sleeper.made[0].wait()
        kernels.wait_for_kernels()
    assert len(done) == parts


def test_the_small_ratio_takes_every_way_of_a_large_one():
    """Equal light of both cameras but for a bubble: log ratio 0, and no film there."""
    ratio = kernels._compile_plain_ratio()
    assert float(ratio.log_ratio[0, 4, 4]) == 0
    assert int(ratio.flags[0, 16, 16]) & Flag.NO_FILM
    kernels._compile_sum()
    kernels._compile_cells()
    kernels._compile_encoding()


def test_it_ends_with_the_command(monkeypatch):
    sleeper = Sleeper(60)
    monkeypatch.setattr(kernels.os, "cpu_count", lambda: 2)
    monkeypatch.setattr(kernels.subprocess, "Popen", sleeper)
    with kernels.second_compiler():
        kernels.compile_aside()
    assert sleeper.made[0].returncode not in (None, 0)


def test_a_machine_with_one_processor_does_without(monkeypatch):
    monkeypatch.setattr(kernels.os, "cpu_count", lambda: 1)
    monkeypatch.setattr(kernels.subprocess, "Popen", None)  # a call would raise
    with kernels.second_compiler():
        kernels.compile_aside()
        kernels.wait_for_kernels()


def test_cached_kernels_name_no_class_of_erlif():
    """The index of a cache holds the types of the arguments; classes come and go with versions."""
    from erlif.io.files import compression
    from erlif.pipeline.passes import film

    kernels.compile_film_kernels()
    for module in (film, compression):
        for name, kernel in vars(module).items():
            for signature in getattr(kernel, "signatures", ()):
                assert not any(isinstance(one, BaseNamedTuple) for one in signature), name
    assert film._measure.signatures


def test_the_second_process_runs_the_same_package_beside_a_copy_of_its_sources(
    tmp_path, monkeypatch
):
    """An erlif in the working directory, as in a clone from which erlif was installed."""
    copy = tmp_path / "erlif"
    copy.mkdir()
    (copy / "__init__.py").write_text("")
    monkeypatch.chdir(tmp_path)
    found = tmp_path / "found.txt"
    program = f"import erlif, pathlib; pathlib.Path({str(found)!r}).write_text(erlif.__file__)"
    monkeypatch.setattr(kernels, "_COMMAND", program)
    monkeypatch.setattr(kernels._Second, "process", None)

    kernels.compile_aside()
    assert kernels._Second.process is not None
    assert kernels._Second.process.wait(60) == 0
    monkeypatch.setattr(kernels._Second, "process", None)
    assert Path(found.read_text()) == Path(kernels.__file__).parents[2] / "__init__.py"
