"""A mask image from the strokes of a brush."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count
from pathlib import Path

from PIL import Image as Picture
from PIL import ImageDraw

from erlif.io.files import replacing


def write_mask(
    directory: Path,
    strokes: Sequence[Sequence[tuple[float, float]]],
    *,
    width: float,
    shape: tuple[int, int],
) -> str:
    """Write a mask that is white under the strokes of a brush.

    Parameters
    ----------
    directory : Path
    strokes : sequence of sequence of (float, float)
        Pixels (x, y) on the way of each stroke.
    width : float
        Diameter of the brush. [px]
    shape : (rows, columns)
        Shape of a frame. [px]

    Returns
    -------
    str
        Name of the file in the directory, which no file had before.

    Raises
    ------
    OutputError
        If it cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     name = write_mask(Path(folder), [[(2, 4), (9, 4)]], width=3, shape=(10, 12))
    ...     name, Picture.open(Path(folder, name)).getpixel((5, 4))
    ('mask_1.png', 255)
    """
    rows, columns = shape
    picture = Picture.new("L", (columns, rows))
    pen, reach = ImageDraw.Draw(picture), width / 2
    for stroke in strokes:
        pen.line([tuple(point) for point in stroke], fill=255, width=max(1, round(width)))
        for x, y in stroke:
            pen.ellipse((x - reach, y - reach, x + reach, y + reach), fill=255)

    names = (f"mask_{n}.png" for n in count(1))
    name = next(name for name in names if not (directory / name).exists())
    with replacing(directory / name) as scratch:
        picture.save(scratch, format="PNG")
    return name
