"""The command line as a whole: help, loading, exit status."""

import os
import subprocess
import sys

import pytest
from click.testing import CliRunner

import erlif
import erlif.pipeline
from erlif.commands.main import main

COMMANDS = sorted(main.commands)


def test_importing_erlif_loads_nothing_heavy():
    """Help and completion must not wait for figures, kernels and file formats."""
    loading = "import sys, erlif, erlif.commands.main"
    script = f"{loading}; print(*{{name.split('.')[0] for name in sys.modules}})"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    loaded = set(done.stdout.split())
    assert "erlif" in loaded
    assert not loaded & {
        "numpy",  # its threads are set before it is loaded
        "matplotlib",
        "dask",
        "panel",
        "numba",
        "scipy",
        "xarray",
        "pandas",
        "cv2",
        "zarr",
        "h5py",
        "pint",
        "skimage",
    }


def test_help_fits_one_screen_and_lists_every_command_in_one_line():
    shown = CliRunner().invoke(main, ["--help"], terminal_width=80).output.splitlines()
    assert len(shown) <= 40
    assert max(map(len, shown)) <= 80
    listed = [line.split()[0] for line in shown if line[:3].strip() and line.startswith("  ")]
    assert set(COMMANDS) - {"sources"} <= set(listed)
    assert not [line for line in shown[1:] if line.endswith("...")]


def test_the_module_runs_as_the_command_does():
    done = subprocess.run(
        [sys.executable, "-m", "erlif", "--version"], capture_output=True, text=True, check=True
    )
    assert erlif.__version__ in done.stdout


def test_a_defect_of_ours_ends_with_status_1(lab, monkeypatch):
    def fail(*arguments, **options):
        raise ZeroDivisionError("a slip")

    monkeypatch.setattr(erlif.pipeline, "process", fail)
    result = CliRunner().invoke(main, ["process", str(lab.run)])
    assert result.exit_code == 1
    assert "a slip" in result.stderr
    assert "please report it" in result.stderr


def test_a_refusal_of_the_system_has_a_next_step(lab, monkeypatch):
    def refuse(*arguments, **options):
        raise PermissionError(13, "Permission denied", "film.nc")

    monkeypatch.setattr(erlif.pipeline, "process", refuse)
    result = CliRunner().invoke(main, ["process", str(lab.run)])
    assert result.exit_code == 2
    assert "Permission denied: film.nc. The previous output is intact. Check" in result.stderr


@pytest.mark.parametrize(("given", "used"), [(None, "1"), ("4", "4")])
def test_linear_algebra_has_one_thread_unless_the_user_chooses(monkeypatch, given, used):
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "unset")  # restored after the test
    if given is None:
        monkeypatch.delenv("OPENBLAS_NUM_THREADS")
    else:
        monkeypatch.setenv("OPENBLAS_NUM_THREADS", given)
    CliRunner().invoke(main, ["process", "--help"])
    assert os.environ["OPENBLAS_NUM_THREADS"] == used
