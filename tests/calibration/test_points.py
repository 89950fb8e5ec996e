"""Points of a line and of a surface, with and without the CMM's uncertainty."""

import numpy as np
from scenes.fixture import make_points

LINE = make_points(np.linspace(1.0, 10.0, 10))


def test_a_profile_with_two_axes_is_a_surface():
    assert not LINE.on_surface
    assert make_points(LINE.thickness, position=np.ones((10, 2))).on_surface


def test_error_bars_are_known_only_where_every_point_has_one():
    assert LINE.has_error_bars
    for known in (np.arange(10) != 3, np.zeros(10, bool)):
        std = np.where(known, 0.1, np.nan)
        assert not make_points(LINE.thickness, thickness_std=std).has_error_bars
