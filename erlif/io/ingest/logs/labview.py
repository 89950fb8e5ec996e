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
        If channels have times of their own.

    Examples
    --------
    >>> lines = ["LabVIEW Measurement", "X_Value\\tEncoder\\tComment", "0.1\\t20.5\\tstart"]
    >>> flatten_labview("\\n".join(lines), Path("a.lvm"))
    '\\nX_Value [s]\\tEncoder\\n0.1\\t20.5'
    """
    fields: dict[str, list[str]] = {}
    kept, more, header, lines = [0], list[int](), "", list[str]()
    separator, rows = "\t", 0
    for line in text.replace("\r\n", "\n").split("\n"):
        cells = [cell.strip() for cell in line.split(separator)]
        plain = ""
        if cells[0] == _NAMES:
            # of other channels in a later part the names stay, and are refused among the numbers
            places = [k for k, cell in enumerate(cells) if cell and cell != _COMMENT]
            more = [k for k in places[1:] if cells[k] == _NAMES]
            kept = [k for k in places if k not in more]
            names = separator.join(_with_unit(cells[k], fields, k) for k in kept)
            plain, header, rows = "" if names == header else names, names, 0
        elif not header or _HEADER.fullmatch(cells[0]):
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
            if not cells[0]:
                cells[0] = _count_time(fields, rows)
            plain, rows = separator.join(cells[k] for k in kept), rows + 1
        lines.append(plain)
    return "\n".join(lines)


def _with_unit(name: str, fields: dict[str, list[str]], place: int) -> str:
    """Name of a column with its unit in brackets, where the file has one."""
    units = ["s" if fields.get("X_Dimension", ["Time"])[0] in ("Time", "") else ""]
    units += fields.get("Y_Unit_Label", [])
    unit = units[place] if place < len(units) else ""
    return f"{name} [{unit}]" if unit and not split_unit(name)[1] else name


def _count_time(fields: dict[str, list[str]], rows: int) -> str:
    """Time of a row by the first one and the step; empty where the file has none."""
    try:
        first, step = (float(fields[key][0].replace(",", ".")) for key in ("X0", "Delta_X"))
    except (LookupError, ValueError):
        return ""
    decimal = fields.get("Decimal_Separator", ["."])[0]
    return f"{first + step * rows:.12g}".replace(".", decimal or ".")
