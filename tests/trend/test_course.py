"""Steps and drifts over a run: found with frame, size and error, and not found where there is none.

The light of the cells follows the narrow-band law of `scenes.cells`; a gain multiplies that of
camera 2 and is therefore added to the logarithm of the ratio.
"""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.cells import CALIBRATION, X, Y, draw_run

from conftest import FULL
from erlif.trend import find_ratio_change, find_shift

FRAMES = np.arange(50)
STEP = (FRAMES >= 25).astype(float)
DRIFT = FRAMES / 49


def find(rng, course, **run):
    """The change found where a course, (frame,), is added to the logarithm of the ratio. [1]"""
    record, _ = draw_run(rng, **run)
    changed = record._replace(log_ratio=record.log_ratio + course[:, None])
    return find_ratio_change(FRAMES, changed, (X, Y), CALIBRATION)


@pytest.mark.parametrize(("course", "frame"), [(STEP, 25), (DRIFT, None)])
def test_size_of_a_change_is_right_within_its_error(course, frame):
    rng = np.random.default_rng(1)
    count = 25 if FULL else 15
    found = [find(rng, 0.02 * course) for _ in range(count)]
    assert all(one.significant for one in found)
    for one in found:
        assert one.frame is None if frame is None else abs(one.frame - frame) < 2

    pulls = np.array([(one.size - 0.02) / one.std for one in found])
    assert abs(pulls.mean()) < 3 / np.sqrt(count)
    assert abs(pulls.std() - 1) < 3.5 / np.sqrt(2 * count)


def test_large_step_is_not_that_of_its_first_linear_guess():
    found = find(np.random.default_rng(2), np.log(1.05) * STEP)
    assert found.frame == 25
    npt.assert_allclose(found.size, np.log(1.05), atol=4 * found.std)
    assert found.std < 0.002


def test_sound_runs_have_no_change():
    rng = np.random.default_rng(33)
    assert not any(find(rng, 0 * STEP).significant for _ in range(60 if FULL else 20))


def test_drift_beside_whatever_explains_more_is_right_within_its_error():
    """Drifts of 0.1 % rms; those of most runs are not significant."""
    rng, count = np.random.default_rng(34), 40 if FULL else 20
    sizes = 0.001 * rng.standard_normal(count)
    found = [find(rng, size * DRIFT) for size in sizes]
    assert sum(one.significant for one in found) < count / 4
    pulls = [(one.drift[0] - size) / one.drift[1] for one, size in zip(found, sizes, strict=True)]
    assert abs(np.mean(pulls)) < 3 / np.sqrt(count)
    assert abs(np.std(pulls) - 1) < 3 / np.sqrt(2 * count)


def test_beam_that_moves_and_pulses_that_grow_weaker_are_no_change_of_the_ratio():
    record, _ = draw_run(np.random.default_rng(4))
    moved = record.light + STEP[:, None] * (0.05 * X - 0.03 * Y) - 0.2 * DRIFT[:, None]
    found = find_ratio_change(FRAMES, record._replace(light=moved), (X, Y), CALIBRATION)
    assert not found.significant


def test_one_film_everywhere_determines_nothing():
    found = find(np.random.default_rng(5), 0.05 * STEP, films=(3.0, 3.0), flat=True)
    assert found is None or not found.significant


def test_frames_keep_their_numbers_where_some_have_no_cells():
    record, _ = draw_run(np.random.default_rng(6))
    ratio = record.log_ratio + 0.05 * STEP[:, None]
    ratio[3:7] = np.nan
    found = find_ratio_change(2 * FRAMES, record._replace(log_ratio=ratio), (X, Y), CALIBRATION)
    assert found.frame == 50


def test_step_among_wandering_values_is_found_and_wandering_alone_is_not():
    rng = np.random.default_rng(7)
    for _ in range(50):
        noise = 0.3 * rng.standard_normal(50)
        wandering = np.convolve(rng.standard_normal(53), np.ones(4) / 2, "valid")
        assert not find_shift(FRAMES, wandering).significant
        found = find_shift(FRAMES, noise + 6 * STEP)
        assert (found.frame, found.significant) == (25, True)
        assert abs(found.size - 6) < 5 * found.std


def test_values_without_noise_or_without_frames():
    assert not find_shift(FRAMES, 0 * STEP).significant
    assert find_shift(FRAMES[:11], STEP[:11]) is None
    assert find_shift(FRAMES, np.where(FRAMES < 40, np.nan, 1.0)) is None
