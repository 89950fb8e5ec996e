"""Every figure has a caption that names its panels."""

from __future__ import annotations

from erlif.show.plots.files import DRAWN
from erlif.show.report.captions import CAPTIONS


def test_every_figure_has_a_caption_that_is_a_sentence():
    assert set(CAPTIONS) >= set(DRAWN)
    for caption in CAPTIONS.values():
        assert caption.text.endswith(".")
        assert not caption.title.endswith(".")
        assert caption.kind in ("svg", "png")
