"""Rows of arrays that a kernel asks for before it reads them.

Processors look ahead along a row of memory, but not beyond a page of 4 KiB, and not in loops as
short as those of the warp: each row would begin with a wait for the main memory.
"""

from __future__ import annotations

from llvmlite import ir
from numba import njit, types
from numba.core import cgutils
from numba.extending import intrinsic

# Size of a cache line. [byte]
_LINE = 64


@intrinsic
def _prefetch(typingctx, array, row, column):  # type: ignore[no-untyped-def]
    """Ask for the cache line of an element of a two-dimensional array."""

    def generate(context, builder, signature, values):  # type: ignore[no-untyped-def]
        kind, number = signature.args[0], ir.IntType(32)
        view = context.make_array(kind)(context, builder, values[0])
        place = cgutils.get_item_pointer(  # type: ignore[no-untyped-call]
            context, builder, kind, view, list(values[1:]), wraparound=False
        )
        pointer = builder.bitcast(place, cgutils.voidptr_t)
        form = ir.FunctionType(ir.VoidType(), [cgutils.voidptr_t, number, number, number])
        function = cgutils.get_or_insert_function(  # type: ignore[no-untyped-call]
            builder.module, form, "llvm.prefetch.p0"
        )
        # for reading, into all caches, data
        builder.call(function, [pointer, number(0), number(3), number(1)])
        return context.get_dummy_value()

    return types.void(array, types.intp, types.intp), generate


@njit(nogil=True, inline="always")
def fetch_row(array, row):  # type: ignore[no-untyped-def]
    """Ask for a row of an array (y, x) that will be read next; nothing beyond its end.

    Parameters
    ----------
    array : array, (y, x)
    row : int
    """
    if 0 <= row < array.shape[0]:
        for column in range(0, array.shape[1], _LINE // array.itemsize):
            _prefetch(array, row, column)  # type: ignore[call-arg]
