"""Positions, region, patch and pin of an image in the plane of the joint."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.film import run_settings

from erlif.core.errors import ConfigError
from erlif.pipeline.plane import ObjectPlane
from erlif.trend import GapShape, Region

SHAPE = (96, 128)


def plane(*, shape=SHAPE, **tables):
    """An image of 150 um a pixel; tables of run.toml are completed, or left out where None."""
    tables = {"optics": {"pixel_pitch": "150 um"}, "thickness": None} | tables
    return ObjectPlane(run_settings(**tables), shape)


def test_region_is_that_of_the_settings():
    """x from 3.1 to 12.9 mm and y from 1.1 to 10.9 mm, 200 um a pixel."""
    roi = {"roi": {"x": [3.1, 12.9], "y": [1.1, 10.9]}}
    one = plane(shape=(64, 80), optics={"pixel_pitch": "200 um"}, thickness=roi)
    assert one.region == Region(rows=slice(6, 55), columns=slice(16, 65))
    assert one.within == slice(16, 65)


def test_view_is_that_of_the_settings():
    view = plane().view
    assert (view.pin_radius, view.bushing_radius) == (0.03336, 0.03359)
    npt.assert_allclose([view.load_line, view.axial_origin], [63.5 * 0.15, 47.5 * 0.15])
    npt.assert_allclose(plane(prediction={"load_line": "8.1 mm"}).view.load_line, 8.1)


def test_a_pin_in_a_bushing_has_a_line_contact_and_a_disc_any():
    disc = {"kind": "rotation", "radius": "20 mm", "speed": "60 rpm"}
    assert (
        plane().contacts
        == plane(joint=None, oil=None).contacts
        == (GapShape.LINE, GapShape.JOURNAL)
    )
    assert plane(mechanism=disc).contacts == (GapShape.LINE, GapShape.JOURNAL)
    free = plane(mechanism=disc, joint=None, oil=None).contacts
    assert set(free) == set(GapShape) - {GapShape.JOURNAL}


def test_sliding_may_be_along_y():
    turned = plane(optics={"pixel_pitch": "150 um", "x_axis": "axial"})
    assert turned.view.load_line == plane().view.axial_origin
    assert not turned.view.sliding_along_x
    npt.assert_array_equal(turned.along, plane().y)
    spread = turned.spread(np.arange(96.0))
    npt.assert_array_equal(spread, np.tile(np.arange(96.0)[:, None], 128))
    assert turned.grid(3).y.attrs["long_name"] == "y (sliding)"


def test_no_view_without_a_joint_or_of_a_pin_smaller_than_the_image():
    assert plane(joint=None, oil=None).view is None
    assert plane(joint={"pin_radius": "5.9 mm", "bushing_radius": "6 mm"}).view is None


def test_load_line_on_the_other_side_of_the_joint_is_refused():
    """A quarter of a turn of 33.5 mm is 52.6 mm."""
    with pytest.raises(ConfigError, match=r"-33\.5 to 52\.6 mm; \[prediction\] load_line is 60"):
        plane(prediction={"load_line": "6 cm"}).check()


def test_pixels_of_a_patch_are_those_between_its_bounds():
    fine = {"pixel_pitch": "100 um"}
    table = {"region": {"x": (1.0, 3.0), "y": (2.05, 4.0)}, "thickness": "5 um"}
    patch = plane(optics=fine, reference=table).patch
    assert (patch.rows, patch.columns) == (slice(21, 41), slice(10, 31))
    assert plane().patch is None
    table["region"]["x"] = (30.0, 40.0)
    with pytest.raises(ConfigError, match="reference patch of at least 8 x 8"):
        _ = plane(optics=fine, reference=table).patch
