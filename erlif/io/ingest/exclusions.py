"""Parts of the image of camera 1 that count nowhere: polygons and mask images of the settings."""

from __future__ import annotations

import io
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from erlif.core.arrays import Array, Mask
from erlif.core.bounded import read_bounded
from erlif.core.errors import ConfigError
from erlif.core.notes import Note, remark, warn
from erlif.io.readers.base import describe_shape
from erlif.io.settings import FixtureSettings, RunSettings

# Size of a mask image that is read: that of any camera, one byte a pixel. [byte]
_LARGEST_FILE = 2**28

# Share of the image from which a mask looks like one of what is to be kept. [1]
_MOST = 0.5


def exclude_pixels(
    directory: Path, settings: RunSettings | FixtureSettings, shape: tuple[int, int]
) -> Mask | None:
    """Find the pixels of camera 1 that the settings exclude.

    Parameters
    ----------
    directory : Path
        The run or fixture directory, which holds the mask images.
    settings : RunSettings or FixtureSettings
        ``exclude`` in [thickness] names the images, and has the corners of the polygons. [mm]
    shape : (rows, columns)
        Shape of a frame. [px]

    Returns
    -------
    array of bool, (y, x), or None
        True for excluded pixels, those whose centre lies in a polygon or that are not black in an
        image; None where the settings exclude nothing.

    Raises
    ------
    ConfigError
        If a mask image cannot be used, if an image or a polygon covers no pixel, or if nothing of
        the image is left.

    Examples
    --------
    >>> from erlif.io.settings import read_fixture_settings
    >>> fixture = Path("calibration/wedge")
    >>> exclude_pixels(fixture, read_fixture_settings(fixture), (208, 256)) is None
    True
    """
    if not settings.thickness.exclude:
        return None
    pitch = 1e3 * settings.optics.pixel_pitch  # mm
    excluded = fill_parts(directory, settings.thickness.exclude, shape, pitch=pitch)
    if excluded.all():
        raise ConfigError(
            "Expected pixels that are left; exclude of [thickness] covers the whole image. In a "
            "mask image white is excluded and black is kept: invert it, or correct the polygons."
        )
    return excluded


def fill_parts(
    directory: Path, parts: Iterable[Any], shape: tuple[int, int], *, pitch: float
) -> Mask:
    """Pixels of mask images and of polygons.

    Parameters
    ----------
    directory : Path
    parts : iterable of str or sequence
        Names of images, and corners of polygons. [mm]
    shape : (rows, columns)
        [px]
    pitch : float
        Size of a pixel. [mm]

    Returns
    -------
    array of bool, (y, x)

    Raises
    ------
    ConfigError
        As `exclude_pixels`.
    """
    excluded = np.zeros(shape, bool)
    for part in parts:
        if isinstance(part, str):
            excluded |= _read_mask(directory / part, shape)
        else:
            excluded |= _fill_polygon(np.array(part), pitch, shape)
    return excluded


def exclusion_notes(excluded: Mask | None) -> list[Note]:
    """State how much of the image is excluded; a warning where it is more than half.

    Parameters
    ----------
    excluded : array of bool, (y, x), or None
        As `exclude_pixels` returns it.

    Returns
    -------
    list of Note
        Empty where nothing is excluded.

    Examples
    --------
    >>> print(*exclusion_notes(np.arange(64).reshape(8, 8) < 16))
    excluded: 16 pixels, 25.0 % of the image
    """
    if excluded is None:
        return []
    share = float(excluded.mean())
    text = f"{int(excluded.sum())} pixels, {100 * share:.1f} % of the image"
    if share <= _MOST:
        return [remark("excluded", text)]
    return [warn("excluded", f"{text}; white of a mask image is excluded: invert it if black is")]


def _fill_polygon(corners: Array, pitch: float, shape: tuple[int, int]) -> Mask:
    """Pixels whose centres lie in a polygon with corners (x, y). [mm]"""
    from skimage.draw import polygon2mask

    inside: Mask = polygon2mask(shape, corners[:, ::-1] / pitch)  # type: ignore[no-untyped-call]
    if not inside.any():
        (left, top), (right, bottom) = corners.min(axis=0), corners.max(axis=0)
        height, width = (np.array(shape) - 1) * pitch
        raise ConfigError(
            f"Expected a polygon over pixels of the image, x 0 to {width:.2f} mm and y 0 to "
            f"{height:.2f} mm, in exclude of [thickness]; that of x {left:g} to {right:g} mm and "
            f"y {top:g} to {bottom:g} mm covers none. Correct its corners [x, y], or take it out."
        )
    return inside


def _read_mask(path: Path, shape: tuple[int, int]) -> Mask:
    """Pixels of a mask image that are not black."""
    from PIL import Image

    try:
        content = read_bounded(path, largest=_LARGEST_FILE)
        with Image.open(io.BytesIO(content), formats=("PNG", "TIFF")) as picture:
            found = picture.height, picture.width
            # the size is that of the header: a wrong one is not decoded
            inside = np.asarray(picture.convert("L")) > 0 if found == shape else None
    except Exception as error:  # damaged bytes raise errors of many classes
        reason = getattr(error, "strerror", None) or "it is damaged, or of another format"
        raise ConfigError(
            f"Expected a mask image, PNG or TIFF, in {path}; {reason}. Save it there, or correct "
            "exclude of [thickness]."
        ) from error
    if inside is None:
        raise ConfigError(
            f"Expected a mask of {describe_shape(shape)} pixels, the size of a frame of camera 1, "
            f"in {path.name}; it has {describe_shape(found)}. Draw it on a frame of this recording."
        )
    if not inside.any():
        raise ConfigError(
            f"Expected white pixels in {path.name}, those that are excluded; it is black. Draw "
            "them, or take the mask out of exclude in [thickness]."
        )
    return inside
