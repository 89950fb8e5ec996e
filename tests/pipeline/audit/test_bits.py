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


def photographed(scale=1.0, *, border=0, seed=1):
    """Pixels by count of shot noise and light, scaled by software, with a border without light."""
    rng = np.random.default_rng(seed)
    light = np.rint(rng.normal(rng.uniform(600, 2400, 200_000), 20))
    counts = np.append(light, np.rint(rng.normal(0, 0.5, border)) + 64)
    return np.bincount(np.rint(scale * counts).astype(int), minlength=4096)


@pytest.mark.parametrize("scale", [0.9, 0.95, 1.02, 1.05, 1.1, 1.37])
def test_counts_that_software_scaled_are_named_where_the_flat_is_not(scale):
    frames, raw = photographed(scale), photographed(seed=2)
    (note,) = note_bits([raw, frames], [raw, raw])
    assert note.text.startswith("camera2: ")
    assert "scaled after the exposure" in note.text
    assert not list(note_bits([raw, frames], [raw, photographed(scale, seed=3)]))


@pytest.mark.parametrize("border", [0, 5000, 100_000])
@pytest.mark.parametrize("seed", range(5))
def test_counts_as_they_are_and_a_dark_border_are_not_scaled(seed, border):
    raw = photographed(seed=seed, border=border)
    assert not list(note_bits([raw, raw], [raw, photographed(seed=9)]))
