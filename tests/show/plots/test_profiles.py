"""Profiles along the sliding direction: the film with its error bars, and the rigid gap."""

import numpy as np
import numpy.testing as npt
from scenes import film as scene

from erlif.show import plots
from erlif.trend import average_across_sliding


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
