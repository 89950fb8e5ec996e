"""Files of data loggers; of text, their separators, decimal commas, headers and rows of units."""

from __future__ import annotations

import codecs
import csv
import io
import math
import re
from array import array
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path

import numpy as np

from erlif.core.bounded import read_bounded
from erlif.core.errors import EncoderError
from erlif.io.ingest.logs.binary import read_binary_table
from erlif.io.ingest.logs.labview import LABVIEW, flatten_labview
from erlif.io.ingest.logs.table import (
    ENCODER,
    LARGEST_FILE,
    MOST_CELLS,
    MOST_TEXTS,
    LogColumn,
    LogTable,
    LogUse,
    is_unit,
    split_unit,
)

# Rows at the head of a file in which separator and header are looked for.
SAMPLE = 400

# Characters of a line above which a file is no table.
LONGEST_LINE = 2**20

# Size from which all rows are read at once, if they hold numbers alone. [byte]
LARGE = 2**20

_SEPARATORS = {"\t": "tabs", ";": "semicolons", ",": "commas", " ": "blanks"}

# A blank before a bracket, which belongs to a name and its unit.
_BEFORE_UNIT = re.compile(r"\s+(?=[\[(<])")

_COMMENT = ("#", "%")

# A usual character of Chinese or its punctuation in GBK, which Latin-1 would hardly hold.
_GBK_PAIR = re.compile(rb"[\xa1-\xa9\xb0-\xd7][\xa1-\xfe]")

_COMMA_NUMBER = re.compile(r"[+-]?(\d+,\d*|,\d+)([eE][+-]?\d+)?")

# A header and one row.
_FEWEST_ROWS = 2

# Number of a row in the file, from 1, and its cells without spaces around them.
_Row = tuple[int, list[str]]


def read_log_table(path: Path, wanted: Collection[str], use: LogUse = ENCODER) -> LogTable:
    """Read the file of a data logger, of any format.

    Parameters
    ----------
    path : Path
    wanted : collection of str
        Names by which the header of a text file is recognised.
    use : LogUse
        For what the log is read.

    Returns
    -------
    LogTable

    Raises
    ------
    ErlifError
        That of `use`, if the file cannot be read or is no table.
    """
    try:
        table = read_binary_table(path) or read_text_table(path, wanted, use)
    except EncoderError as error:
        raise use.error(str(error)) from error
    return replace(table, use=use)


def read_text_table(path: Path, wanted: Collection[str], use: LogUse = ENCODER) -> LogTable:
    """Read a text file of a data logger.

    Columns are separated by commas, semicolons, tabs or blanks. Where commas do not separate, they
    may be decimal. Rows that begin with # or % are comments, rows above the header a preamble; a
    row of units may follow the header. The text is UTF-8, UTF-16 with a byte order mark, GBK or
    Latin-1.

    Parameters
    ----------
    path : Path
    wanted : collection of str
        Names by which the header is recognised.
    use : LogUse
        For what the table is read.

    Returns
    -------
    LogTable

    Raises
    ------
    EncoderError
        If the file cannot be read or is no table. Rows are counted as in the file, from 1.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp(), "log.txt")
    >>> _ = path.write_text("Logger 3\\nZeit;Winkel\\ns;deg\\n0,5;1,25\\n0,6;1,5\\n")
    >>> table = read_text_table(path, ["Winkel"])
    >>> [(column.name, column.unit, column.values.tolist()) for column in table.columns]
    [('Zeit', 's', [0.5, 0.6]), ('Winkel', 'deg', [1.25, 1.5])]
    """
    content = _read_content(path, use)
    encoding, spoken = _find_encoding(content)
    if b"\0" in content and not encoding.startswith("utf-16"):
        raise _no_text(path, "holds bytes of zero")

    if content.startswith(LABVIEW):
        content = flatten_labview(content.decode(encoding), path).encode()
        encoding, spoken = "utf-8-sig", "a LabVIEW file"

    def text() -> io.TextIOWrapper:
        return io.TextIOWrapper(io.BytesIO(content), encoding, newline="")

    try:
        layout = _find_layout(text(), wanted, path)
        plain = _read_plain(content, encoding, layout)
        if plain is not None:
            return _make_table(path, layout, *plain, spoken)
        builders, rows = _read_rows(text(), layout, path)
    except (UnicodeError, csv.Error) as error:
        raise _no_text(path, f"is not: {error}") from error

    decimal = _check_decimals(builders, path)
    columns = [builder.finish(unit) for builder, unit in zip(builders, layout.units, strict=True)]
    return _make_table(path, layout, columns, rows, decimal, spoken)


def _no_text(path: Path, reason: str) -> EncoderError:
    return EncoderError(
        f"Expected {path.name} to be a CSV text file; it {reason}. Save it as CSV in UTF-8."
    )


def _few_rows(path: Path, count: int, wanted: Collection[str] = ()) -> EncoderError:
    example = f" such as {','.join(wanted)}" if wanted else ""
    return EncoderError(
        f"Expected a header{example} and rows of numbers in {path.name}; rows found: {count}. "
        "Export the whole table."
    )


def _make_table(
    path: Path,
    layout: _Layout,
    columns: Sequence[LogColumn],
    rows: Sequence[int],
    decimal: str,
    spoken: str,
) -> LogTable:
    separator = _SEPARATORS[layout.separator]
    remarks = [f"columns separated by {separator}"] if layout.separator != "," else []
    remarks += [remark for remark in (decimal, spoken) if remark]
    if layout.header_row > 1:
        remarks.append(f"header in row {layout.header_row}")
    return LogTable(path.name, tuple(columns), rows, tuple(remarks))


# bytes to rows


def _read_content(path: Path, use: LogUse) -> bytes:
    try:
        return read_bounded(path, largest=LARGEST_FILE)
    except OSError as error:
        raise EncoderError(
            f"Expected the table {path}; it cannot be read: {error.strerror}. Save it there, "
            f"or correct {use.name}."
        ) from error


def _find_encoding(content: bytes) -> tuple[str, str]:
    """Encoding of the text, and a remark where it is not UTF-8."""
    # "utf-8-sig" also reads the byte order mark that spreadsheets write
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16", "text in UTF-16"
    try:
        content.decode("utf-8-sig")
    except UnicodeDecodeError:
        if _GBK_PAIR.sub(b"", content).isascii():
            return "gbk", "text in GBK"
        return "latin-1", "text in Latin-1"
    return "utf-8-sig", ""


def _rows(text: io.TextIOWrapper, separator: str, path: Path) -> Iterator[_Row]:
    """Rows that are not empty."""

    def lines() -> Iterator[str]:
        while line := text.readline(LONGEST_LINE + 1):
            if len(line) > LONGEST_LINE:
                raise EncoderError(
                    f"Expected rows of a table in {path.name}; a line has more than {LONGEST_LINE} "
                    "characters. Name the file of the log."
                )
            yield _BEFORE_UNIT.sub("", line) if separator == " " else line

    reader = csv.reader(lines(), delimiter=separator, skipinitialspace=separator == " ")
    for number, cells in enumerate(reader, 1):
        stripped = [cell.strip() for cell in cells]
        if any(stripped):
            yield number, stripped


def _is_comment(cells: Sequence[str]) -> bool:
    return cells[0].startswith(_COMMENT)


# header


@dataclass(frozen=True)
class _Layout:
    """Separator, header and units of a file."""

    separator: str
    names: list[str]
    units: list[str]
    header_row: int
    first_row: int


def _find_layout(text: io.TextIOWrapper, wanted: Collection[str], path: Path) -> _Layout:
    """Separator and header from the head of the file."""
    # the separator that gives the most rows of numbers, of equal width; commas where none does
    samples: dict[str, list[_Row]] = {}
    for separator in _SEPARATORS:
        text.seek(0)
        try:
            samples[separator] = list(islice(_rows(text, separator, path), SAMPLE))
        except csv.Error:
            samples[separator] = []
    separator = max(samples, key=lambda one: (_score(samples[one], one, wanted), one == ","))
    rows = samples[separator]
    plain = [row for row in rows if not _is_comment(row[1])]
    if len(plain) < _FEWEST_ROWS and not (plain and len(rows) > len(plain)):
        raise _few_rows(path, len(plain), wanted)

    first = next((n for n, row in enumerate(plain) if _is_numeric(row[1], separator)), len(plain))
    header = _choose_header(plain, first, wanted)
    if header is None:
        titles = _header_in_comment(rows, plain, first)
        if titles is None:
            number, cells = plain[0]
            raise EncoderError(
                f"Expected a header with the names of the columns in {path.name}; row {number} is "
                f"{separator.join(cells)[:80]!r}. Put a row such as "
                f"{','.join(wanted) or 'time_s,load_N'} above the numbers."
            )
        number, names = titles
        return _Layout(separator, names, [split_unit(name)[1] for name in names], number, number)

    # a row of units between header and numbers
    number, names = plain[header]
    units = [split_unit(name)[1] for name in names]
    last = number
    if header + 1 < first and _is_unit_row(plain[header + 1][1], names):
        last, cells = plain[header + 1]
        for place, cell in enumerate(cells):
            units[place] = cell.strip("[]()<> ") or units[place]
    return _Layout(separator, names, units, number, last)


def _score(rows: Sequence[_Row], separator: str, wanted: Collection[str]) -> int:
    """Rows of numbers of one width, those without any text twice, and a header that is known."""
    counts = Counter[int]()
    for _, cells in rows:
        if _is_numeric(cells, separator):
            pure = all(_parse(cell, separator) is not None for cell in cells if cell)
            counts[len(cells)] += 1 + pure
    if separator == " ":  # a sentence above the header may have any word
        wanted = ()
    known = any(set(cells) & set(wanted) for _, cells in rows if len(cells) > 1)
    return max(counts.values(), default=0) + 2 * SAMPLE * known


def _is_numeric(cells: Sequence[str], separator: str) -> bool:
    """Whether a row has several cells, of which half or more are numbers."""
    filled = [cell for cell in cells if cell]
    numbers = sum(_parse(cell, separator) is not None for cell in filled)
    return len(cells) > 1 and bool(filled) and 2 * numbers >= len(filled)


def _choose_header(plain: Sequence[_Row], first: int, wanted: Collection[str]) -> int | None:
    """Place of the header above the first row of numbers, or None."""
    # a row that holds a name that is looked for, whatever follows
    for place, (_, cells) in enumerate(plain[: max(first, 1)]):
        if set(cells) & set(wanted):
            return place

    # else the row above the numbers, or above their row of units
    width = len(plain[first][1]) if first < len(plain) else 0
    above = [n for n in range(first) if len(plain[n][1]) >= width]
    if above and len(above) > 1 and _is_unit_row(plain[above[-1]][1], plain[above[-2]][1]):
        return above[-2]
    return above[-1] if above else None


def _header_in_comment(
    rows: Sequence[_Row], plain: Sequence[_Row], first: int
) -> tuple[int, list[str]] | None:
    """The last comment above the numbers that has as many cells as they have."""
    if first >= len(plain):
        return None
    limit, width = plain[first][0], len(plain[first][1])
    header = None
    for number, cells in rows:
        if number < limit and _is_comment(cells) and len(cells) == width:
            header = number, [cells[0].lstrip("".join(_COMMENT)).strip(), *cells[1:]]
    return header


def _is_unit_row(cells: Sequence[str], names: Sequence[str]) -> bool:
    """Whether all cells are units, one at least."""
    filled = [cell.strip("[]()<> ") for cell in cells if cell]
    return len(cells) <= len(names) and any(filled) and all(is_unit(cell) for cell in filled)


# numbers


def _read_plain(
    content: bytes, encoding: str, layout: _Layout
) -> tuple[list[LogColumn], Sequence[int], str] | None:
    """Columns of a large file of nothing but finite numbers, read at once; else None."""
    if len(content) < LARGE or b'"' in content:
        return None
    text = content.decode(encoding)
    has_commas = layout.separator != "," and "," in text
    if has_commas and "." in text:
        return None

    # more rows than are read would be found as a wrong number of lines
    width = len(layout.names)
    lines = text.count("\n") + (not text.endswith("\n")) - layout.first_row
    if lines * width > MOST_CELLS:
        return None

    # line by line: a text as a file in memory takes four bytes for each character
    del text
    rows: Iterable[str] = io.TextIOWrapper(io.BytesIO(content), encoding, newline="\n")
    if has_commas:
        rows = (row.replace(",", ".") for row in rows)
    try:
        numbers = np.loadtxt(
            rows,
            delimiter=None if layout.separator == " " else layout.separator,
            comments=None,
            skiprows=layout.first_row,
            ndmin=2,
        )
    except ValueError:
        return None
    if numbers.shape != (lines, width) or not np.isfinite(numbers).all():
        return None
    columns = [
        LogColumn(name, unit, numbers[:, place].copy())
        for place, (name, unit) in enumerate(zip(layout.names, layout.units, strict=True))
    ]
    first = layout.first_row + 1
    return columns, range(first, first + lines), "decimal commas" if has_commas else ""


@dataclass
class _Builder:
    """A column while it is read: 8 bytes for each number, and the texts that are none."""

    name: str
    values: array[float] = field(default_factory=lambda: array("d"))
    texts: dict[int, str] = field(default_factory=dict)
    commas: int = 0
    point: int = 0

    def finish(self, unit: str) -> LogColumn:
        return LogColumn(self.name, unit, np.array(self.values), self.texts)


def _parse(cell: str, separator: str) -> float | None:
    """A number; with a decimal comma where commas do not separate."""
    try:
        # float() reads "1_000", which no logger means
        return float(cell) if "_" not in cell else None
    except ValueError:
        if separator != "," and _COMMA_NUMBER.fullmatch(cell):
            return float(cell.replace(",", "."))
        return None


def _read_rows(
    text: io.TextIOWrapper, layout: _Layout, path: Path
) -> tuple[list[_Builder], list[int]]:
    """All rows below the header."""
    builders = [_Builder(name) for name in layout.names]
    separator, width = layout.separator, len(layout.names)
    rows, texts = array("q"), 0
    for number, cells in _without_headers(_rows(text, separator, path), layout):
        while len(cells) > width and not cells[-1]:  # a separator at the end of the row
            cells.pop()
        if len(cells) != width:
            decimal = (
                " A decimal comma makes two values of one: separate the columns with semicolons, "
                "or write decimal points."
                if len(cells) > width and separator == ","
                else ""
            )
            raise EncoderError(
                f"Expected {width} values in row {number} of {path.name}, as in its header; it has "
                f"{len(cells)}.{decimal} Correct the row."
            )

        place = len(rows)
        rows.append(number)
        for builder, cell in zip(builders, cells, strict=True):
            value = _parse(cell, separator)
            if value is None or not math.isfinite(value):
                builder.texts[place] = cell
                builder.values.append(math.nan)
                texts += 1
            else:
                builder.values.append(value)
                if "," in cell:
                    builder.commas += 1
                elif "." in cell and not builder.point:
                    builder.point = number
        if len(rows) * width > MOST_CELLS or texts > MOST_TEXTS:
            raise EncoderError(
                f"Expected at most {MOST_CELLS:.0f} numbers and {MOST_TEXTS:.0f} texts in "
                f"{path.name}; it holds more. Export the part of the log that belongs to the run."
            )

    if not rows:
        raise _few_rows(path, 1)
    return builders, rows.tolist()


def _without_headers(rows: Iterable[_Row], layout: _Layout) -> Iterator[_Row]:
    """Rows of the table; a further block of the same columns may have its header once more."""
    above: list[_Row] = []  # shorter rows, which belong to the header of a block if one follows
    in_header = False
    for row in rows:
        number, cells = row
        if number <= layout.first_row or _is_comment(cells):
            continue
        if cells == layout.names:
            above, in_header = [], True
        elif len(cells) < len(layout.names) and not _is_numeric(cells, layout.separator):
            above.append(row)
        elif not (in_header and _is_unit_row(cells, layout.names)):
            yield from (*above, row)
            above, in_header = [], False
    yield from above


def _check_decimals(builders: Sequence[_Builder], path: Path) -> str:
    """A remark on decimal commas; refuses a file that has points as well."""
    commas = [builder for builder in builders if builder.commas]
    points = [builder for builder in builders if builder.point]
    if commas and points:
        raise EncoderError(
            f"Expected decimal commas or decimal points in {path.name}, not both; column "
            f"{commas[0].name} has commas, row {points[0].point}, column {points[0].name} a point. "
            "Export the log with one decimal mark."
        )
    return "decimal commas" if commas else ""
