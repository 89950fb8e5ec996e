"""Results of triggers and frames: stored by name, summed up in notes."""

import math
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import numpy.testing as npt
import pytest
from scenes.results import make_position, make_result, make_statistics

from erlif.core.notes import Level
from erlif.io.ingest import FramePairs, Page
from erlif.pipeline.engines.results import (
    FrameResult,
    TriggerResult,
    describe_frame_notes,
    known_digests,
    mean_drift,
)
from erlif.ratio import PairRatio
from erlif.trend import GapShape

PAIRS = FramePairs(Path(), ((), ()), (64, 64), (12, 12))


def test_result_survives_a_file(tmp_path):
    """Arrays of a trigger are kept in one file until the film is written."""
    result = replace(make_result(0, 5, minimum=math.nan), position=make_position((0.01, 0.02)))
    result = replace(result, minima=dict.fromkeys(GapShape, make_statistics(mean=4.0).gap))
    np.savez(tmp_path / "trigger.npz", **result.to_arrays())
    with np.load(tmp_path / "trigger.npz") as arrays:
        npt.assert_equal(asdict(TriggerResult.from_arrays(arrays)), asdict(result))


def test_frame_result_takes_drift_peaks_and_hashes_from_its_ratio():
    image = np.ones((64, 64), np.float32)
    flags, digests = np.zeros(image.shape, np.uint16), (f"{1:064x}", f"{2:064x}")
    pair = PairRatio(*[image] * 4, flags, image, 1.0, (0.25, -0.5), (3100, 2100), digests)
    found = FrameResult.of(7, pair)
    assert (found.frame, found.drift, found.peaks) == (7, (0.25, -0.5), (3100, 2100))
    assert found.digests == digests
    npt.assert_array_equal(found.pulse.log_ratio, 1)


def test_hashes_of_frames_are_known_by_the_files_of_the_frames():
    pages = tuple(tuple(Page(Path(f"camera{n}", f"{k}.tif"), 0) for k in range(3)) for n in (1, 2))
    pairs = FramePairs(Path(), pages, (64, 64), (12, 12))
    frames = [
        FrameResult(2, (0.0, 0.0), (1, 1), digests=("a2", "b2")),
        FrameResult(0, (0.0, 0.0), (1, 1), digests=("a0", "")),
    ]
    assert known_digests(frames, pairs) == {
        Path("camera1/2.tif"): "a2",
        Path("camera2/2.tif"): "b2",
        Path("camera1/0.tif"): "a0",
    }


def test_mean_drift_leaves_out_frames_without_common_texture():
    frames = [
        FrameResult(0, (0.2, 1.0), (1, 1)),
        FrameResult(1, (math.nan, math.nan), (1, 1)),
        FrameResult(2, (0.4, 2.0), (1, 1)),
    ]
    npt.assert_allclose(mean_drift(frames), [0.3, 1.5])
    npt.assert_array_equal(mean_drift(frames[1:2]), [0, 0])
    npt.assert_array_equal(mean_drift([]), [0, 0])


def test_frames_without_common_texture_have_one_note_in_their_order():
    lost = [FrameResult(k, (math.nan, math.nan), (4000, 4000)) for k in (5, 2)]
    (note,) = describe_frame_notes([*lost, *make_result(1).frames], PAIRS)
    assert note.level is Level.WARNING
    assert note.subject == "frame pairs 2, 5"


def test_counts_far_below_full_scale_have_a_note_for_their_camera():
    """A sixteenth of 4095 is 255; the highest count of all frames decides."""
    frames = [FrameResult(0, (0.0, 0.0), (100, 3000)), FrameResult(1, (0.0, 0.0), (255, 90))]
    (note,) = describe_frame_notes(frames, PAIRS)
    assert "camera1" in str(note)
    assert "255 of 4095" in note.text


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (-0.1 * (np.arange(60) >= 35), "from frame 35 on"),
        (-0.4 * np.arange(60) / 59, "from the first to the last frame"),
    ],
)
@pytest.mark.parametrize("camera", [0, 1])
def test_camera_that_loses_sharpness_is_named(camera, change, text):
    """Its speckle differs from frame to frame by 5 %, in both cameras alike, and by 2 % in each."""
    rng = np.random.default_rng(3)
    sharpness = np.log(0.3) + 0.05 * rng.standard_normal((60, 1)) + 0.02 * rng.normal(size=(60, 2))
    assert describe_frame_notes(with_sharpness(sharpness), PAIRS) == []
    sharpness[:, camera] += change
    (note,) = describe_frame_notes(with_sharpness(sharpness), PAIRS)
    assert note.subject == f"camera{camera + 1}"
    assert text in note.text
    found = float(note.text.split(" ±")[0].split()[-1])
    assert abs(found - 100 * np.expm1(change[-1])) < 4


def with_sharpness(logarithm):
    return [
        FrameResult(k, (0.0, 0.0), (4000, 4000), sharpness=tuple(np.exp(row)))
        for k, row in enumerate(logarithm)
    ]


def test_good_frames_and_no_frames_have_no_note():
    assert describe_frame_notes(make_result(0, 1).frames, PAIRS) == []
    assert describe_frame_notes([], PAIRS) == []
