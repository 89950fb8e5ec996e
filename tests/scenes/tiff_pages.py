"""Images as pages of a TIFF, and recorded counts changed on purpose."""

import struct

import pytest
import tifffile


def rewrite(path, change):
    """Change the counts of every page of a TIFF."""
    with tifffile.TiffFile(path) as file:
        pages = [change(page.asarray()) for page in file.pages]
    write_pages(path, pages)


def write_pages(path, pages):
    with tifffile.TiffWriter(path) as file:
        for page in pages:
            file.write(page, contiguous=False, metadata=None, photometric="minisblack")


def write_encoded(path, images, **options):
    """Write with the options of tifffile; the test is skipped where imagecodecs cannot."""
    try:
        tifffile.imwrite(path, images, photometric="minisblack", **options)
    except NotImplementedError:
        pytest.skip("imagecodecs before 2026.3 unpacks such pixels, but does not pack them")


def write_stk(path, stack, *, strips=1, step=20):
    """Write images as MetaMorph does: planes in a row behind one directory, laid out by hand.

    The tag UIC2 has six numbers for each plane: distance (rational), then day and millisecond of
    the day of its creation and of its change (MetaMorph Stack (STK) file format, 1999).
    """
    planes, rows, columns = stack.shape
    entries, after = [], 8 + 2 + 12 * 12 + 4
    outside = b""

    def enter(tag, kind, values, code):
        nonlocal outside
        data = struct.pack(f"<{len(values)}{code}", *values)
        if len(data) > 4:
            place, outside = after + len(outside), outside + data
            data = struct.pack("<I", place)
        entries.append(struct.pack("<HHI", tag, kind, len(values)) + data.ljust(4, b"\0"))

    first = [n for k in range(planes) for n in (k, 1, 2459000, step * k, 2459000, step * k)]
    size = 2 * rows * columns // strips
    start = after + 24 * planes + (8 * strips if strips > 1 else 0)
    for tag, number in ((256, columns), (257, rows), (258, 16), (259, 1), (262, 1)):
        enter(tag, 4, [number], "I")
    enter(273, 4, [start + size * k for k in range(strips)], "I")
    enter(277, 4, [1], "I")
    enter(278, 4, [rows // strips], "I")
    enter(279, 4, [size] * strips, "I")
    enter(282, 4, [1], "I")
    enter(33628, 4, [8], "I")  # the place of further entries
    enter(33629, 5, first, "I")
    entries[-1] = struct.pack("<HHI", 33629, 5, planes) + entries[-1][8:]
    head = struct.pack("<2sHIH", b"II", 42, 8, 12)
    path.write_bytes(head + b"".join(entries) + bytes(4) + outside + stack.astype("<u2").tobytes())
    return path
