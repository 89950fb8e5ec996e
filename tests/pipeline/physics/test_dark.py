"""Dark level of a run: against its dark frames, steps of it, and light that is mistaken for it."""

import re

import numpy as np
import numpy.testing as npt
import pytest

from erlif.correction import UnlitPixels
from erlif.pipeline.engines.results import FrameResult
from erlif.pipeline.physics.dark import DarkLevel, describe_dark_levels, find_dark_levels
from erlif.show.plots import example_calibration
from erlif.trend import CourseChange

GAINS = np.array([4.0, 4.0])


def unlit(count, variance_std):
    near, dark = np.ones(count - 1, bool), np.zeros(count, np.float32)
    return UnlitPixels(np.arange(count), near, dark, 0.01, 4.0, variance_std, 1000.0)


PIXELS = unlit(400, 0.02)
STEP = (np.arange(50) >= 30).astype(float)


def find(level, light=0.0, *, pixels=PIXELS, seed=1):
    """Of camera 2, whose unlit pixels have a level by frame and some light. [DN]"""
    rng = np.random.default_rng(seed)
    size = pixels.place.size
    lights = {}
    for frame, one in enumerate(np.broadcast_to(level, 50)):
        variance = 4.0 + light / 4.0
        values = one + light + np.sqrt(variance) * rng.standard_normal(size)
        read = (float(values.mean()), float(np.mean(np.diff(values) ** 2) / 2))
        lights[frame] = FrameResult(frame, (0.0, 0.0), (1, 1), dark=((np.nan, np.nan), read))
    return find_dark_levels(lights, (None, pixels), GAINS)


def test_level_of_the_run_is_found_with_its_error():
    (found,) = find(20.0)
    assert (found.camera, found.change) == (2, None)
    assert abs(found.level - 20) < found.std < 1
    npt.assert_allclose(found.share, 0.02, rtol=0.02)


def test_step_is_found_with_its_frame_and_counts_at_its_largest():
    (found,) = find(-15 * STEP)
    assert found.change.frame == 30
    npt.assert_allclose(found.change.size, -15, atol=0.2)
    # 40 % of the frames have -15 DN
    npt.assert_allclose(found.level, -6, atol=0.2)
    assert found.share > 0.0134


def test_right_dark_and_a_level_without_consequence_are_not_reported():
    for seed in range(40):
        assert find(0.0, seed=seed) == []
    assert find(4.0) == []


def test_light_in_the_pixels_is_no_dark():
    """20 DN of light have a shot noise that dark pixels have not."""
    for seed in range(40):
        assert find(0.0, light=20.0, seed=seed) == []
    (found,) = find(60.0, light=5.0)
    assert abs(found.level - 60) < 2 * found.std


def test_three_pixels_show_a_level_of_twenty_counts():
    few = unlit(3, 0.5)
    found = [find(20.0, pixels=few, seed=seed) for seed in range(40)]
    assert np.mean([len(one) for one in found]) > 0.8
    assert not any(find(0.0, pixels=few, seed=seed) for seed in range(40))


def test_cameras_without_dark_pixels_and_runs_without_frames_have_no_level():
    assert find_dark_levels({}, (PIXELS, PIXELS), GAINS) == []
    lit = {0: FrameResult(0, (0.0, 0.0), (1, 1))}
    assert find_dark_levels(lit, (PIXELS, None), GAINS) == []


CHANGES = {
    "dark frames are not those": None,
    "from frame 30 on": CourseChange(30, 20.0, 0.1, 9.0),
    "from the first to the last frame": CourseChange(None, 20.0, 0.1, 9.0),
}


@pytest.mark.parametrize("camera", [1, 2])
@pytest.mark.parametrize("text", CHANGES)
def test_note_names_camera_and_film(camera, text):
    """2 % of the light of the median film, over the slope of the curve."""
    calibration = example_calibration()
    level = DarkLevel(camera, 20.0, 0.1, 1000.0, CHANGES[text])
    (note,) = describe_dark_levels([level], calibration, 6.0)
    assert note.subject == f"camera{camera}"
    assert text in note.text
    shift = 1e3 * 0.02 / float(calibration.slope(6.0)) * (1 if camera == 2 else -1)
    assert re.match(
        rf".*films of 6\.0 um (are|drift by) {re.escape(f'{shift:+.0f}')} nm", note.text
    )
