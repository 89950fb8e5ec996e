"""Kernels whose kept files are cut, empty, foreign or in the way of a full disk."""

import builtins
import errno
import os
from importlib.util import module_from_spec, spec_from_file_location

import numba
import pytest

MODULE = """
from erlif.core.speed.kernels import njit

@njit(cache=True)
def twice(x):
    return 2 * x

@njit(cache=True)
def half(x):
    return x / 2
"""


@pytest.fixture
def start(tmp_path, monkeypatch):
    """Call a kernel of a module that is loaded anew: its result, and how often that was kept."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    (tmp_path / "module.py").write_text(MODULE)

    def run(name="twice"):
        spec = spec_from_file_location("module", tmp_path / "module.py")
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
        kernel = getattr(module, name)
        return kernel(1.5), sum(kernel.stats.cache_hits.values())

    assert run() == (3.0, 0)
    assert run() == (3.0, 1)
    return run


@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
@pytest.mark.parametrize("kept", [0, 40, "zeros", "foreign"])
def test_a_damaged_file_is_replaced_by_a_new_one(start, tmp_path, suffix, kept):
    (damaged,) = (tmp_path / "__pycache__").glob(f"*{suffix}")
    content = damaged.read_bytes()
    ends = {"zeros": bytes(len(content)), "foreign": b"\x80\x04cno.such.module\nname\n."}
    damaged.write_bytes(ends[kept] if kept in ends else content[:kept])
    assert start() == (3.0, 0)
    assert start() == (3.0, 1)


def test_the_kernel_of_another_function_is_not_run(start, tmp_path):
    assert start("half") == (0.75, 0)
    (of_half,) = (tmp_path / "__pycache__").glob("module.half*.nbc")
    (of_twice,) = (tmp_path / "__pycache__").glob("module.twice*.nbc")
    of_twice.write_bytes(of_half.read_bytes())
    assert start() == (3.0, 0)
    assert start() == (3.0, 1)


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EDQUOT, errno.EACCES, errno.EROFS])
def test_a_kernel_that_cannot_be_kept_is_used_all_the_same(tmp_path, monkeypatch, code):
    (tmp_path / "module_of_a_full_disk.py").write_text(MODULE)
    monkeypatch.syspath_prepend(tmp_path)
    module = __import__("module_of_a_full_disk")
    whole = builtins.open

    def refuse(file, mode="r", *args, **options):
        if ".nb" in str(file) and "w" in mode:
            raise OSError(code, os.strerror(code))
        return whole(file, mode, *args, **options)

    monkeypatch.setattr(builtins, "open", refuse)
    assert module.twice(1.5) == 3.0
    assert not list(tmp_path.rglob("*.nb?"))
