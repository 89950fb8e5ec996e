"""FITS files laid out after the FITS standard 4.0."""

import numpy as np
import pytest
from scenes.camera_files import fits_header, fits_image, padded, unsigned
from scenes.reading import read, refusal

COUNTS = np.random.default_rng(5).integers(0, 65536, (3, 64, 80), dtype=np.uint16)
NEGATIVE = fits_header(XTENSION="BINTABLE", BITPIX=8, NAXIS=1, NAXIS1=80, PCOUNT=-2960, GCOUNT=1)


@pytest.mark.parametrize(("order", "step"), [("TOP-DOWN", 1), ("BOTTOM-UP", -1)])
def test_rows_stand_as_the_header_states(tmp_path, order, step):
    content = fits_image(16, 80, 64, BZERO=32768, ROWORDER=order) + unsigned(COUNTS[0])
    np.testing.assert_array_equal(read(tmp_path / "a.fits", content), COUNTS[:1, ::step])


def test_an_image_may_follow_an_empty_or_another_part(tmp_path):
    table = fits_header(
        XTENSION="BINTABLE", BITPIX=8, NAXIS=2, NAXIS1=30, NAXIS2=100, PCOUNT=50, GCOUNT=1
    )
    extension = fits_header(
        XTENSION="IMAGE", BITPIX=16, NAXIS=2, NAXIS1=80, NAXIS2=64, PCOUNT=0, GCOUNT=1, BZERO=32768
    )
    content = fits_image(8) + table + padded(bytes(3050)) + extension + unsigned(COUNTS[0])
    np.testing.assert_array_equal(read(tmp_path / "a.fits", content), COUNTS[:1])


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (fits_image(16, 10**9, 10**9) + bytes(2880), "cannot hold 1 frame"),
        (fits_image(16, 80, 64, 10**9) + unsigned(COUNTS), "header names 1000000000 frames"),
        (fits_image(16, 80, 0) + bytes(2880), "no image"),
        (fits_image(17, 80, 64) + unsigned(COUNTS), "BITPIX is 17"),
        (fits_image(16, 80, -64) + unsigned(COUNTS), "negative length"),
        (fits_image(16, 80, 64)[:2000], "truncated"),
        (fits_image(8), "no image"),
        # its negative size led back to the same header, a thousand times
        (fits_image(16) + NEGATIVE + bytes(2880), "no image"),
        (
            fits_image(16, 80, 64, BSCALE=0.5) + unsigned(COUNTS[0]),
            "its values are scaled (BSCALE = 0.5, BZERO = 0) and no longer counts.",
        ),
        (fits_image(16, 80, 64, BAYERPAT="RGGB") + unsigned(COUNTS[0]), "of a colour camera"),
        (fits_image(16, 80, 64, BZERO=100.0) + unsigned(COUNTS[0]), "BZERO = 100"),
        (fits_image(16, 80, 64, BZERO="none") + unsigned(COUNTS[0]), "no number"),
        (fits_header(SIMPLE="T", BITPIX=8, NAXIS=10**6), "NAXIS is 1000000"),
        (
            fits_image(8)
            + fits_header(XTENSION="BINTABLE", BITPIX=8, NAXIS=1, NAXIS1=9, ZIMAGE="T"),
            "funpack",
        ),
    ],
)
def test_damaged_and_other_headers_are_refused(tmp_path, content, reason):
    assert reason in refusal(tmp_path / "a.fits", content)


@pytest.mark.parametrize("dtype", ["u1", "u2", "i2", "u4", "f4", "f8"])
@pytest.mark.parametrize("place", ["first", "extension"])
def test_files_of_astropy_are_read(tmp_path, dtype, place):
    fits = pytest.importorskip("astropy.io.fits")
    counts = (COUNTS >> 8).astype(dtype)
    parts = [fits.PrimaryHDU(counts)]
    if place == "extension":
        table = fits.BinTableHDU.from_columns([fits.Column("a", "J", array=np.arange(9))])
        parts = [fits.PrimaryHDU(), table, fits.ImageHDU(counts)]
    fits.HDUList(parts).writeto(tmp_path / "a.fits")
    found = read(tmp_path / "a.fits", (tmp_path / "a.fits").read_bytes())
    assert found.dtype == counts.dtype
    np.testing.assert_array_equal(found, counts)


@pytest.mark.parametrize("kind", ["RICE_1", "GZIP_1", "GZIP_2", "HCOMPRESS_1", "PLIO_1"])
@pytest.mark.parametrize("name", ["a.fits", "a.fits.fz"])
def test_compressed_images_of_astropy_are_refused(tmp_path, kind, name):
    """The image behind it is not taken in its place."""
    fits = pytest.importorskip("astropy.io.fits")
    counts = (COUNTS[0] & 0xFFF).astype(np.int16)
    parts = [fits.PrimaryHDU(), fits.CompImageHDU(counts, compression_type=kind)]
    fits.HDUList([*parts, fits.ImageHDU(counts)]).writeto(tmp_path / name)
    assert refusal(tmp_path / name) == "its image is compressed. Expand the file with funpack."


def test_an_exponent_may_be_written_with_a_d(tmp_path):
    """FITS standard 4.0, section 4.2.4."""
    counts = np.arange(12, dtype=np.uint16).reshape(1, 3, 4) + 32760
    content = fits_image(16, 4, 3, 1, BZERO="3.2768D4") + unsigned(counts)
    np.testing.assert_array_equal(read(tmp_path / "a.fits", content.replace(b"'", b" ")), counts)
