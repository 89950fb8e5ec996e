"""Descriptions of OME and ImageJ, as tifffile writes them and after their specifications."""

import numpy as np
import pytest

from erlif.core.errors import FrameError
from erlif.io.readers.tiff_metadata import Description, read_description


def read(text: bytes, pages: int, name: str = "a.tif") -> Description:
    return read_description(text, name=name, pages=pages)


@pytest.mark.parametrize(
    ("lines", "times"),
    [
        ("images=3\nframes=3\nfinterval=20\ntunit=ms", [0, 0.02, 0.04]),
        ("images=3\nframes=3\nfinterval=20\ntunit=moon", None),
        ("images=3\nslices=3\nfinterval=20", None),
        ("images=3\nframes=3", None),
        ("images=3\nframes=2\nfinterval=1", None),
    ],
)
def test_times_of_imagej_need_frames_and_a_unit(lines, times):
    found = read(f"ImageJ=1.53t\n{lines}\n".encode(), 1).times
    assert (found is None) == (times is None)
    if times is not None:
        np.testing.assert_allclose(found, times)


def test_a_billion_images_are_refused():
    with pytest.raises(FrameError, match="claims 1000000000 images"):
        read(b"ImageJ=1\nimages=1000000000\n", 1)


OME = """<?xml version="1.0"?><OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06">
<Image ID="Image:0"><Pixels DimensionOrder="XYCZT" SizeC="2" SizeZ="1" SizeT="2">
{blocks}
{planes}
</Pixels></Image></OME>"""


def test_blocks_of_ome_map_directories_to_planes():
    """The first directory is the second channel of the last frame; other files do not count."""
    blocks = """<TiffData IFD="0" FirstC="1" FirstT="1"/><TiffData IFD="1" FirstC="0" FirstT="0"/>
    <TiffData IFD="2" FirstC="1" PlaneCount="2"><UUID FileName="a.tif">u</UUID></TiffData>
    <TiffData IFD="0" FirstC="0" FirstT="1"><UUID FileName="b.tif">u</UUID></TiffData>"""
    planes = """<Plane TheC="0" TheZ="0" TheT="0" DeltaT="10" DeltaTUnit="ms"/>
    <Plane TheC="1" TheZ="0" TheT="0" DeltaT="20" DeltaTUnit="ms"/>
    <Plane TheC="0" TheZ="0" TheT="1" DeltaT="30" DeltaTUnit="ms"/>
    <Plane TheC="1" TheZ="0" TheT="1" DeltaT="5" DeltaTUnit="ms"/>"""
    found = read(OME.format(blocks=blocks, planes=planes).encode(), 4)
    assert found.channels == [2, 1, 2, 1]
    np.testing.assert_allclose(found.times, [0, 0.005, 0.015, 0.025])


def test_serial_numbers_of_ome_are_those_of_its_detectors():
    text = OME.format(blocks="<TiffData/>", planes="")
    instrument = '<Instrument ID="I:0"><Detector ID="D:0" SerialNumber="X-17"/></Instrument>'
    assert read(text.replace("<Image ", f"{instrument}<Image ", 1).encode(), 4).serial == "X-17"
    assert not read(text.encode(), 4).serial


def test_a_single_block_without_numbers_holds_all_planes():
    text = OME.format(blocks="<TiffData/>", planes="").encode()
    assert read(text, 4).channels == [1, 2, 1, 2]


@pytest.mark.parametrize(
    "text",
    [
        b"",
        b"exposure 20 us",
        b"<OME",
        b"<?xml version='1.0'?><OME/>",
        OME.format(blocks="", planes="").encode(),
        OME.format(blocks="<TiffData/>", planes="").replace("XYCZT", "XYC").encode(),
        b"<!DOCTYPE OME [<!ENTITY a 'b'>]>" + OME.format(blocks="<TiffData/>", planes="").encode(),
    ],
)
def test_other_descriptions_are_ignored(text):
    assert read(text, 4) == Description()


def test_a_block_that_claims_a_billion_planes_fills_the_directories_of_the_file():
    text = OME.format(blocks='<TiffData IFD="1" PlaneCount="1000000000"/>', planes="")
    assert read(text.encode(), 4).channels == [0, 1, 2, 1]
