"""Flags: bits that combine, fixed by the file format."""

import numpy as np

from erlif.core.flags import FLAG_ATTRS, Flag, count_flags

FORMAT = {
    1: "saturated",
    2: "dim",
    4: "bad_pixel",
    8: "outside_overlap",
    16: "below_range",
    32: "above_range",
    64: "poor_registration",
    128: "no_film",
    256: "film_step",
    512: "masked",
}
"""Bits of the file format, docs/film_nc.md."""


def test_numbers_are_those_of_the_file_format():
    assert {int(flag): str(flag.name).lower() for flag in Flag} == FORMAT


def test_attributes_pair_each_mask_with_its_meaning():
    """CF conventions 3.5: flag_masks of the variable's type, flag_meanings separated by blanks."""
    masks, meanings = FLAG_ATTRS["flag_masks"], str(FLAG_ATTRS["flag_meanings"]).split()
    assert masks.dtype == np.uint16
    assert dict(zip(masks.tolist(), meanings, strict=True)) == FORMAT


def test_flags_are_counted_wherever_they_are_in_the_image():
    rng = np.random.default_rng(2)
    for size in (1, 7, 8, 61, 4096):
        flags = np.where(rng.random(size) < 0.1, rng.integers(0, 1024, size), 0).astype(np.uint16)
        flags[-1] = 129
        expected = [sum(not n & 1 << bit for n in flags.tolist()) for bit in range(10)]
        valid, *flagged = count_flags(flags.reshape(-1, 1))
        assert valid == flags.tolist().count(0)
        assert [size - count for count in flagged] == expected
