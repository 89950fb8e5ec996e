"""Means of squares of pixels."""

import numpy as np
import numpy.testing as npt

from erlif.show.view.levels import choose_step, cover, reduce_map


def test_a_plane_stays_a_plane():
    """The mean of a plane over a square is its value at the centre; the last may be cut."""
    for step in (2, 3, 4, 7):
        rows, columns = 4 * step, 5 * step
        plane = np.add.outer(3.0 * np.arange(rows), np.arange(columns)).astype(np.float32)
        values, flags = reduce_map(plane, np.zeros(plane.shape, np.uint16), step=step)
        centre = np.arange(5) * step + (step - 1) / 2
        npt.assert_allclose(values, np.add.outer(3 * centre[:4], centre), rtol=1e-6)
        assert not flags.any()
    plane = np.arange(15, dtype=np.float32).reshape(3, 5)
    values, _ = reduce_map(plane, np.zeros((3, 5), np.uint16), step=2)
    npt.assert_allclose(values, [[3, 5, 6.5], [10.5, 12.5, 14]])


def test_flagged_pixels_do_not_enter_the_mean():
    flags = np.array([[0, 0, 4], [0, 64, 2], [1, 1, 0]], np.uint16)
    values = np.where(flags == 0, 5, 1e6).astype(np.float32)
    mean, found = reduce_map(values, flags, step=3)
    assert np.isnan(mean).all()  # 4 of 9 pixels are valid
    assert found.tolist() == [[1 | 2 | 4 | 64]]
    mean, found = reduce_map(values[:2, :2], flags[:2, :2], step=2)
    assert mean.tolist() == [[5]]
    assert not found.any()


def test_the_screen_loses_no_detail_that_it_could_show():
    whole = slice(0, 1024), slice(0, 1280)
    assert choose_step(whole, (1280, 1024)) == 1
    assert choose_step(whole, (800, 640)) == 1
    assert choose_step(whole, (700, 560)) == 2  # 1.8 pixels of the map on one of the screen
    assert choose_step(whole, (320, 256)) == 4
    assert choose_step(whole, (320, 256), coarse=True) == 8
    assert choose_step((slice(100, 200),) * 2, (640, 512), coarse=True) == 1


def test_a_window_always_has_pixels_of_the_map():
    for corners in ((-9, -9, -5, -5), (1e9, 1e9, 2e9, 2e9), (5.5, 5.5, 5.5, 5.5)):
        rows, columns = cover((100, 200), corners)
        assert 0 <= columns.start < columns.stop <= 200
        assert 0 <= rows.start < rows.stop <= 100
