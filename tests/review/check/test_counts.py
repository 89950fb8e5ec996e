"""Copies, light and sharpness of the counts."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.pipeline.audit.bits import note_bits
from erlif.review.check.counts import (
    CountSurvey,
    FrameCounts,
    note_bad_pixels,
    note_copies,
    note_counts,
    note_light,
    survey_counts,
)


def frame(number, *, level=(500.0, 600.0), sharpness=(0.04, 0.04), digest=None):
    digest = (f"one {number}", f"two {number}") if digest is None else digest
    return FrameCounts(number, level, (0.0, 0.0), sharpness, digest)


def survey(*frames):
    empty = np.zeros(4096, np.int64)
    return CountSurvey(frames, (empty, empty))


@pytest.mark.parametrize(("bad", "level"), [(96, "note"), (97, "warning")])
def test_the_share_of_bad_pixels_is_stated(bad, level):
    """97 of 9600 pixels are more than one per cent."""
    pixels = np.zeros((2, 96, 100), bool)
    pixels[1].flat[:bad] = True
    one, two = note_bad_pixels(xr.Dataset({"bad": (("camera", "y", "x"), pixels)}))
    assert (one.level, two.level) == ("note", level)
    assert one.text.startswith("camera1: 0.00% of the pixels are hot, noisy or dead")
    assert two.text.startswith(f"camera2: {bad / 96:.2f}% of the pixels")


def test_one_image_for_all_frames_of_a_camera_is_an_error_that_names_it():
    (note,) = note_copies(survey(*(frame(n, digest=(f"one {n}", "two")) for n in range(3))))
    assert note.level == "error"
    assert "all 3 frames of camera2 that were read" in note.text


def test_a_missed_pulse_and_a_blurred_frame_are_named():
    frames = [frame(n) for n in range(6)]
    frames[2] = frame(2, level=(70.0, 62.0), sharpness=(0.01, 0.01))  # dim, and blurred by that
    frames[4] = frame(4, sharpness=(0.04, 0.02))
    _, dim, blurred = note_light(survey(*frames), (64.0, 60.0))
    assert "frame pairs 2 have less than 10% of the light" in dim.text
    assert "frame pairs 4 have less than 60% of the fine structure" in blurred.text


def test_counts_of_the_rig_are_those_of_its_files(run, small_rig):
    import tifffile

    found = survey_counts(run.pairs, [1, 3])
    for camera in (1, 2):
        images = [tifffile.imread(small_rig.frames(camera)[k]) for k in (1, 3)]
        expected = np.bincount(np.concatenate(images, axis=None), minlength=4096)
        npt.assert_array_equal(found.histograms[camera - 1], expected)
        assert [one.level[camera - 1] for one in found.frames] == [np.median(i) for i in images]
    assert list(note_bits(found.histograms)) == []
    assert [note.level for note in note_counts(found, run.pairs)] == ["note", "note"]
