"""Export of the displayed data to other programs: CSV and TIFF."""

from __future__ import annotations

import io

import numpy as np

from erlif.core.arrays import Array, FlagImage, Image
from erlif.io.conversion import table_csv


def map_tiff(
    values: Image, flags: FlagImage, *, pitch: tuple[float, float], title: str, unit: str
) -> bytes:
    """Write a map as a TIFF of single precision that ImageJ opens with its scale.

    Parameters
    ----------
    values : array, (y, x)
        A map.
    flags : array, (y, x)
        Its flags; flagged pixels become NaN.
    pitch : tuple of float
        Distance of columns, and of rows. [mm]
    title : str
        What it shows.
    unit : str
        Unit of the values.

    Returns
    -------
    bytes
        Content of the file.

    Examples
    --------
    >>> import tifffile
    >>> flags = np.array([[0, 1], [0, 0]], np.uint16)
    >>> values = np.ones((2, 2), np.float32)
    >>> content = map_tiff(values, flags, pitch=(0.5, 0.5), title="film", unit="um")
    >>> tifffile.imread(io.BytesIO(content)).tolist()
    [[1.0, nan], [1.0, 1.0]]
    """
    import tifffile

    file = io.BytesIO()
    # ImageJ takes pixels per unit of length
    tifffile.imwrite(
        file,
        np.where(flags == 0, values, np.nan).astype(np.float32),
        imagej=True,
        resolution=(1 / pitch[0], 1 / pitch[1]),
        # ImageJ keeps its description in ASCII
        metadata={"unit": "mm", "Info": f"{title} [{unit}]".encode("ascii", "replace").decode()},
    )
    return file.getvalue()


def map_csv(values: Image, flags: FlagImage, *, x: Array, y: Array, name: str) -> bytes:
    """Write a map as one row of text for each pixel.

    Parameters
    ----------
    values, flags : array, (y, x)
        A map and its flags.
    x, y : array
        Positions of columns and rows. [mm]
    name : str
        Heading of the values, with the unit.

    Returns
    -------
    bytes
        Columns x, y, the values, which are empty where flagged, and flags.

    Examples
    --------
    >>> position = np.array([0.0, 0.5])
    >>> flags = np.array([[0, 2]], np.uint16)
    >>> text = map_csv(
    ...     np.ones((1, 2), np.float32), flags, x=position, y=position[:1], name="thickness [um]"
    ... )
    >>> print(text.decode(), end="")
    x [mm],y [mm],thickness [um],flags
    0,0,1,0
    0.5,0,,2
    """
    # rows follow each other along x, as the pixels in memory do
    across, down = np.meshgrid(x, y)
    shown = np.where(flags == 0, values, np.nan)
    columns = {"x [mm]": across.ravel(), "y [mm]": down.ravel(), name: shown.ravel()}
    return table_csv({**columns, "flags": flags.ravel()}).encode()
