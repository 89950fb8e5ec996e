"""Grids for ParaView, parsed by hand and, where it is installed, read by VTK itself."""

import base64
import struct
import xml.etree.ElementTree as ET
import zlib

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.progress import silent
from erlif.io.conversion.vtk_xml import write_series

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
