"""Scripts of the gallery: each runs on its own and draws one figure."""

import runpy
import sys
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import pytest

GALLERY = Path(__file__).parents[2] / "docs" / "gallery"
SCRIPTS = sorted(GALLERY.glob("plot_*.py"))


def test_gallery_has_at_least_eight_scripts():
    assert len(SCRIPTS) >= 8


@pytest.mark.slow
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_script_draws_one_figure_with_data_in_each_panel(script, monkeypatch):
    matplotlib.use("Agg")
    monkeypatch.syspath_prepend(str(GALLERY))
    try:
        runpy.run_path(str(script), run_name="__main__")
        (number,) = plt.get_fignums()
        panels = plt.figure(number).get_axes()
        assert panels
        assert all(panel.has_data() or panel.images for panel in panels)
    finally:
        plt.close("all")
        sys.modules.pop("sample", None)
