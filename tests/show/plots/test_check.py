"""Pictures of an audit show its numbers."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.pipeline.audit.log import Steps
from erlif.review.check.cameras import PairPicture
from erlif.review.check.counts import CountSurvey, FrameCounts
from erlif.show.plots.check import histogram_figure, light_figure, pair_figure, steps_figure


@pytest.fixture
def picture():
    light = np.arange(48.0, dtype=np.float32).reshape(6, 8)
    difference = (0.01 * np.sin(light)).astype(np.float32)
    difference[0] = np.nan
    return PairPicture(7, (light, 2 * light), difference)


@pytest.fixture
def survey():
    frames = tuple(
        FrameCounts(n, (164.0 + n, 260.0 + n), (0.0, 0.0), (0.04, 0.03), ("", "")) for n in range(5)
    )
    one, two = np.zeros(4096, np.int64), np.zeros(4096, np.int64)
    one[100], two[4095] = 30, 50
    return CountSurvey(frames, (one, two))


def test_both_cameras_are_shown(picture):
    left, right = pair_figure(picture).axes[:2]
    npt.assert_array_equal(left.images[0].get_array(), picture.light[0])
    npt.assert_array_equal(right.images[0].get_array(), picture.light[1])
    assert right.get_title(loc="left").endswith("camera 2, pair 7")


def test_bars_hold_all_pixels(survey):
    steps = histogram_figure(survey).axes[0].patches
    assert [patch.get_data().values.sum() for patch in steps] == [30, 50]
    assert steps[1].get_data().values[-1] == 50
    deeper = CountSurvey(survey.frames, (survey.histograms[0], np.ones(65536, np.int64)))
    marks = [line.get_xdata()[0] for line in histogram_figure(deeper).axes[0].lines]
    assert sorted(marks) == [4095, 65535]  # full scale of either depth


def test_light_is_drawn_above_the_dark_level(survey):
    upper, lower = light_figure(survey, (64.0, 60.0)).axes
    npt.assert_allclose(upper.lines[0].get_ydata(), 100 + np.arange(5))
    npt.assert_allclose(upper.lines[1].get_ydata(), 200 + np.arange(5))
    npt.assert_allclose(lower.lines[1].get_ydata(), 3.0)


def test_angles_and_steps_of_time_are_drawn():
    upper, lower = steps_figure(Steps(np.array([0.0, 1, 3]), np.array([0.0, 0.01, 0.03]))).axes
    npt.assert_allclose(upper.lines[0].get_ydata(), [0, 1, 3])
    npt.assert_allclose(lower.lines[0].get_ydata(), [10, 20])
    assert steps_figure(Steps(None, None)) is None
