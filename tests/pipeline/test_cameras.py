"""Darks, flats and counts of both cameras, read from the files of the small rig."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
import tifffile

from erlif.core.errors import FrameError
from erlif.ingest import open_run
from erlif.pipeline.cameras import (
    characterise_cameras,
    count_frames,
    declared_noise,
    measure_cameras,
)


def test_histogram_counts_all_pixels_of_all_frames(run, small_rig):
    """Six frames are fewer than the eight that are searched."""
    for camera, histogram in enumerate(count_frames(run.pairs), 1):
        frames = np.stack([tifffile.imread(path) for path in small_rig.frames(camera)])
        npt.assert_array_equal(histogram, np.bincount(frames.ravel(), minlength=4096))


def test_pairs_that_were_left_out_are_not_counted(run):
    without = replace(run.pairs, skipped={0: "damaged", 3: "damaged"})
    for histogram in count_frames(without):
        assert histogram.sum() == 4 * 128 * 96


def test_declared_noise_is_that_of_the_settings(run):
    for declared in declared_noise(run):
        assert (declared.gain, declared.read_noise) == (4.4, 9.0)


def test_dark_of_each_pixel_is_the_mean_of_the_pages(run, small_rig):
    for camera, measured in enumerate(measure_cameras(run), 1):
        pages = tifffile.imread(small_rig.run / f"camera{camera}_dark.tif")
        npt.assert_allclose(measured.darks.mean, pages.mean(axis=0), rtol=1e-6)
        assert measured.darks.pages == len(pages)
        assert measured.has_flat


def test_level_in_the_settings_replaces_darks(lab):
    lab.edit("run/run.toml", ('dark = "camera1_dark.tif"', 'offset = "61 DN"'))
    one, two = measure_cameras(open_run(lab.run))
    npt.assert_array_equal(one.darks.mean, 61.0)
    assert (one.darks.pages, two.darks.pages) == (0, 4)


def test_camera_without_a_flat_has_an_even_response(lab):
    lab.edit("run/run.toml", ('flat = "camera2_flat.tif"', ""))
    references = characterise_cameras(open_run(lab.run)).references
    assert references.has_flat.values.tolist() == [True, False]
    npt.assert_array_equal(references.flat[1], 1.0)


def test_declared_gain_is_used_whatever_the_flats_give(lab):
    lab.edit("run/run.toml", ('gain = "4.4 electron/DN"', 'gain = "4.9 electron/DN"'))
    references = characterise_cameras(open_run(lab.run)).references
    npt.assert_allclose(references.gain, [4.9, 4.4])
    assert references.gain_known.values.all()


def test_missing_darks_are_refused_with_their_camera(lab):
    (lab.run / "camera2_dark.tif").unlink()
    with pytest.raises(FrameError, match="camera2"):
        measure_cameras(open_run(lab.run))
