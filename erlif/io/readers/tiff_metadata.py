"""Frames, channels and times from the description that OME or ImageJ writes into a TIFF."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import FrameError
from erlif.io.readers.base import MOST_FRAMES, SECONDS


@dataclass(frozen=True)
class Description:
    """Frames, channels and times stated in the description of a TIFF file.

    Attributes
    ----------
    frames : int
        Number of images; 0 where it is that of the directories.
    channels : Sequence[int] | None
        Channel of each image, counted from 1; 0 for an image without one.
    times : Array | None
        Time of each image from the first one. [s]
    whole : bool
        Whether the file itself is known to hold these images: a description may be a copy.
    serial : str
        Serial number of the camera; empty where there is none.
    """

    frames: int = 0
    channels: Sequence[int] | None = None
    times: Array | None = None
    whole: bool = False
    serial: str = ""


def read_description(text: bytes, *, name: str, pages: int) -> Description:
    """Interpret the description of the first image of a file.

    Parameters
    ----------
    text : bytes
        Tag ImageDescription.
    name : str
        Name of the file: an OME file may describe other files as well.
    pages : int
        Number of directories in the file.

    Returns
    -------
    Description
        An empty one where the text is from none of OME, ImageJ and tifffile.

    Raises
    ------
    FrameError
        With the bare reason, if the description claims more images than any file holds.

    Examples
    --------
    >>> text = b"ImageJ=1.53t\\nimages=6\\nchannels=2\\nframes=3\\nfinterval=0.01\\n"
    >>> found = read_description(text, name="a.tif", pages=1)
    >>> found.frames, found.channels, found.times
    (6, [1, 2, 1, 2, 1, 2], array([0.  , 0.  , 0.01, 0.01, 0.02, 0.02]))
    """
    if text.startswith(b"{") and b'"truncated": true' in text:
        return _read_shape(text)
    if text.startswith(b"ImageJ="):
        return _read_imagej(text.decode("utf-8", "replace"))
    if b"<OME" in text[:4096] and pages:
        return _read_ome(text, name, pages)
    return Description()


def _read_shape(text: bytes) -> Description:
    """By tifffile, of images behind one directory; the order of its keys differs by version."""
    try:
        shape = json.loads(text)["shape"]
    except (ValueError, KeyError, RecursionError):
        return Description()
    if not isinstance(shape, list) or not all(type(size) is int and size > 0 for size in shape):
        return Description()
    images = math.prod(shape[:-2])
    if images > MOST_FRAMES:
        raise FrameError("the file is damaged: its description claims more images than fit in it")
    return Description(images, whole=True)


def _read_imagej(text: str) -> Description:
    entries = dict(line.split("=", 1) for line in text.splitlines() if "=" in line)
    sizes = {key: _whole(entries.get(key)) for key in ("images", "channels", "slices", "frames")}
    images = sizes["images"]
    if images > MOST_FRAMES:
        raise FrameError(f"the file is damaged: its description claims {images} images")

    # channels follow each other fastest, then slices, then frames
    channels = sizes["channels"] if images % sizes["channels"] == 0 else 1
    steps = channels * sizes["slices"]
    unit = SECONDS.get(entries.get("tunit", "s").strip(), 0.0)
    interval = _number(entries.get("finterval")) * unit
    times = None
    if interval > 0 and sizes["frames"] > 1 and steps * sizes["frames"] == images:
        times = interval * (np.arange(images, dtype=np.float64) // steps)
    channel = [k % channels + 1 for k in range(images)] if channels > 1 else [1] * images
    return Description(images, channel, times)


def _read_ome(text: bytes, name: str, pages: int) -> Description:
    # entities could make a short text endless; OME has none
    if b"<!DOCTYPE" in text or b"<!ENTITY" in text:
        return Description()
    try:
        root = ElementTree.fromstring(text.rstrip(b"\0"))
    except (ElementTree.ParseError, ValueError, LookupError):
        return Description()

    # the elements have a namespace that differs between versions of OME
    channels, stamps = [0] * pages, np.full(pages, np.nan)
    serials = []
    for element in root.iter():
        if _plain(element.tag) == "Pixels":
            _read_pixels(element, name, channels, stamps)
        elif _plain(element.tag) == "Detector":
            serials.append(element.get("SerialNumber", ""))
    if not any(channels):
        return Description()
    times = stamps - stamps[0] if np.isfinite(stamps).all() else None
    return Description(0, channels, times, serial=" ".join(serials).strip())


def _read_pixels(
    pixels: ElementTree.Element, name: str, channels: list[int], stamps: Array
) -> None:
    """Enter channel and time of the directories that one image of an OME file describes."""
    order = pixels.get("DimensionOrder", "XYZCT")[2:]
    sizes = {axis: _whole(pixels.get(f"Size{axis}")) for axis in "ZCT"}
    if sorted(order) != ["C", "T", "Z"]:
        return
    delays = {
        tuple(element.get(f"The{axis}", "0") for axis in "ZCT"): _number(
            element.get("DeltaT"), np.nan
        )
        * SECONDS.get(element.get("DeltaTUnit", "s"), np.nan)
        for element in pixels
        if _plain(element.tag) == "Plane"
    }

    blocks = [element for element in pixels if _plain(element.tag) == "TiffData"]
    for block in blocks:
        other = [part.get("FileName") for part in block if _plain(part.tag) == "UUID"]
        if other and other[0] not in (None, name):
            continue
        first = _whole(block.get("IFD"), 0)
        # a block without a count holds all planes where it is the only one, else a single plane
        rest = len(channels) if len(blocks) == 1 and block.get("IFD") is None else 1
        place = {axis: _whole(block.get(f"First{axis}"), 0) for axis in "ZCT"}
        start = place[order[0]] + sizes[order[0]] * (
            place[order[1]] + sizes[order[1]] * place[order[2]]
        )
        for n in range(min(_whole(block.get("PlaneCount"), rest), len(channels) - first)):
            plane = _divide(start + n, [sizes[axis] for axis in order])
            by_axis = dict(zip(order, plane, strict=True))
            channels[first + n] = by_axis["C"] + 1
            stamps[first + n] = delays.get(tuple(str(by_axis[axis]) for axis in "ZCT"), np.nan)


def _divide(number: int, sizes: Sequence[int]) -> list[int]:
    """Place along each axis of an array, the first axis fastest."""
    places = []
    for size in sizes:
        number, place = divmod(number, size)
        places.append(place)
    return places


def _plain(tag: object) -> str:
    """Name of an element without its namespace; empty for a comment."""
    return tag.rpartition("}")[2] if isinstance(tag, str) else ""


def _whole(text: str | None, default: int = 1) -> int:
    """A whole number from `default` up."""
    match = re.fullmatch(r"\s*(\d{1,12})\s*", text or "")
    return max(int(match[1]), default) if match else default


def _number(text: str | None, default: float = 0.0) -> float:
    try:
        return float(text) if text is not None else default
    except ValueError:
        return default
