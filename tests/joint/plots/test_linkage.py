"""Figure and movie of a crank-rocker: positions by circles, limits, extremes."""

import numpy as np
import numpy.testing as npt
import pytest
from PIL import Image
from scenes.pictures import picture, without_texts

from erlif.core.errors import OutputError
from erlif.joint import plots
from erlif.joint.plots.linkage import pin_places

LINKS = np.array([0.055, 0.44, 0.26, 0.51])  # m, Farzaneh (2002), appendix A.2


@pytest.fixture(scope="module")
def design():
    return plots.example_linkage()


@pytest.fixture(scope="module")
def drawn(design):
    return plots.linkage_view(design)


def test_links_keep_their_lengths_and_turn_with_the_crank(design):
    angle = np.linspace(0, 6, 40)
    places = pin_places(design.linkage, angle)
    lengths = np.hypot(*np.diff(places, axis=1).T)
    npt.assert_allclose(lengths, LINKS[:3, None] * np.ones(40))
    npt.assert_allclose(places[:, 3] - places[:, 0], [[LINKS[3], 0.0]] * 40)
    npt.assert_allclose(np.exp(1j * angle), (places[:, 1] @ [1, 1j]) / LINKS[0])


def test_limits_are_drawn_with_crank_and_coupler_in_line(drawn):
    lines = {line.get_label(): line for line in drawn.links.axes.get_lines()}
    (low,) = (line for name, line in lines.items() if "smallest rocker angle 47.41°" in name)
    (high,) = (line for name, line in lines.items() if "largest rocker angle 71.84°" in name)
    for line, reach in ((low, 440 - 55), (high, 440 + 55)):
        x, y = line.get_data()
        npt.assert_allclose(np.hypot(x[2], y[2]), reach)
    (middle,) = (line for name, line in lines.items() if "middle" in name)
    x, y = middle.get_data()
    # half-way along the coupler at crank angle 0
    pins = 1e3 * pin_places(drawn.linkage, np.zeros(1))[0]
    npt.assert_allclose([x[0], y[0]], pins[1:3].mean(axis=0))


def test_curves_over_a_turn(design):
    line, extremes = plots.transmission_over_crank(design)
    npt.assert_allclose(extremes.get_ydata(), [76.30, 104.69], atol=5e-3)
    npt.assert_allclose([min(line.get_ydata()), max(line.get_ydata())], extremes.get_ydata())
    (speed,) = plots.rocker_over_crank(design)
    npt.assert_allclose(max(speed.get_ydata()) * np.pi / 30, 2.552104, rtol=1e-4)


def test_a_movie_is_one_turn(design, tmp_path):
    path = plots.linkage_movie(design, tmp_path / "turn.gif", positions=2)
    with Image.open(path) as movie:
        assert movie.n_frames == 2
        assert movie.info["loop"] == 0
    with pytest.raises(OutputError, match="exists"):
        plots.write_linkage(design, tmp_path / "turn.gif")


@picture
def test_picture_of_a_linkage(design):
    return without_texts(plots.linkage_figure(design))


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [("turn.mp4", {}, r"a name in \.gif"), ("one.gif", {"positions": 1}, "2 positions at least")],
)
def test_a_movie_that_cannot_be_made_is_refused(name, options, message):
    with pytest.raises(OutputError, match=message):
        plots.linkage_movie(plots.example_linkage(), name, **options)
