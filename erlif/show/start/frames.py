"""Frames, darks and flats of a directory by its settings as they stand, gaps included."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple, get_args

from erlif.core.arrays import Counts
from erlif.core.errors import ErlifError, FrameError
from erlif.core.units import parse_quantity
from erlif.io.ingest.containment import refuse_outside
from erlif.io.ingest.images import CameraFiles, find_pages, name_page, read_page
from erlif.io.ingest.selection import Purpose, Selection, select_counts
from erlif.io.settings import CameraSettings
from erlif.registration.settings import ORIENTATIONS, orient

# What the images of a camera are for, in the order of the page.
PURPOSES: tuple[Purpose, ...] = get_args(Purpose)

_KEPT = 4  # images that stay in memory: those of both cameras, and the ones before


class Photograph(NamedTuple):
    """One image of a camera.

    Attributes
    ----------
    counts : Counts
        (y, x), of camera 2 turned as the settings have it. [DN]
    full_scale : int
        [DN]
    title : str
        Its number and its file.
    """

    counts: Counts
    full_scale: int
    title: str


class FrameSource:
    """The images of one directory; headers are read once.

    Parameters
    ----------
    directory : Path

    Examples
    --------
    >>> source = FrameSource(Path("calibration/wedge"))
    >>> values = {"camera1": {"files": "camera1/*.tif", "band": "?? nm"}}
    >>> source.read(values, 1, "frames", 2).title
    'image 3 of 8, camera1/frame_0002.tif'
    """

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self._find = lru_cache(64)(self._read_headers)
        self._read = lru_cache(_KEPT)(read_page)

    def count(self, values: Mapping[str, Any]) -> dict[str, list[int]]:
        """Number of images of both cameras for each purpose that has any.

        Parameters
        ----------
        values : mapping
            Settings as TOML has them, without values that cannot be used.

        Returns
        -------
        dict of str to list of int

        Raises
        ------
        ErlifError
            If the frames cannot be found. Darks and flats that are missing have no images.
        """
        found = {}
        for purpose in PURPOSES:
            counts = []
            for camera in (1, 2):
                try:
                    counts.append(len(self._files(values, camera, purpose).pages))
                except ErlifError:
                    if purpose == "frames":
                        raise
                    counts.append(0)
            found[purpose] = counts
        return {purpose: counts for purpose, counts in found.items() if any(counts)}

    def read(self, values: Mapping[str, Any], camera: int, purpose: str, number: int) -> Photograph:
        """Read an image of camera 1 or 2.

        Parameters
        ----------
        values : mapping
            As for `count`.
        camera, number : int
            Camera from 1, image from 0.
        purpose : str
            "frames", "dark", "flat" or "background".

        Returns
        -------
        Photograph

        Raises
        ------
        ErlifError
            If there is no such image, or it cannot be read.
        """
        files = self._files(values, camera, purpose)
        if not 0 <= number < len(files.pages):
            raise FrameError(
                f"Expected an image from 1 to {len(files.pages)} of camera {camera}; got "
                f"{number + 1}. Choose another one."
            )
        page = files.pages[number]
        name = name_page(page, self.directory, camera)
        if number in files.faults:
            raise FrameError(f"Expected an image in {name}; {files.faults[number]}")

        counts = self._read(page, self.directory, files.kinds[number].shape)
        turn = values.get("registration", {}).get("orientation")
        if camera == 2 and turn in ORIENTATIONS:
            counts = orient(counts, turn)
        title = f"image {number + 1} of {len(files.pages)}, {name}"
        return Photograph(counts, _camera(values, camera).full_scale, title)

    def _files(self, values: Mapping[str, Any], camera: int, purpose: str) -> CameraFiles:
        settings = _camera(values, camera)
        patterns = {one: getattr(settings, one) for one in PURPOSES[1:]}
        patterns["frames"] = settings.files
        if purpose not in PURPOSES or patterns[purpose] is None:
            raise FrameError(
                f"Expected the name of the {purpose} images of camera {camera} in the settings; "
                "there is none. Give it there."
            )
        what = f"camera{camera} {purpose}"
        return self._find(patterns[purpose], what, select_counts(settings, purpose))

    def _read_headers(self, pattern: str, what: str, selection: Selection) -> CameraFiles:
        refuse_outside(self.directory, [pattern])
        return find_pages(self.directory, pattern, what, selection)


def _camera(values: Mapping[str, Any], camera: int) -> CameraSettings:
    """Settings of a camera of which some are not known yet."""
    return CameraSettings.model_construct(**{"files": None, **values.get(f"camera{camera}", {})})


def pitch_of(values: Mapping[str, Any]) -> float | None:
    """Size of a pixel [mm]; None where it is a gap.

    Examples
    --------
    >>> pitch_of({"optics": {"pixel_pitch": "75 um"}}), pitch_of({})
    (0.075, None)
    """
    text = values.get("optics", {}).get("pixel_pitch")
    return None if text is None else float(parse_quantity(text, "mm"))
