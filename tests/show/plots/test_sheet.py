"""The sheet of a cycle: its order, and the resolution of its maps."""

import numpy as np
import numpy.testing as npt
from scenes import film as scene

from erlif.show import plots
from erlif.show.plots.maps import pixel_edges


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
