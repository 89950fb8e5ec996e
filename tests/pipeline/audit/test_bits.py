"""Bits that are stuck, and counts that were scaled."""

import numpy as np
import pytest

from erlif.correction import count_pixels
from erlif.pipeline.audit.bits import find_bit_faults, note_bits


def counts(seed=1, size=200_000):
    """A camera of 12 bits: light from 300 to 3000 DN."""
    return np.random.default_rng(seed).integers(300, 3000, size).astype(np.uint16)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda c: c, None),
        (lambda c: c // 16 * 16, "the lowest 4 bits are never set: counts are multiples of 16"),
        (lambda c: c & ~np.uint16(1), "the lowest bit is never set: counts are multiples of 2"),
        (lambda c: c & ~np.uint16(64), "bit 6 (value 64) is never set"),
        (lambda c: c | np.uint16(8), "bit 3 (value 8) is always set"),
        (lambda c: np.rint(c // 16 * 16.06).astype(np.uint16), "only "),
    ],
)
def test_bits_that_do_not_move_are_named(change, words):
    found = find_bit_faults(count_pixels(change(counts()), 4095))
    assert found == [] if words is None else [words in text for text in found] == [True]


@pytest.mark.parametrize("light", [5, 1500])
def test_poisson_light_of_any_level_has_no_fault(light):
    rng = np.random.default_rng(2)
    image = np.rint(64 + rng.poisson(4.4 * light, (96, 128)) / 4.4 + rng.normal(0, 2, (96, 128)))
    assert find_bit_faults(count_pixels(image.astype(np.uint16), 4095)) == []


def test_a_bright_film_in_a_dark_border_has_no_fault_unless_it_was_scaled():
    """No count occurs between the two; a few hot pixels do."""
    rng = np.random.default_rng(1)
    image = np.concatenate([rng.normal(100, 10, 200_000), rng.normal(3000, 60, 200_000)])
    image[:200] = rng.uniform(100, 3000, 200)
    assert find_bit_faults(count_pixels(np.rint(image).astype(np.uint16), 4095)) == []
    scaled = np.rint(image // 16 * 16.06).astype(np.uint16)
    (fault,) = find_bit_faults(count_pixels(scaled, 4095))
    assert fault.startswith("only ")


def test_a_fault_is_a_warning_that_names_the_camera():
    sound, stuck = (count_pixels(one, 4095) for one in (counts(), counts() & ~np.uint16(64)))
    (note,) = note_bits((sound, stuck))
    assert note.level == "warning"
    assert note.text.startswith("camera2: bit 6 (value 64) is never set")
