"""Profiles along the sliding direction: the film with its error bars, and the rigid gap."""

import numpy as np
import numpy.testing as npt
from scenes import film as scene

from erlif.show import plots
from erlif.trend import average_across_sliding


def test_profile_is_drawn_with_its_error_bars(film):
    line, band, above, below, gap = plots.sliding_profile(film, trigger=1)
    profile = average_across_sliding(film, trigger=1)
    h = profile.thickness.values
    npt.assert_array_equal(line.get_xdata(), film.x.values)
    npt.assert_array_equal(line.get_ydata(), h)

    at = int(np.nanargmin(h))
    edges = np.concatenate([path.vertices for path in band.get_paths()])
    ends = edges[np.isclose(edges[:, 0], film.x.values[at]), 1]
    npt.assert_allclose(np.ptp(ends), 2 * 1.96 * profile.thickness_std.values[at])
    shared = 1.96 * profile.thickness_std_shared.values
    npt.assert_allclose(above.get_ydata() - h, shared)
    npt.assert_allclose(h - below.get_ydata(), shared)

    # the shared error of the difference to the rigid gap lies about zero
    residual, _, above, below, zero = plots.profile_residual(film, trigger=1)
    npt.assert_allclose(residual.get_ydata(), h - gap.get_ydata(), atol=1e-12)
    npt.assert_allclose(above.get_ydata(), -below.get_ydata())
    npt.assert_array_equal(zero.get_ydata(), 0)


def test_curvature_is_written_beside_that_of_the_rigid_gap(film):
    line, *_, gap = plots.sliding_profile(film, trigger=1)
    curvature, rigid, minimum = line.axes.texts[0].get_text().split("\n")
    distance = scene.CLEARANCE - scene.minimum_film()[1]  # um, of the middles of the circles
    shown = float(rigid.removeprefix("of the rigid gap ").removesuffix(" µm/mm²;"))
    npt.assert_allclose(shown, distance / (33.36 * 33.59), atol=2e-4)
    value, std = (
        float(part) for part in curvature.removeprefix("curvature ").strip(",").split("±")
    )
    assert abs(value - 0.20525) < 4 * std
    number = float(minimum.removeprefix("its minimum ").removesuffix(" µm"))
    npt.assert_allclose(number, gap.get_ydata().min(), atol=0.01)  # between two pixels
