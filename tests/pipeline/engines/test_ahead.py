"""Kernels that another process compiles while a first run registers its cameras."""

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from erlif.pipeline.engines import ahead

ROOT = Path(__file__).parents[3]

# kernels with the types of arguments for which they were compiled, or taken from those kept
CALLED = """
import sys

import numba.core.dispatcher

import erlif
from erlif.pipeline.engines import ahead


def known():
    modules = [one for name, one in list(sys.modules.items()) if name.startswith("erlif")]
    kernels = {kernel for one in modules for kernel in vars(one).values()
               if isinstance(kernel, numba.core.dispatcher.Dispatcher) and kernel.signatures
               and kernel.stats.cache_path}  # others are compiled into these
    return {f"{one.py_func.__module__}.{one.py_func.__name__}": set(one.signatures)
            for one in kernels}


ahead.compile_kernels()
names = known()
calibration = erlif.calibrate(sys.argv[1] + "/fixture")
before = known()
erlif.process(sys.argv[1] + "/run", calibration=calibration)
after = known()
print(*names)
print(*(name for name in after if after[name] != before.get(name)))
"""


@pytest.mark.slow
def test_a_run_calls_no_kernel_with_other_arguments_than_those_compiled_ahead(small_rig):
    """numba compiles a kernel for the types of its arguments, and keeps it for later processes."""
    command = [sys.executable, "-c", CALLED, str(small_rig.directory)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    names, others = done.stdout.splitlines()
    kernels = "pipeline.passes.film._measure_film", "ratio.log_ratio.divide_rows"
    for_long_runs = "models.reynolds.compiled.march"
    assert {f"erlif.{kernel}" for kernel in (*kernels, for_long_runs)} <= set(names.split())
    assert not others


def test_kernels_are_known_as_compiled_by_the_largest_one(monkeypatch, tmp_path):
    kernel = SimpleNamespace(stats=SimpleNamespace(cache_path=tmp_path))
    monkeypatch.setattr(ahead.film, "_measure_film", kernel)
    assert not ahead.is_compiled()
    (tmp_path / "film._measure_film-72.py311.nbi").touch()
    assert ahead.is_compiled()


@pytest.mark.parametrize(("kept", "processors"), [(True, 2), (False, 1)])
def test_no_process_is_started_where_it_would_not_help(monkeypatch, kept, processors):
    monkeypatch.setattr(ahead, "is_compiled", lambda: kept)
    monkeypatch.setattr(os, "cpu_count", lambda: processors)
    monkeypatch.setattr(subprocess, "Popen", None)
    with ahead.compiling_ahead():
        pass


def test_the_process_ends_with_the_run(monkeypatch, tmp_path):
    monkeypatch.setattr(ahead, "is_compiled", lambda: False)
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    monkeypatch.setattr(ahead, "_PROGRAM", "import time; time.sleep(600)")
    started = []
    popen = subprocess.Popen
    monkeypatch.setattr(
        subprocess, "Popen", lambda *a, **k: started.append(popen(*a, **k)) or started[-1]
    )
    with pytest.raises(KeyError), ahead.compiling_ahead():
        raise KeyError
    assert started[0].returncode < 0
