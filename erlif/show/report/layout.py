"""Templates of the pages, their style, and figures in their text."""

from __future__ import annotations

import base64
import functools
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib import resources
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from markupsafe import Markup, escape

from erlif.core.tables import read_table, text_templates
from erlif.io.files import expect_folder, refuse_existing, write_file

if TYPE_CHECKING:
    from jinja2 import Environment

    from erlif.show.plots.style import AnyFigure
    from erlif.show.report.captions import Caption

_MEDIA = {"svg": "image/svg+xml", "png": "image/png"}
_LARGE = 400_000  # bytes of a drawing that is kept as an image of pixels
_LONGEST = 80  # characters of the name of a run in the name of a file

# What tables name: titles, columns and their order.
_OWN = "erlif.show.report"
TABLES = read_table(_OWN, "tables.toml")


class PageTable(NamedTuple):
    """A table of a page, as the macro `table` draws it.

    Attributes
    ----------
    rows : sequence of sequence of str
        Plain text, which the template escapes; Markup passes as it is.
    head : sequence of str
        Titles of the columns.
    caption : str
        Plain text.
    numbers : sequence of int
        Columns that are aligned at the right.
    """

    rows: Sequence[Sequence[str]]
    head: Sequence[str] = ()
    caption: str = ""
    numbers: Sequence[int] = ()


def render(template: str, **content: Any) -> Markup:
    """Fill a template of the folder ``templates``; plain text in `content` is escaped."""
    return Markup(_templates(_OWN).get_template(template).render(**content))


def render_part(template: str, part: str, package: str = _OWN, /, **content: Any) -> Markup:
    """Fill one macro of a template of a package, which holds the sections of a page."""
    macros = _templates(package).get_template(template).module
    return Markup(getattr(macros, part)(**content))


def render_text(template: str, package: str = _OWN, /, **content: Any) -> str:
    """Fill a template of plain text for the terminal; it ends without a new line."""
    return _templates(package).get_template(template).render(**content).rstrip("\n")


@functools.cache
def _templates(package: str) -> Environment:
    from jinja2 import ChoiceLoader, PackageLoader, select_autoescape

    # a template of another package may use the pieces of this one
    folders = [PackageLoader(name) for name in dict.fromkeys((package, _OWN))]
    environment = text_templates(_OWN).overlay(
        loader=ChoiceLoader(folders),
        autoescape=select_autoescape(("html",)),
        keep_trailing_newline=False,
    )
    environment.filters["units"] = print_units
    environment.filters["g"] = lambda value, digits=6: f"{float(value):.{digits}g}"
    environment.tests["finite"] = math.isfinite
    return environment


def print_columns(rows: Sequence[Sequence[str]], sides: str) -> str:
    """Lay out a table for the terminal, its columns as wide as their widest cell.

    Parameters
    ----------
    rows : sequence of sequence of str
        Cells, the titles of the columns first.
    sides : str
        Side of each column at which its cells begin or end, ``"<>"``.

    Returns
    -------
    str
        Columns with two spaces between them.

    Examples
    --------
    >>> print_columns([("film", "std"), ("2.5", "0.15")], "<>")
    'film   std\\n2.5   0.15'
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    forms = [f"{side}{width}" for side, width in zip(sides, widths, strict=False)]
    lines = [[format(*pair) for pair in zip(row, forms, strict=True)] for row in rows]
    return "\n".join("  ".join(line).rstrip() for line in lines)


def print_units(text: str) -> Markup:
    """Escape a text of the command line, with the units of print.

    Examples
    --------
    >>> print_units("steps of 2 um < 3 um")
    Markup('steps of 2 µm &lt; 3 µm')
    """
    return Markup(re.sub(r"\bum\b", "µm", re.sub(r"\bdegC\b", "°C", str(escape(text)))))


def decimals(value: float, significant: int) -> int:
    """Digits behind the point of so many significant ones, without an exponent."""
    size = abs(value)
    before = math.floor(math.log10(size)) if math.isfinite(size) and size > 0 else 0
    return max(significant - 1 - before, 0)


def print_rows(head: str, rows: Mapping[str, str], *, width: int = 28) -> str:
    """Lay out titles and texts for the terminal, below a first line.

    Parameters
    ----------
    head : str
    rows : mapping of str to str
        Text by title; its further lines stand below the first one.
    width : int
        Columns of the titles.

    Returns
    -------
    str

    Examples
    --------
    >>> print_rows("a film", {"load": "222 N", "notes": "one\\ntwo"}, width=6).splitlines()
    ['a film', '  load  222 N', '  notes one', '        two']
    """
    lines = [head]
    for title, text in rows.items():
        for k, line in enumerate(filter(None, text.split("\n"))):
            lines.append(f"  {title if k == 0 else '':{width}s}{line}")
    return "\n".join(lines)


def compose_page(
    sections: Sequence[tuple[str, str, Markup]],
    *,
    name: str,
    subject: str,
    subtitle: str,
) -> str:
    """Compose a page that needs no other file.

    Parameters
    ----------
    sections : sequence of (str, str, Markup)
        Identifier, title and content of each section.
    name : str
        Heading, plain text.
    subject : str
        What the page is about, for the title of the window.
    subtitle : str
        Line below the heading, plain text.

    Returns
    -------
    str
    """
    heading = {"name": name, "subject": subject, "subtitle": subtitle}
    style = read_resource("page.css")
    return str(render("page.html", sections=sections, style=style, **heading))


def write_page(make: Callable[[], str], out_path: str | Path, *, overwrite: bool) -> Path:
    """Make a page and write it; an existing one is refused before it is made."""
    path = Path(out_path)
    refuse_existing(path, overwrite=overwrite)
    expect_folder(path)
    return write_file(path, make())


def read_resource(name: str, *, of: str = _OWN) -> Markup:
    """A file of a folder: style or script of a page."""
    return Markup(resources.files(of).joinpath(name).read_text(encoding="utf-8"))


class PageFigure(NamedTuple):
    """A figure as a page holds it.

    Attributes
    ----------
    name : str
        Name within the page.
    source : str
        The image itself, as an address.
    title : str
        First words of the caption, plain text.
    text : str
        The rest of the caption.
    wide : bool
        Whether it is two columns wide.
    """

    name: str
    source: str
    title: str
    text: str
    wide: bool


def embed_figure(name: str, figure: AnyFigure, caption: Caption) -> PageFigure:
    """Embed one figure, its image as base64 text."""
    from erlif.show.plots.style import ONE_COLUMN, figure_bytes  # matplotlib; texts need none

    # lines stay sharp as SVG; an image of many pixels, or many points, is much smaller as PNG
    kind = caption.kind
    image = figure_bytes(figure, kind=kind, dpi=caption.dpi)
    if kind == "svg" and len(image) > _LARGE:
        kind = "png"
        image = figure_bytes(figure, kind=kind, dpi=caption.dpi)
    wide = figure.bbox.width > 1.5 * ONE_COLUMN * figure.dpi
    return PageFigure(name, _embed(image, _MEDIA[kind]), caption.title, caption.text, wide)


def embed_image(path: Path, title: str, *, wide: bool) -> PageFigure:
    """Embed a figure that was written as PNG, with a title alone."""
    return PageFigure(path.stem, _embed(path.read_bytes(), _MEDIA["png"]), title, "", wide)


def arrange_figures(
    figures: Iterable[PageFigure], missing: Sequence[tuple[str, str]] = ()
) -> Markup:
    """Arrange figures in two columns, in their order.

    A wide one takes both columns. A narrow one without a partner takes them too, with its caption
    beside it, so that no half of a row is empty.

    Parameters
    ----------
    figures : iterable of PageFigure
    missing : sequence of (str, str)
        Titles of figures that are left out, with the reason.

    Returns
    -------
    Markup
        Empty without either.
    """
    arranged = []
    for wide, run in groupby(figures, key=lambda figure: figure.wide):
        members = list(run)
        for n, figure in enumerate(members):
            lone = len(members) % 2 == 1 and n == len(members) - 1
            arranged.append((figure, "two" if wide else "one lone" if lone else "one"))
    return render("figures.html", figures=arranged, missing=missing)


def download_link(
    text: str, *, name: str, label: str = "Save as CSV", media: str = "text/csv;charset=utf-8"
) -> Markup:
    """Make a link by which a browser saves a text; name and label are plain text."""
    link = Markup('<a download="{}" href="{}">{}</a>')
    return link.format(name, _embed(text.encode(), media), label)


def _embed(content: bytes, media: str) -> str:
    """An address that is the content itself."""
    return f"data:{media};base64,{base64.b64encode(content).decode('ascii')}"


def file_name(run: str, suffix: str) -> str:
    """Make the name of a file from that of a run.

    Examples
    --------
    >>> file_name("a <b> & c", "triggers.csv")
    'a_b_c_triggers.csv'
    """
    words = re.findall(r"[\w.-]+", run)
    return "_".join([*filter(None, ["_".join(words)[:_LONGEST].strip("._-")]), suffix])
