"""Pages of two cameras that alternate in a file, exchanged and lost on purpose."""

import numpy as np
import pytest
import tifffile

from erlif.core.errors import FrameError
from erlif.io.ingest.alternation import find_exchanged
from erlif.io.ingest.pairing import pair_cameras
from erlif.io.ingest.selection import Selection

PAIRS = 40


def record_pages(rng, *, film=0.0, apart=3):
    """Pages of two cameras in turn: one texture displaced, a film that changes, shot noise. [DN]"""
    texture = 1 + 0.2 * rng.standard_normal((64, 90))
    y = np.linspace(-1, 1, 64)[:, None] ** 2
    pages = []
    for k in range(PAIRS):
        energy, change = rng.uniform(0.9, 1.1), film * np.sin(2 * np.pi * k / PAIRS) * y
        for shift, band in ((0, 1.0), (apart, 0.7)):
            light = 2000 * energy * band * texture[:, shift : shift + 80] * (1 + change * band)
            pages.append(rng.poisson(light * 4.4) / 4.4)
    return np.rint(pages).astype(np.uint16)


def exchange(pages, *pairs):
    pages = pages.copy()
    for k in pairs:
        pages[[2 * k, 2 * k + 1]] = pages[[2 * k + 1, 2 * k]]
    return pages


def open_pages(tmp_path, pages):
    tifffile.imwrite(tmp_path / "run.tif", pages, photometric="minisblack", metadata=None)
    return pair_cameras(
        tmp_path,
        ("run.tif", "run.tif"),
        bit_depths=(12, 12),
        selections=(Selection("odd"), Selection("even")),
    )


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda pages: exchange(pages, 7), r"run.tif\[14\], run.tif\[15\] are exchanged"),
        (lambda pages: exchange(pages, 0), r"run.tif, run.tif\[1\] are exchanged"),
        (
            lambda pages: exchange(pages, 3, 9, 21),
            r"run.tif\[6\], .*\[18\], .* and 2 more",
        ),
        (lambda pages: exchange(pages, *range(20, PAIRS)), r"from run.tif\[40\] on they"),
        (lambda pages: exchange(pages, PAIRS - 1), r"from run.tif\[78\] on they"),
        (lambda pages: np.delete(pages, 30, axis=0), r"from run.tif\[30\] on .* missing"),
        (lambda pages: np.delete(pages, [31, 79], axis=0), r"from run.tif\[31\] on they"),
        (lambda pages: np.delete(pages, 77, axis=0), r"from run.tif\[77\] on they"),
    ],
    ids=["pair", "first", "three", "half", "last", "one lost", "two lost", "lost at the end"],
)
@pytest.mark.parametrize("film", [0.0, 0.1])
def test_pages_of_the_other_camera_are_named(tmp_path, change, words, film):
    pages = change(record_pages(np.random.default_rng(8), film=film))
    with pytest.raises(FrameError, match=words):
        open_pages(tmp_path, pages)


@pytest.mark.parametrize("film", [0.0, 0.1, 0.6])
def test_cameras_in_turn_are_accepted(tmp_path, film):
    pages = record_pages(np.random.default_rng(9), film=film)
    assert len(open_pages(tmp_path, pages).usable) == PAIRS


@pytest.mark.parametrize("film", [0.0, 0.6])
def test_cameras_that_cannot_be_distinguished_are_accepted(film):
    """Both see the same; a film that grows divides the pages, but not in pairs."""
    for seed in range(20):
        pages = record_pages(np.random.default_rng(seed), film=film, apart=0).astype(np.float32)
        assert find_exchanged(pages, np.arange(2 * PAIRS) % 2 == 0) == []
