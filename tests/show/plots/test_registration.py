"""Displacement and drift are drawn as the film stores them, in pixels."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes import film as scene

from erlif.io.files import open_film
from erlif.show import plots


def group_of(name):
    @pytest.fixture(name=name)
    def group(film_path):
        with open_film(film_path, group=name) as found:
            return found.load()

    return group


registration, frames = group_of("registration"), group_of("frames")


def test_displacement_is_drawn_less_its_mean(registration):
    slope = 0.01 * (np.arange(scene.COLUMNS) - 39.5)
    for component, shift, sign in (("x", 3.0, "+3.00"), ("y", -2.5, "−2.50")):
        name = f"displacement_{component}"
        registration[name] = registration[name] + shift + slope
        image = plots.displacement_map(registration, component=component)
        npt.assert_allclose(image.get_array(), np.broadcast_to(slope, (64, 80)), atol=1e-6)
        assert image.axes.get_title() == f"mean Δ{component} = {sign} px"


def test_edge_of_the_overlap_is_outlined(registration):
    """Camera 2 does not see the first three columns, so that the edge lies at 2.5."""
    ax = plots.displacement_map(registration, component="x").axes
    (edge,) = ax.collections
    npt.assert_allclose(edge.get_paths()[0].vertices[:, 0], 2.5)
    registration.overlap.values[:] = 1
    registration.poor.values[10:20, 30:50] = 1
    (poor,) = plots.displacement_map(registration, component="x").axes.collections
    assert not np.array_equal(edge.get_edgecolor(), poor.get_edgecolor())
    x, y = poor.get_paths()[0].vertices.T
    npt.assert_allclose([x.min(), x.max(), y.min(), y.max()], [29.5, 49.5, 9.5, 19.5])


def test_drift_is_drawn_by_frame_with_its_rms(frames):
    """A drift of alternating sign has its amplitude as rms."""
    frames.drift_x.values[:] = 0.25 * (-1.0) ** np.arange(scene.TRIGGERS)
    along_x, along_y = plots.drift_of_frames(frames)
    npt.assert_array_equal(along_x.get_xdata(), np.arange(scene.TRIGGERS))
    npt.assert_array_equal(along_x.get_ydata(), frames.drift_x.values)
    npt.assert_array_equal(along_y.get_ydata(), 0)
    assert along_x.get_label() == "along x, rms 0.25 px"
    assert along_y.get_label() == "along y, rms 0.00 px"

    # a frame without a drift is a gap
    frames.drift_x.values[2] = np.nan
    assert np.isnan(plots.drift_of_frames(frames)[0].get_ydata()[2])
    frames.drift_x.values[:] = np.nan
    assert "rms nan" in plots.drift_of_frames(frames)[0].get_label()
