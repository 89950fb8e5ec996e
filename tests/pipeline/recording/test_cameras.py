"""Darks, flats and counts of both cameras, read from the files of the small rig."""

import numpy as np
import numpy.testing as npt
import tifffile

from erlif.io.ingest import open_run
from erlif.pipeline.recording.cameras import characterise_cameras, look_at_frames


def test_histogram_counts_all_pixels_of_all_frames(run, small_rig):
    """Six frames are fewer than the eight that are searched."""
    for camera, look in enumerate(look_at_frames(run.pairs), 1):
        frames = np.stack([tifffile.imread(path) for path in small_rig.frames(camera)])
        npt.assert_array_equal(look.histogram, np.bincount(frames.ravel(), minlength=4096))
        npt.assert_allclose(look.view.centre, frames.mean(axis=0), rtol=1e-6)


def test_dark_of_each_pixel_is_the_mean_of_the_pages(run, small_rig):
    for camera, measured in enumerate(characterise_cameras(run).measured, 1):
        pages = tifffile.imread(small_rig.run / f"camera{camera}_dark.tif")
        npt.assert_allclose(measured.darks.mean, pages.mean(axis=0), rtol=1e-6)
        assert measured.darks.pages == len(pages)
        assert measured.has_flat


def test_level_in_the_settings_replaces_darks(lab):
    lab.edit("run/run.toml", ('dark = "camera1_dark.tif"', 'offset = "61 DN"'))
    one, two = characterise_cameras(open_run(lab.run)).measured
    npt.assert_array_equal(one.darks.mean, 61.0)
    assert (one.darks.pages, two.darks.pages) == (0, 4)


def test_camera_without_a_flat_has_an_even_response(lab):
    lab.edit("run/run.toml", ('flat = "camera2_flat.tif"', ""))
    references = characterise_cameras(open_run(lab.run)).cameras.references
    assert references.has_flat.values.tolist() == [True, False]
    npt.assert_array_equal(references.flat[1], 1.0)


def test_exchanged_flats_of_a_fixture_are_refused(lab, refused):
    one, two, aside = (lab.fixture / f"camera{n}_flat.tif" for n in (1, 2, 3))
    for old, new in ((one, aside), (two, one), (aside, two)):
        old.rename(new)
    message = refused("calibrate", lab.fixture, "-o", lab.fixture / "new.nc")
    assert "camera1 show the pixels of the flat of camera2" in message
