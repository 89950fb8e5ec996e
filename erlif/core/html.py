"""Small pieces of HTML for notebooks: tables, lists, pictures. Text of files is escaped here."""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Iterable, Sequence
from html import escape

import numpy as np
import numpy.typing as npt

from erlif.core.arrays import Array
from erlif.core.notes import Level

_MISSING = np.array([217, 217, 217], np.uint8)
"""Colour of pixels without a value."""

_PALETTE = 128
"""Colours of an embedded picture."""

_CELL = "padding:1px 14px 1px 0;text-align:left;vertical-align:top"
_COLOURS = {Level.ERROR: "#B00020", Level.WARNING: "#B35900"}

Range = tuple[float, float]


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
    small = f' <span style="opacity:0.7">{escape(subtitle)}</span>' if subtitle else ""
    body = "".join(part for part in parts if part)
    return (
        '<div class="erlif" style="font-size:0.92em;line-height:1.45;max-width:60em">'
        f"<div><strong>{escape(title)}</strong>{small}</div>{body}</div>"
    )


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
    lines = "".join(
        f'<tr style="background:none"><td style="{_CELL};opacity:0.75">{escape(name)}</td>'
        f'<td style="{_CELL}">{escape(value)}</td></tr>'
        for name, value in rows
    )
    return f'<table style="border:none;border-collapse:collapse;margin:4px 0">{lines}</table>'


def findings_list(findings: Sequence[tuple[Level, str]], *, most: int = 5) -> str:
    """List warnings, and count the notes beside them.

    Parameters
    ----------
    findings : sequence of (Level, str)
        Level and plain text.
    most : int
        Warnings that are written out.

    Returns
    -------
    str
        Empty without findings.

    Examples
    --------
    >>> findings_list([(Level.NOTE, "no flat")])
    '<div style="opacity:0.75">1 note</div>'
    """
    serious = [(level, text) for level, text in findings if level is not Level.NOTE]
    lines = "".join(
        f'<li><span style="color:{_COLOURS[level]}">{level.value}</span>: {escape(text)}</li>'
        for level, text in serious[:most]
    )
    listed = f'<ul style="margin:2px 0;padding-left:1.4em">{lines}</ul>' if lines else ""

    notes = len(findings) - len(serious)
    parts = [f"{len(serious) - most} more warnings"] if len(serious) > most else []
    parts += [f"{notes} note{'s' if notes > 1 else ''}"] if notes else []
    rest = f'<div style="opacity:0.75">{", ".join(parts)}</div>' if parts else ""
    return listed + rest


def colour_picture(
    values: npt.ArrayLike, limits: Range, *, colours: str = "batlow"
) -> npt.NDArray[np.uint8]:
    """Colour an image; what has no value is grey.

    Parameters
    ----------
    values : array, (y, x)
    limits : (float, float)
        Values at the ends of the colours.
    colours : str
        Name after Crameri (2018).

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
    table = np.asarray(cmap.Colormap(f"crameri:{colours}").lut(256))[:, :3]
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
    text = base64.b64encode(buffer.getvalue()).decode("ascii")
    return (
        f'<img src="data:image/png;base64,{text}" alt="{escape(alt)}" width="{width}" '
        'style="display:block;margin:2px 0">'
    )


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
    cells = "".join(
        f'<div style="margin:0 10px 6px 0">{picture}'
        f'<div style="font-size:0.85em;opacity:0.8">{escape(caption)}</div></div>'
        for picture, caption in pictures
    )
    return f'<div style="display:flex;flex-wrap:wrap;margin:4px 0">{cells}</div>'


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
    width, height, left, top = 230.0, 142.0, 34.0, 20.0
    x, y = (np.concatenate([one, other]) for one, other in zip(curve, points, strict=True))
    (x0, x1), (y0, y1) = ((float(np.nanmin(v)), float(np.nanmax(v))) for v in (x, y))

    def place(u: Array, v: Array) -> list[tuple[float, float]]:
        across = left + (width - left - 6) * (u - x0) / ((x1 - x0) or 1.0)
        down = top + (height - top - 30) * (1 - (v - y0) / ((y1 - y0) or 1.0))
        good = np.isfinite(across) & np.isfinite(down)
        return [
            (round(float(a), 1), round(float(b), 1))
            for a, b in zip(across[good], down[good], strict=True)
        ]

    line = " ".join(f"{a},{b}" for a, b in place(*curve))
    dots = "".join(f'<circle cx="{a}" cy="{b}" r="1.6"/>' for a, b in place(*points))
    bottom = height - 30
    texts = [
        (left, bottom + 12, "start", f"{x0:.3g}"),
        (width - 6, bottom + 12, "end", f"{x1:.3g}"),
        ((left + width) / 2, bottom + 25, "middle", labels[0]),
        (left - 4, bottom, "end", f"{y0:.2f}"),
        (left - 4, top + 8, "end", f"{y1:.2f}"),
        (left, top - 8, "start", labels[1]),
    ]
    words = "".join(
        f'<text x="{a}" y="{b}" text-anchor="{anchor}">{escape(text)}</text>'
        for a, b, anchor, text in texts
    )
    return (
        f'<svg width="{width:.0f}" height="{height:.0f}" role="img" '
        f'aria-label="{escape(labels[1])} against {escape(labels[0])}" '
        'style="display:block;font-size:10px">'
        f'<g fill="currentColor" font-family="sans-serif">{words}</g>'
        f'<path d="M{left},{top}V{bottom}H{width - 6}" fill="none" stroke="currentColor" '
        'opacity="0.5"/>'
        f'<g fill="currentColor" opacity="0.55">{dots}</g>'
        f'<polyline points="{line}" fill="none" stroke="#0072B2" stroke-width="1.5"/></svg>'
    )
