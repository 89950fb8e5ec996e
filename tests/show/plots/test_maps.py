"""Maps: what is drawn is the film, at its place, with its flags."""

import matplotlib.pyplot as plt
import numpy as np
import numpy.testing as npt
import pytest
from scenes import film as scene

from erlif.show import plots
from erlif.show.plots.maps import pixel_edges


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


def test_sheet_of_a_cycle_that_begins_within_a_stroke_starts_with_the_stroke(film):
    """The scene begins at the start of the outward stroke; here it begins one trigger later."""
    names = [ax.get_title() for ax in plots.map_sheet_figure(film).axes if ax.images]
    later = film.isel(trigger=np.roll(np.arange(scene.TRIGGERS), -1))
    figure = plots.map_sheet_figure(later)
    assert [ax.get_title() for ax in figure.axes if ax.images] == names


def test_large_maps_of_a_sheet_are_thinned_to_what_print_resolves(film):
    """Every second pixel of 480 columns; the place of the image stays that of the film."""
    wide = film.isel(x=np.resize(np.arange(scene.COLUMNS), 480), y=slice(0, 6))
    wide = wide.assign_coords(x=scene.PITCH * np.arange(480))
    image = plots.map_sheet_figure(wide).axes[0].images[0]
    assert image.get_array().shape == (3, 240)
    npt.assert_allclose(image.get_extent(), pixel_edges(wide))


@pytest.mark.parametrize(
    ("size", "layout"), [((7.0, 3.0), None), ((4.5, 6.0), None), ((7.0, 3.0), "constrained")]
)
def test_map_in_axes_of_ones_own_covers_no_label_and_leaves_no_figure(film, size, layout):
    columns = 2 if size[0] > size[1] else 1
    figure, panels = plt.subplots(3 - columns, columns, figsize=size, layout=layout)
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
