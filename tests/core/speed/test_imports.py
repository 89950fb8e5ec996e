"""Imports without the garbage collector."""

import contextlib
import gc
import subprocess
import sys
from pathlib import Path

import pytest

from erlif.core.speed.imports import after_import, large_imports


@pytest.mark.parametrize("enabled", [True, False])
def test_the_collector_is_off_inside_and_as_before_after_a_failed_import(enabled):
    if not enabled:
        gc.disable()
    try:
        with contextlib.suppress(ImportError), large_imports():
            assert not gc.isenabled()
            raise ImportError
        assert gc.isenabled() is enabled
    finally:
        gc.enable()


def test_xarray_loads_no_array_library_for_a_command():
    """They stay importable for those who use them, as the scheduler of dask does."""
    code = (
        "import sys\n"
        "from pathlib import Path\n"
        "from erlif.core.speed.imports import large_imports\n"
        "with large_imports():\n"
        "    from erlif.io.ingest import open_run, read_frames\n"
        "run = open_run(Path('data_samples/straight_bushing'))\n"
        "frames = read_frames(run.pairs, [0]).isel(y=slice(4)).compute()\n"
        "loaded = [name for name in ('dask', 'pint') if name in sys.modules]\n"
        "assert not loaded, loaded\n"
        "import pint\n"
    )
    root = Path(__file__).parents[3]
    subprocess.run([sys.executable, "-c", code], check=True, cwd=root)


def test_a_program_that_has_loaded_xarray_before_can_run_a_command():
    """xarray then knows already which libraries are installed, and imports parts of them."""
    code = (
        "import xarray as xr\n"
        "from erlif.core.speed.imports import large_imports\n"
        "with large_imports():\n"
        "    xr.Dataset(coords={'x': [1.0]}).compute()\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize("large", [True, False])
def test_scipy_adds_no_notes_to_docstrings_for_a_command(large):
    code = (
        "import contextlib\n"
        "from erlif.core.speed.imports import large_imports\n"
        f"with large_imports() if {large} else contextlib.nullcontext():\n"
        "    from scipy import ndimage\n"
        "from scipy import interpolate, linalg\n"
        "print('Array API' in ndimage.gaussian_filter.__doc__, linalg.inv.__doc__[:20].strip())\n"
        "print(linalg.inv([[2.0]])[0, 0], interpolate.CubicSpline([0, 1, 2], [0, 1, 4])(1.5))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    noted, numbers = done.stdout.splitlines()
    assert noted.startswith("False") or not large  # scipy 1.16 has no notes
    assert numbers == "0.5 2.25"


def test_work_for_a_package_that_is_there_is_done_at_once():
    done = []
    after_import("pytest", lambda: done.append(True))
    assert done == [True]
    assert pytest is sys.modules["pytest"]


def test_work_waits_for_the_import_and_is_done_once(tmp_path, monkeypatch):
    (tmp_path / "late_package.py").write_text("VALUE = 3\n")
    monkeypatch.syspath_prepend(tmp_path)
    done, before = [], list(sys.meta_path)
    after_import("late_package", lambda: done.append(sys.modules["late_package"].VALUE))
    assert not done
    import late_package

    assert late_package.VALUE == 3
    assert done == [3]
    assert sys.meta_path == before
