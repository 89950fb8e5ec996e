"""Maps: what is drawn is the film, at its place, with its flags."""

import re

import matplotlib.pyplot as plt
import numpy as np
import numpy.testing as npt
import pytest
from scenes import film as scene

from erlif.show import plots
from erlif.show.plots.maps import average_in_blocks, pixel_edges


def test_map_without_valid_pixels_states_why(film):
    empty = scene.without_valid_pixels(film)
    ax = plots.thickness_map(empty, trigger=0).axes
    assert ax.texts[0].get_text() == "no valid pixel\n100 % above range"
    profile = plots.sliding_profile(empty, trigger=0)[0].axes
    assert profile.texts[0].get_text() == "no valid pixel in the region of interest"
    nothing = 0 * empty.film_min + np.nan
    empty = empty.assign(film_mean=nothing, film_min=nothing)
    assert "100 % above range" in plots.film_over_cycle(empty)[0].axes.texts[0].get_text()
    maps = [ax for ax in plots.map_sheet_figure(empty).axes if ax.images]
    assert {ax.texts[0].get_text() for ax in maps} == {"no valid\npixel"}


def test_a_region_that_is_the_image_is_not_drawn(film, with_settings):
    assert len(plots.thickness_map(film, trigger=0).axes.lines) == 2
    for left, lines in ((0, 0), (1, 2)):
        table = re.search(r"\[thickness.roi\]\nx = .*\ny = .*", film.attrs["settings"])[0]
        whole = f"[thickness.roi]\nx = [{left}, 99]\ny = [0, 99]"
        chosen = with_settings((table, whole))
        assert len(plots.thickness_map(chosen, trigger=0).axes.lines) == lines


@pytest.mark.parametrize("size", [(7.0, 3.0), (4.5, 6.0)])
def test_map_in_axes_of_ones_own_covers_no_label_and_leaves_no_figure(film, size):
    columns = 2 if size[0] > size[1] else 1
    figure, panels = plt.subplots(3 - columns, columns, figsize=size, layout="constrained")
    ax = plots.thickness_map(film, trigger=2, ax=panels[0]).axes
    # an image of fixed aspect is in its place after the second round of the layout
    for _ in range(2):
        figure.draw_without_rendering()

    assert ax.xaxis.label.get_fontsize() == 10  # that of the axes, as all other text
    legend, label = ax.get_legend().get_window_extent(), ax.xaxis.get_tightbbox()
    assert legend.y1 <= label.y0 + 1
    bar = ax.child_axes[0].get_tightbbox()
    whole, other = figure.bbox, panels[1].bbox
    for box in (legend, label, bar):
        assert box.y0 >= whole.y0
        assert box.x1 <= whole.x1
        assert not box.overlaps(other)


def test_means_over_blocks_are_those_of_the_valid_pixels(film):
    """Blocks of 2 by 2 pixels; one has three valid pixels, one has a single one."""
    values = np.arange(64.0 * 80).reshape(64, 80)
    values[0, 0] = values[0, 2] = values[0, 3] = values[1, 2] = np.nan
    means = average_in_blocks(film, values, along_x=40)
    assert means.size == 2
    npt.assert_allclose(means.values[0, 0], (1 + 80 + 81) / 3)
    assert np.isnan(means.values[0, 1])
    npt.assert_allclose(means.values[-1, -1], values[-2:, -2:].mean())
    npt.assert_allclose(means.extent, pixel_edges(film))
