"""Kernels need a directory, also where nothing but the temporary directory can be written to."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from erlif.core.speed import kernel_cache
from erlif.core.speed.kernel_cache import ensure_kernel_cache


def test_without_any_a_private_directory_is_made(monkeypatch, tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("no directory")
    monkeypatch.setattr(kernel_cache, "__file__", str(blocked / "kernel_cache.py"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked / "cache"))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(blocked / "numba"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    place = ensure_kernel_cache()
    assert place is not None
    assert place.parent == tmp_path
    assert os.environ["NUMBA_CACHE_DIR"] == str(place)
    if os.name == "posix":
        assert place.stat().st_mode & 0o077 == 0  # nobody else may put code there


def test_it_is_gone_with_the_program(tmp_path):
    """A program whose package, home and named directory are all blocked."""
    blocked = tmp_path / "file"
    blocked.write_text("no directory")
    code = (
        "from erlif.core.speed import kernel_cache\n"
        f"kernel_cache.__file__ = {str(blocked / 'module.py')!r}\n"
        "place = kernel_cache.ensure_kernel_cache()\n"
        "print(place, place.is_dir())\n"
    )
    environment = os.environ | {
        "NUMBA_CACHE_DIR": str(blocked / "numba"),
        "XDG_CACHE_HOME": str(blocked / "cache"),
    }
    run = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    place, existed = run.stdout.split()
    assert existed == "True"
    assert not Path(place).exists()
