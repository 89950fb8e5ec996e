"""Profiles along the sliding direction: the film with its error bars, and the rigid gap."""

import numpy as np
import numpy.testing as npt
from scenes import film as scene

from erlif.show import plots
from erlif.trend import average_across_sliding, cut_through_minimum


def ends_of(band, place):
    """Middle and half width of a band at a place."""
    edges = np.concatenate([path.vertices for path in band.get_paths()])
    ends = edges[np.isclose(edges[:, 0], place), 1]
    return (ends.min() + ends.max()) / 2, np.ptp(ends) / 2


def test_profile_is_drawn_with_its_error_bars(film):
    line, band, common, gap = plots.sliding_profile(film, trigger=1)
    profile = average_across_sliding(film, trigger=1)
    h = profile.thickness.values
    npt.assert_array_equal(line.get_xdata(), film.x.values)
    npt.assert_array_equal(line.get_ydata(), h)

    at = int(np.nanargmin(h))
    place, shared = film.x.values[at], profile.thickness_std_shared.values[at]
    middle, half = ends_of(band, place)
    npt.assert_allclose([middle, half], [h[at], profile.thickness_std.values[at]])
    npt.assert_allclose(ends_of(common, place), [h[at], shared])

    # the shared error of the difference to the rigid gap lies about zero
    residual, _, common, zero = plots.profile_residual(film, trigger=1)
    npt.assert_allclose(residual.get_ydata(), h - gap.get_ydata(), atol=1e-12)
    npt.assert_allclose(ends_of(common, place), [0.0, shared], atol=1e-12)
    npt.assert_array_equal(zero.get_ydata(), 0)


def test_curvature_is_written_beside_that_of_the_rigid_gap(film):
    line, *_, gap = plots.sliding_profile(film, trigger=1)
    curvature = line.get_label().removeprefix("measured, curvature ").removesuffix(" µm/mm²")
    rigid, minimum = gap.get_label().removeprefix("rigid gap, ").split(", ")
    distance = scene.CLEARANCE - scene.minimum_film()[1]  # um, of the middles of the circles
    shown = float(rigid.removesuffix(" µm/mm²"))
    npt.assert_allclose(shown, distance / (33.36 * 33.59), atol=2e-4)
    value, std = (float(part) for part in curvature.split("±"))
    assert abs(value - 0.20525) < 4 * std
    number = float(minimum.removeprefix("minimum ").removesuffix(" µm"))
    npt.assert_allclose(number, gap.get_ydata().min(), atol=0.01)  # between two pixels


def test_profile_of_a_point_contact_goes_through_its_minimum_which_is_marked(film):
    """The minimum lies 2 mm from the middle, in the fifth row from above of 48."""
    triggers = scene.TRIGGERS
    marked = film.assign(
        film_min=("trigger", np.full(triggers, 4.0)),
        film_min_std=("trigger", np.full(triggers, 0.25)),
        film_min_x=("trigger", np.full(triggers, 30.5)),
        film_min_y=("trigger", np.full(triggers, 24.0)),
    ).assign_attrs(contact="point")
    line, _, _, point, *_ = plots.sliding_profile(marked, trigger=1)
    npt.assert_array_equal(line.get_ydata(), cut_through_minimum(marked, trigger=1).thickness)
    npt.assert_allclose(point.get_xydata(), [[30.5 * scene.PITCH, 4.0]])
    texts = [text.get_text() for text in line.axes.get_legend().get_texts()]
    assert "film_min 4.00 ± 0.25 µm" in texts
    assert line.axes.get_ylim()[0] < 3.75

    # of a line contact the mean over the region, with the same mark
    line, _, _, point, *_ = plots.sliding_profile(marked.assign_attrs(contact="line"), trigger=1)
    npt.assert_array_equal(line.get_ydata(), average_across_sliding(film, trigger=1).thickness)
    npt.assert_allclose(point.get_xydata()[:, 1], [4.0])


def test_bands_lie_within_the_axis_and_only_visible_ones_are_named(film):
    for half, named in ((1.5, True), (1e-4, False)):
        wide = film.assign(thickness_std_shared=0 * film.thickness_std_shared + half)
        artists = plots.sliding_profile(wide, trigger=1)
        low, high = artists[0].axes.get_ylim()
        edges = np.concatenate([path.vertices[:, 1] for path in artists[2].get_paths()])
        assert low < edges.min()
        assert edges.max() < high
        texts = [text.get_text() for text in artists[0].axes.get_legend().get_texts()]
        assert ("shared, 1 s.d." in texts) is named
        assert (artists[2].get_zorder() < artists[1].get_zorder()) is named  # the wider one behind
