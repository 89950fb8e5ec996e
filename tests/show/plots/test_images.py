"""Figures that `test_files` does not draw against their stored pictures."""

from __future__ import annotations

from scenes.pictures import picture, without_texts

from erlif.calibration import Profile
from erlif.show import plots


@picture
def test_fixture_profile(calibration):
    wedge = calibration.curve.curve_thickness.values
    profile = Profile(wedge / 0.8, wedge, 0.02 * wedge)
    points, *_ = plots.fixture_profile(profile, calibration=calibration)
    return without_texts(points.axes.get_figure())


@picture
def test_pressure():
    return without_texts(plots.pressure_figure(plots.example_pressure()))


@picture
def test_frame_of_the_movie(film):
    return without_texts(plots.cycle_view(film, trigger=1).figure)
