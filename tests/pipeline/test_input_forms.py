"""The same frames in other files: the film must not depend on how a rig writes them."""

import shutil

import numpy as np
import tifffile

import erlif


def read_pages(path):
    pages = tifffile.imread(path)
    return pages if pages.ndim == 3 else pages[np.newaxis]


def write_pages(path, pages):
    with tifffile.TiffWriter(path) as file:
        for page in pages:
            file.write(page, contiguous=False, metadata=None, photometric="minisblack")


def test_multi_page_files_give_the_film_of_single_pages(lab, film):
    for camera in (1, 2):
        pages = np.concatenate([read_pages(path) for path in lab.frames(camera)])
        shutil.rmtree(lab.run / f"camera{camera}")
        write_pages(lab.run / f"all{camera}.tiff", pages)
        lab.edit("run/run.toml", (f'"camera{camera}/*.tif"', f'"all{camera}.tiff"'))
    with erlif.open_film(film) as reference:
        np.testing.assert_array_equal(erlif.process(lab.run).thickness, reference.thickness)


def test_eight_bit_frames_give_the_mean_film_of_twelve_bits(lab, film):
    """4.4 electrons per count of 12 bits are 70.4 per count of 8 bits."""
    for directory in (lab.run, lab.fixture):
        for path in directory.rglob("*.tif"):
            write_pages(path, (read_pages(path) >> 4).astype(np.uint8))
        toml = directory / f"{directory.name}.toml"
        text = toml.read_text().replace("bit_depth = 12", "bit_depth = 8")
        text = text.replace("4.4 electron/DN", "70.4 electron/DN")
        for camera in (1, 2):
            # 64 DN over 16, less the mean of the four bits that are cut off
            text = text.replace(f'dark = "camera{camera}_dark.tif"', 'offset = "3.5 DN"')
        toml.write_text(text)
    coarse = erlif.process(lab.run, calibration=erlif.calibrate(lab.fixture))
    with erlif.open_film(film) as fine:
        np.testing.assert_allclose(coarse.film_mean, fine.film_mean, rtol=0.02)
    assert (coarse.flags == 0).mean() > 0.5
