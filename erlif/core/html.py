"""Small pieces of HTML for notebooks: tables, lists, pictures.

The macros of ``notebook.html`` beside this module escape the text of files.
"""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Iterable, Sequence
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from erlif.core.arrays import Array
from erlif.core.notes import Level
from erlif.core.units import count_of

_MISSING = np.array([217, 217, 217], np.uint8)  # colour of pixels without a value

_PALETTE = 128  # colours of an embedded picture

_WRITTEN = 5  # warnings that are written out

# Edges of the axes in the picture of a curve. [px]
_LEFT, _RIGHT, _TOP, _BOTTOM = 34.0, 224.0, 20.0, 112.0

Range = tuple[float, float]


@cache
def _macros() -> Any:
    """The macros as functions."""
    from jinja2 import Environment, PackageLoader, StrictUndefined  # slow to load

    loader = PackageLoader("erlif.core", "")
    environment = Environment(loader=loader, autoescape=True, undefined=StrictUndefined)
    return environment.get_template("notebook.html").module


def card(title: str, subtitle: str, *parts: str) -> str:
    """Put parts under a title.

    Parameters
    ----------
    title, subtitle : str
        Plain text.
    *parts : str
        HTML; empty ones are left out.

    Returns
    -------
    str

    Examples
    --------
    >>> "&lt;b&gt;" in card("<b>", "", "<p>2 um</p>")
    True
    """
    return str(_macros().card(title, subtitle, parts))


def rows_table(rows: Iterable[tuple[str, str]]) -> str:
    """Make a table of names and values, both plain text.

    Parameters
    ----------
    rows : iterable of (str, str)

    Returns
    -------
    str

    Examples
    --------
    >>> rows_table([("oil", "<80W>")]).count("&lt;80W&gt;")
    1
    """
    return str(_macros().rows_table(rows))


def findings_list(findings: Sequence[tuple[Level, str]]) -> str:
    """List warnings, and count the notes beside them.

    Parameters
    ----------
    findings : sequence of (Level, str)
        Level and plain text.

    Returns
    -------
    str
        Empty without findings.

    Examples
    --------
    >>> findings_list([(Level.NOTE, "no flat")])
    '<div style="opacity:0.75">1 note</div>'
    """
    serious = [(level.value, text) for level, text in findings if level is not Level.NOTE]
    notes = len(findings) - len(serious)
    parts = [f"{len(serious) - _WRITTEN} more warnings"] if len(serious) > _WRITTEN else []
    parts += [count_of(notes, "note")] if notes else []
    return str(_macros().findings_list(serious[:_WRITTEN], ", ".join(parts)))


def colour_picture(values: npt.ArrayLike, limits: Range) -> npt.NDArray[np.uint8]:
    """Colour an image with batlow of Crameri (2018); what has no value is grey.

    Parameters
    ----------
    values : array, (y, x)
    limits : (float, float)
        Values at the ends of the colours.

    Returns
    -------
    array of uint8, (y, x, 3)

    Examples
    --------
    >>> colour_picture([[np.nan]], (0.0, 1.0)).tolist()
    [[[217, 217, 217]]]
    """
    import cmap

    low, high = limits
    image = np.asarray(values, float)
    known = np.isfinite(image)
    place = np.where(known, (image - low) / (high - low if high > low else 1.0), 0.0)
    table = np.asarray(cmap.Colormap("crameri:batlow").lut(256))[:, :3]
    rgb = np.rint(255 * table).astype(np.uint8)
    picture: npt.NDArray[np.uint8] = rgb[np.rint(255 * np.clip(place, 0.0, 1.0)).astype(int)]
    picture[~known] = _MISSING
    return picture


def picture_tag(picture: npt.NDArray[np.uint8], *, alt: str, width: int = 160) -> str:
    """Embed a picture as PNG, thinned to its width on the screen.

    Parameters
    ----------
    picture : array of uint8, (y, x, 3)
    alt : str
        Plain text.
    width : int
        On the screen. [px]

    Returns
    -------
    str

    Examples
    --------
    >>> picture_tag(np.zeros((2, 2, 3), np.uint8), alt="film")[:33]
    '<img src="data:image/png;base64,i'
    """
    from PIL import Image

    # a palette takes a third of the bytes, and a notebook keeps each picture that it has shown
    step = max(1, math.ceil(max(picture.shape[0], picture.shape[1]) / width))
    thin = Image.fromarray(np.ascontiguousarray(picture[::step, ::step]))
    buffer = io.BytesIO()
    thin.quantize(_PALETTE).save(buffer, "PNG", optimize=True)
    data = base64.b64encode(buffer.getvalue()).decode("ascii")
    return str(_macros().picture_tag(data, alt, width))


def captioned(pictures: Iterable[tuple[str, str]]) -> str:
    """Set pictures side by side, each above its caption.

    Parameters
    ----------
    pictures : iterable of (str, str)
        HTML of the picture, and its caption as plain text.

    Returns
    -------
    str

    Examples
    --------
    >>> captioned([("<img>", "trigger 0")]).count("trigger 0")
    1
    """
    return str(_macros().captioned(pictures))


def curve_picture(
    curve: tuple[Array, Array], points: tuple[Array, Array], *, labels: tuple[str, str]
) -> str:
    """Draw a curve through points as SVG, in the colour of the text around it.

    Parameters
    ----------
    curve : (array, array)
        Places and values of the line.
    points : (array, array)
        Places and values of the measured points.
    labels : (str, str)
        Of both axes, plain text.

    Returns
    -------
    str

    Examples
    --------
    >>> line = np.linspace(0, 1, 5)
    >>> curve_picture((line, line), (line, line), labels=("film", "ratio")).count("<circle")
    5
    """
    x, y = (np.concatenate([one, other]) for one, other in zip(curve, points, strict=True))
    (x0, x1), (y0, y1) = ((float(np.nanmin(v)), float(np.nanmax(v))) for v in (x, y))

    def place(u: Array, v: Array) -> list[tuple[float, float]]:
        across = _LEFT + (_RIGHT - _LEFT) * (u - x0) / ((x1 - x0) or 1.0)
        down = _BOTTOM - (_BOTTOM - _TOP) * (v - y0) / ((y1 - y0) or 1.0)
        good = np.isfinite(across) & np.isfinite(down)
        return [
            (round(float(a), 1), round(float(b), 1))
            for a, b in zip(across[good], down[good], strict=True)
        ]

    ends = (x0, x1), (y0, y1)
    return str(_macros().curve_picture(place(*curve), place(*points), *ends, labels))
