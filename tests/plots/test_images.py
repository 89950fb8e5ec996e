"""Each figure against its stored picture, without texts.

``pytest tests/plots/test_images.py --mpl-generate-path=tests/plots/baseline`` draws the pictures
again; look at each before it is stored.
"""

from __future__ import annotations

import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from erlif import plots
from erlif.calibration import Profile
from erlif.plots.files import DRAWN, find_source
from erlif.plots.style import fix_layout

TOLERANCE = 1.5
"""Rms of the differences of two pictures; curves that are 2 % higher give 4.3 and more."""

picture = pytest.mark.mpl_image_compare(
    baseline_dir="baseline",
    tolerance=TOLERANCE,
    savefig_kwargs={"dpi": 60},
    style="default",
    deterministic=True,
)


@pytest.fixture
def source(film_path, film):
    """The film of the scene, with the run directory."""
    return find_source(film_path, film, None, None, None)


def drawn(figure) -> Figure:
    """The figure in its layout, then without texts, whose pixels differ between machines."""
    whole = fix_layout(figure)
    for text in whole.findobj(Text):
        text.set_alpha(0.0)
    return whole


@pytest.mark.parametrize("name", [name for name in DRAWN if name != "fixture_profile"])
@picture
def test_figure(source, name):
    return drawn(DRAWN[name](source))


@picture
def test_fixture_profile(calibration):
    wedge = calibration.curve.curve_thickness.values
    profile = Profile(wedge / 0.8, wedge, 0.02 * wedge)
    points, *_ = plots.fixture_profile(profile, calibration=calibration)
    return drawn(points.axes.get_figure())


@picture
def test_pressure():
    return drawn(plots.pressure_figure(plots.example_pressure()))


@picture
def test_frame_of_the_movie(film):
    return drawn(plots.cycle_view(film, trigger=1).figure)
