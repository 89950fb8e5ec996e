"""Where the pixels lie in space."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ConfigError
from erlif.io.conversion.surface import find_surface

RADIUS = 33.36  # mm, of the pin of the example


def with_settings(film, *changes):
    text = film.attrs["settings"]
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return film.assign_attrs(settings=text)


def test_every_pixel_is_one_radius_from_the_axis_of_the_pin(film):
    points = find_surface(film)
    npt.assert_allclose(np.hypot(points[..., 0], points[..., 2]), RADIUS, rtol=1e-12)
    npt.assert_allclose(points[:, 5, 1], -film.y.values)


def test_arcs_on_the_surface_are_the_positions_along_sliding(film):
    points = find_surface(film)[0]
    chord = np.linalg.norm(np.diff(points, axis=0), axis=1)
    arc = 2 * RADIUS * np.arcsin(chord / (2 * RADIUS))
    npt.assert_allclose(arc, 0.25, rtol=1e-9)
    assert (np.diff(points[:, 0]) > 0).all()  # to the right, as in the camera


def test_the_load_line_is_at_the_top(film):
    middle = find_surface(film)[0, :, 2]
    assert middle[31] == pytest.approx(middle[32])  # 64 columns: between the two in the middle
    moved = with_settings(film, ("[prediction]", '[prediction]\nload_line = "5 mm"'))
    npt.assert_allclose(find_surface(moved)[0, 20], [0, 0, RADIUS], atol=1e-9)


def test_the_load_line_of_the_positions_is_at_the_top_where_none_is_given(film):
    found = film.copy()
    found["pin_displacement"] = found.pin_displacement.assign_attrs(load_line=5.0)
    npt.assert_allclose(find_surface(found)[0, 20], [0, 0, RADIUS], atol=1e-9)


def test_an_image_with_the_axis_along_x_is_wound_along_y(film):
    turned = with_settings(film, ('x_axis = "sliding"', 'x_axis = "axial"'))
    points = find_surface(turned)
    npt.assert_allclose(np.hypot(points[..., 1], points[..., 2]), RADIUS, rtol=1e-12)
    npt.assert_allclose(points[3, :, 0], film.x.values)
    assert (np.diff(points[:, 0, 1]) < 0).all()  # y points down


def test_the_load_line_of_a_turned_or_cropped_image_is_its_place_in_the_camera(film):
    turned = with_settings(
        film,
        ('x_axis = "sliding"', 'x_axis = "axial"'),
        ("[prediction]", '[prediction]\nload_line = "1 mm"'),
    )
    npt.assert_allclose(find_surface(turned)[4, 0, 1:], [0, RADIUS], atol=1e-9)  # 0.25 mm rows
    moved = with_settings(film, ("[prediction]", '[prediction]\nload_line = "5 mm"'))
    cropped = find_surface(moved.isel(x=slice(8, None)))
    npt.assert_allclose(cropped[0, 12], [0, 0, RADIUS], atol=1e-9)


def test_a_disc_and_a_slider_are_flat(film):
    text = film.attrs["settings"]
    start, end = text.index("[joint]"), text.index("[oil]")
    flat = find_surface(film.assign_attrs(settings=text[:start] + text[end:]))
    assert not flat[..., 2].any()
    npt.assert_allclose(flat[7, 9], [film.x[9], -film.y[7], 0.0])


def test_an_image_longer_than_the_circumference_is_refused(film):
    thin = with_settings(film, ("33.36 mm", "2 mm"))
    with pytest.raises(ConfigError, match=r"circumference of the pin, 12\.6 mm; it is 15\.8 mm"):
        find_surface(thin)
