"""Noise of the ratio against gain and read noise."""

import cv2
import numpy as np
import pytest
import tifffile

from erlif.core.progress import silent
from erlif.io.ingest import open_run
from erlif.pipeline.audit.noise import measure_noise, note_noise
from erlif.pipeline.recording.prepare import prepare_chain


def rewrite(lab, change):
    for path in (*lab.frames(1), *lab.frames(2)):
        image = tifffile.imread(path)
        path.unlink()
        tifffile.imwrite(path, change(image).astype(np.uint16))


def prepared(lab):
    ready = prepare_chain(open_run(lab.run), silent)
    return ready.chain, ready.sample


def test_sound_frames_have_the_noise_of_their_cameras(lab):
    assert measure_noise(*prepared(lab)) == pytest.approx(1.05, abs=0.06)
    assert list(note_noise(*prepared(lab))) == []


@pytest.mark.parametrize(
    "change",
    [lambda i: i >> 1, lambda i: np.rint(i / 2), lambda i: cv2.GaussianBlur(i, (3, 3), 0.6)],
    ids=["cut in half", "rounded to the half", "smoothed"],
)
def test_counts_that_were_halved_or_smoothed_have_too_little_noise(lab, change):
    rewrite(lab, change)
    (note,) = note_noise(*prepared(lab))
    assert note.level == "warning"
    assert "Export the raw counts" in note.text


def test_without_valid_pixels_nothing_is_known(lab):
    chain, _ = prepared(lab)
    assert np.isnan(measure_noise(chain, []))
