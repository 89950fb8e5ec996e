"""The sheet of a cycle: its order, and the resolution of its maps."""

import numpy as np
import numpy.testing as npt
from scenes import film as scene

from erlif.show import plots
from erlif.show.plots.maps import pixel_edges
from erlif.show.plots.sheet import best_columns, depart_from_gap


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


def test_less_the_gap_a_sheet_shows_what_departs_from_it(changed):
    """A groove of 1 um along sliding, three rows wide, in the gap of circles."""
    plain = depart_from_gap(changed, 1).values
    changed.thickness.values[:, 30:33, :] += np.float32(1.0)
    grooved = depart_from_gap(changed, 1)
    assert grooved.size == 3
    rise = np.nanmean((grooved.values - plain)[:21], axis=1)  # of whole blocks
    assert rise.argmax() == 10
    npt.assert_allclose(rise[10] - (rise[9] + rise[11]) / 2, 1.0, atol=0.02)

    first = plots.map_sheet_figure(changed, less_gap=True).axes[0]
    low, high = first.images[0].get_clim()
    assert low == -high
    assert high < 1.0
    npt.assert_allclose(first.get_xlim(), pixel_edges(changed)[:2])


def test_marks_of_the_wall_stand_out_in_the_mean_over_the_triggers(changed):
    """A mark of 0.05 um at every trigger, in noise of 0.05 um a pixel."""
    changed.thickness.values[:, 30:33, :] += np.float32(0.05)
    panels = [ax for ax in plots.map_sheet_figure(changed, less_gap=True).axes if ax.images]
    *_, mean = (ax.images[0].get_array().filled(np.nan) for ax in panels)
    assert panels[-1].get_title() == f"{scene.TRIGGERS} triggers"
    assert np.nanmean(mean[:21], axis=1).argmax() == 10


def test_rows_are_of_equal_length_where_they_can_be_and_angles_have_the_digits_they_need(film):
    assert [best_columns([count]) for count in (12, 14, 16, 18, 60)] == [6, 7, 8, 9, 10]
    for step, titles in ((30.0, ["11.1°", "41.1°"]), (30.25, ["11.10°", "41.35°"])):
        turned = film.assign_coords(crank_angle=("trigger", 11.1 + step * np.arange(6)))
        shown = [ax.get_title() for ax in plots.map_sheet_figure(turned).axes]
        assert set(titles) <= set(shown)


def test_sheet_less_the_gap_states_what_is_subtracted(film):
    assert (
        "film less the quadratic surface"
        in plots.map_sheet_figure(film, less_gap=True).get_supxlabel()
    )
    assert "quadratic" not in plots.map_sheet_figure(film).get_supxlabel()
