"""Kernels that another process compiles while a first run registers its cameras."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from erlif.pipeline.engines import ahead

ROOT = Path(__file__).parents[3]

# numba reports each kernel that it compiles, and none that it finds compiled
LISTEN = """
from numba.core import event

names = []


class Listener(event.Listener):
    def on_start(self, event):
        kernel = event.data["dispatcher"].py_func
        if kernel.__module__.startswith("erlif"):
            names.append(f"{kernel.__module__}.{kernel.__name__}")

    def on_end(self, event):
        pass


event.register("numba:compile", Listener())
"""

AHEAD = """
from erlif.pipeline.engines.ahead import compile_kernels, is_compiled

assert not is_compiled()
compile_kernels()
assert is_compiled()
print(*names)
"""

RUN = """
import erlif
from erlif.pipeline.engines import ahead

ahead.is_compiled = lambda: True
calibration = erlif.calibrate("calibration/wedge")
names.clear()
erlif.process("data_samples/straight_bushing", calibration=calibration)
print(*names)
"""


@pytest.mark.slow
def test_a_run_compiles_no_kernel_that_was_compiled_ahead(tmp_path):
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "kernels")}

    def compiled(code):
        command = [sys.executable, "-c", LISTEN + code]
        done = subprocess.run(
            command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True
        )
        return set(done.stdout.split())

    before = compiled(AHEAD)
    kernels = "pipeline.passes.film._measure_film", "ratio.log_ratio.divide_rows"
    for_long_runs = "models.reynolds.compiled.march"
    assert {f"erlif.{kernel}" for kernel in (*kernels, for_long_runs)} <= before
    assert not before & compiled(RUN)


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
