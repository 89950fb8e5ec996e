"""Every figure has a caption that names its panels."""

import pytest
from scenes.motion import slider_film, static_film

from erlif.show.plots.files import DRAWN
from erlif.show.report.captions import CAPTIONS, caption_of


def test_every_figure_has_a_caption_that_is_a_sentence():
    assert set(CAPTIONS) >= set(DRAWN)
    for caption in CAPTIONS.values():
        assert caption.text.endswith(".")
        assert not caption.title.endswith(".")
        assert caption.kind in ("svg", "png")


@pytest.mark.parametrize(
    ("film", "titles", "absent"),
    [
        (static_film, ("Maps of the run", "Film thickness over the run"), "speed"),
        (slider_film, ("Maps of the cycle", "Film thickness and speed"), "rocker"),
    ],
)
def test_captions_of_other_motions_name_what_their_figures_show(film, titles, absent):
    shown = film()
    captions = [caption_of(name, shown) for name in ("map_sheet", "film_over_cycle")]
    assert tuple(caption.title for caption in captions) == titles
    assert not any(absent in caption.text for caption in captions)
    against = caption_of("film_against_speed", shown).text
    assert "(b)" not in against
    assert caption_of("speed_against_angle", shown).title == CAPTIONS["sliding_speed"].title
