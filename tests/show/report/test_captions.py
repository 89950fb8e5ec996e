"""Every figure has a caption that names its panels."""

from __future__ import annotations

import re

import pytest

from erlif.show import plots
from erlif.show.plots.files import DRAWN, FigureSource
from erlif.show.report.captions import CAPTIONS


def test_every_figure_has_a_caption_that_is_a_sentence():
    assert set(CAPTIONS) >= set(DRAWN)
    for caption in CAPTIONS.values():
        assert caption.text.endswith(".")
        assert not caption.title.endswith(".")
        assert caption.kind in ("svg", "png")


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """The example with the images of its second trigger."""
    path = plots.write_example(tmp_path_factory.mktemp("example") / "film.nc")
    film = plots.example_film()
    source = FigureSource(path, film, 1, None, None)
    source.__dict__["images"] = plots.example_images(film, trigger=1)
    return source


@pytest.mark.parametrize("name", sorted(set(DRAWN) - {"fixture_profile"}))
def test_caption_names_the_panels_that_are_drawn(name, source):
    """Letters in the caption are those in the figure."""
    figure = DRAWN[name](source)
    titles = [ax.get_title(loc="left") for ax in figure.axes]
    drawn = {found[1] for found in map(re.compile(r"\(([a-d])\)").search, titles) if found}
    named = {
        letter for group in re.findall(r"\(([a-d, ]+)\)", CAPTIONS[name].text) for letter in group
    }
    named -= {",", " "}
    assert named <= drawn
    assert not named or named == drawn
