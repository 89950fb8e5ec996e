"""Stacks for ImageJ, read by Pillow and from the tags of TIFF."""

import numpy as np
import pytest
import tifffile
from PIL import Image

from erlif.core.progress import silent
from erlif.io.conversion.stack import write_stack


@pytest.fixture(scope="module")
def stack(film, tmp_path_factory):
    path = tmp_path_factory.mktemp("stack") / "film.tif"
    write_stack(film, path, triggers=[0, 1, 2, 3, 4, 5], progress=silent)
    return path


def test_pages_follow_each_other_channel_by_channel(film, stack):
    with Image.open(stack) as image:
        assert image.n_frames == 6 * 4
        for page, name in ((4, "thickness"), (5, "thickness_std"), (7, "flags")):
            image.seek(page)
            assert image.mode == "F"
            np.testing.assert_array_equal(np.asarray(image), film[name].values[1])


def test_imagej_knows_pixel_size_unit_and_order(stack):
    with tifffile.TiffFile(stack) as file:
        text = file.pages[0].description
        tags = file.pages[0].tags
        across, each = tags["XResolution"].value
        labels = file.imagej_metadata["Labels"]
    assert "unit=mm" in text
    assert "channels=4" in text
    assert "frames=6" in text
    assert across / each == pytest.approx(1 / 0.25)  # pixels in a millimetre
    assert labels[4].startswith("thickness um, trigger 1, ")
    assert labels[7].startswith("flags, trigger 1, ")


def test_pixel_size_is_that_of_an_image_whichever_way_it_runs(film, tmp_path):
    path = tmp_path / "film.tif"
    for part, expected in (
        (film.isel(x=slice(None, None, -1)), 1 / 0.25),
        (film.isel(x=[3]), 1.0),  # a single column has none
    ):
        write_stack(part, path, triggers=[0], progress=silent)
        with tifffile.TiffFile(path) as file:
            across, each = file.pages[0].tags["XResolution"].value
        assert across / each == pytest.approx(expected)


def test_a_stack_above_four_gigabytes_has_its_images_in_one_piece(film, tmp_path, monkeypatch):
    path = tmp_path / "film.tif"
    monkeypatch.setattr("erlif.io.conversion.stack.LARGEST", 1000)
    write_stack(film, path, triggers=[1, 2], progress=silent)
    with tifffile.TiffFile(path) as file:
        assert len(file.pages) == 1  # ImageJ finds the others by their number
        start = file.pages[0].dataoffsets[0]
        assert "images=8" in file.pages[0].description
    images = np.fromfile(path, "<f4", count=8 * 24 * 64, offset=start).reshape(8, 24, 64)
    np.testing.assert_array_equal(images[4], film.thickness.values[2])
