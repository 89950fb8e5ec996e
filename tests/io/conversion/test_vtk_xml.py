"""Grids for ParaView, parsed by hand and, where it is installed, read by VTK itself."""

import base64
import struct
import xml.etree.ElementTree as ET
import zlib

import numpy as np
import numpy.testing as npt
import pytest
from scenes.film import with_settings

from erlif.core.errors import ConfigError
from erlif.core.progress import silent
from erlif.io.conversion.vtk_xml import find_surface, write_series

TYPES = {"Float32": np.float32, "Float64": np.float64, "UInt16": np.uint16}


@pytest.fixture(scope="module")
def series(film, tmp_path_factory):
    folder = tmp_path_factory.mktemp("vtk") / "film_vtk"
    write_series(film, folder, name="film", triggers=[0, 2, 5], progress=silent)
    return folder


def values(array: ET.Element) -> np.ndarray:
    """An array after the description of the format: one header of four numbers, one block."""
    text = (array.text or "").strip()
    header = base64.b64decode(text[:44])  # 32 bytes
    blocks, size, last, packed = struct.unpack("<QQQQ", header)
    assert (blocks, last) == (1, 0)
    content = base64.b64decode(text[44:])
    assert len(content) == packed
    content = zlib.decompress(content)
    assert len(content) == size
    return np.frombuffer(content, TYPES[array.attrib["type"]])


def test_points_of_the_file_are_one_radius_from_the_axis(film, series):
    root = ET.parse(series / "film_002.vts").getroot()
    assert root.find("StructuredGrid").attrib["WholeExtent"] == "0 63 0 23 0 0"
    points = values(root.find(".//Points/DataArray")).reshape(24, 64, 3)
    npt.assert_allclose(np.hypot(points[..., 0], points[..., 2]), 33.36, rtol=1e-6)
    npt.assert_allclose(points[:, 0, 1], -film.y.values, rtol=1e-6)

    found = {each.attrib["Name"]: values(each) for each in root.findall(".//PointData/DataArray")}
    npt.assert_array_equal(found["thickness [um]"], film.thickness.values[2].ravel())
    npt.assert_array_equal(found["flags"], film.flags.values[2].ravel())
    numbers = {each.attrib["Name"]: values(each) for each in root.findall(".//FieldData/DataArray")}
    assert numbers["film_min [um]"].tolist() == [float(film.film_min[2])]


def steps_of(folder):
    return ET.parse(folder / "film.pvd").getroot().findall(".//DataSet")


def test_the_collection_lists_each_trigger_with_its_time(film, series, tmp_path):
    """Without logged times the crank turns at 114 rpm, from 250 to 330 and to 150 degrees."""
    steps = steps_of(series)
    assert [step.attrib["file"] for step in steps] == [f"film_00{k}.vts" for k in (0, 2, 5)]
    times = [float(step.attrib["timestep"]) for step in steps]
    npt.assert_allclose(times, np.array([0, 80, 260]) / 360 * 60 / 114, rtol=1e-6)

    timed = film.assign(time=("trigger", 0.03 * np.arange(6)))
    write_series(timed, tmp_path / "film", name="film", triggers=[1, 4], progress=silent)
    assert [step.attrib["timestep"] for step in steps_of(tmp_path / "film")] == ["0.03", "0.12"]
    assert {path.name for path in series.iterdir()} == {
        "film.pvd",
        *(step.attrib["file"] for step in steps),
    }


def test_any_name_of_a_column_stays_text(film, tmp_path):
    named = film.assign({'a < b & "c" µ': ("trigger", np.arange(6.0))})
    write_series(named, tmp_path / "film", name="film", triggers=[1], progress=silent)
    root = ET.parse(tmp_path / "film" / "film_001.vts").getroot()
    names = [each.attrib["Name"] for each in root.findall(".//FieldData/DataArray")]
    assert 'a < b & "c" µ' in names


RADIUS = 33.36  # mm, of the pin of the example


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
