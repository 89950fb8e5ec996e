"""LabVIEW measurement files (LVM): text whose headers stand between the rows of a table."""

from __future__ import annotations

import re
from pathlib import Path

from erlif.core.errors import EncoderError
from erlif.io.ingest.logs.table import split_unit

# First characters of a file.
LABVIEW = b"LabVIEW Measurement"

# First cell of a row of a header, other than that of the names.
_HEADER = re.compile(r"\*{3}.*|(?!NaN|Inf)[A-Z]\w+")

# First cell of the row with the names of the columns, and name of its last one.
_NAMES, _COMMENT = "X_Value", "Comment"


def flatten_labview(text: str, path: Path) -> str:
    """Write the table of a LabVIEW file as a plain one; rows keep their numbers.

    Units of Y_Unit_Label stand in brackets behind the names. Where the file has no column of
    times, they follow from X0 and Delta_X. Comments and repeated columns of times are left out.

    Parameters
    ----------
    text : str
    path : Path
        For messages.

    Returns
    -------
    str

    Raises
    ------
    EncoderError
        If there is no row of names, channels have times of their own, or parts differ.

    Examples
    --------
    >>> lines = ["LabVIEW Measurement", "X_Value\\tEncoder\\tComment", "0.1\\t20.5\\tstart"]
    >>> flatten_labview("\\n".join(lines), Path("a.lvm"))
    '\\nX_Value [s]\\tEncoder\\n0.1\\t20.5'
    """
    fields: dict[str, list[str]] = {}
    lines, header = list[str](), ""
    kept, more = [0], list[int]()
    separator, rows = "\t", -1  # no row of names yet
    for line in text.replace("\r\n", "\n").split("\n"):
        cells = [cell.strip() for cell in line.split(separator)]
        plain = ""
        if cells[0] == _NAMES:
            kept, more, plain = _name_columns(cells, fields, separator)
            if header not in ("", plain):
                raise EncoderError(
                    f"Expected the same channels in all parts of {path.name}; the names "
                    f"{plain[:60]!r} follow {header[:60]!r}. Export each part by itself."
                )
            plain, header, rows = "" if header else plain, plain, 0
        elif rows < 0 or _HEADER.fullmatch(cells[0]):
            fields[cells[0]] = cells[1:]
            if line.startswith("Separator") and "Comma" in line:
                separator = ","
        elif any(cells):
            cells += [""] * (1 + max(kept) - len(cells))
            if any(cells[k] not in ("", cells[0]) for k in more if k < len(cells)):
                raise EncoderError(
                    f"Expected one time for all channels in a row of {path.name}; channels have "
                    f"times of their own, as in {line[:60]!r}. Write the file with one X column."
                )
            step = _number(fields, "Delta_X")
            if step and not cells[0]:
                cells[0] = f"{_number(fields, 'X0') + step * rows:.12g}"
                if fields.get("Decimal_Separator", [""])[0] == ",":
                    cells[0] = cells[0].replace(".", ",")
            plain, rows = separator.join(cells[k] for k in kept), rows + 1
        lines.append(plain)
    if rows < 0:
        raise EncoderError(
            f"Expected the row {_NAMES} with the names of the channels in {path.name}; there is "
            "none. Export the whole file."
        )
    return "\n".join(lines)


def _name_columns(
    cells: list[str], fields: dict[str, list[str]], separator: str
) -> tuple[list[int], list[int], str]:
    """Places of the columns that are kept, of further columns of times, and the header."""
    places = [k for k, cell in enumerate(cells) if cell and cell != _COMMENT]
    more = [k for k in places[1:] if cells[k] == _NAMES]
    kept = [k for k in places if k not in more]
    units = ["s" if fields.get("X_Dimension", ["Time"])[0] in ("Time", "") else ""]
    units += fields.get("Y_Unit_Label", []) + [""] * len(cells)
    names = [
        f"{cells[k]} [{units[k]}]" if units[k] and not split_unit(cells[k])[1] else cells[k]
        for k in kept
    ]
    return kept, more, separator.join(names)


def _number(fields: dict[str, list[str]], key: str) -> float:
    try:
        return float(fields[key][0].replace(",", "."))
    except (KeyError, IndexError, ValueError):
        return 0.0
