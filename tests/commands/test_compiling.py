"""The line about compiling: once where a kernel is compiled, never where none is."""

from __future__ import annotations

import numba

from erlif.commands.compiling import ANNOUNCEMENT, announced_compiling


def kernels():
    """Two kernels that no cache holds; the second has a function of numba inside."""
    return numba.njit(lambda x: x + 1), numba.njit(lambda x: max(x, 0.5) + min(x, 2.5))


def test_the_first_kernel_is_announced_and_no_other(capsys):
    one, two = kernels()
    with announced_compiling():
        assert capsys.readouterr().err == ""
        assert (one(1.0), two(1.0)) == (2.0, 2.0)
        assert one(1) == 2  # another type of argument
    assert capsys.readouterr().err == f"{ANNOUNCEMENT}\n"


def test_nothing_is_announced_where_nothing_is_compiled(capsys):
    one, _ = kernels()
    one(1.0)
    with announced_compiling():
        one(2.0)
    assert capsys.readouterr().err == ""


def test_the_library_is_silent(capsys):
    one, _ = kernels()
    with announced_compiling():
        pass
    one(1.0)
    assert capsys.readouterr().err == ""
