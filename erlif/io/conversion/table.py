"""Tables as CSV: a row for each trigger, or for each pixel of one map."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray
from erlif.core.progress import Progress
from erlif.io.conversion.contents import maps_of, trigger_columns

# Decimals of a position in mm, a picometre.
_DECIMALS = 9


def write_trigger_table(film: xr.Dataset, output: Path) -> None:
    """Write one row for each trigger, with all its numbers.

    Parameters
    ----------
    film : xarray.Dataset
    output : Path
        File to write. Names with units stand in the first row; a number that is not known is NaN.
    """
    columns = trigger_columns(film)
    table = zip(*(_digits(column.values) for column in columns), strict=True)
    with output.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)  # rows end as RFC 4180 (2005) asks
        writer.writerow(column.heading for column in columns)
        writer.writerows(table)


def write_map_table(film: xr.Dataset, output: Path, *, trigger: int, progress: Progress) -> None:
    """Write one row for each pixel of one map.

    Parameters
    ----------
    film : xarray.Dataset
    output : Path
        File to write. Pixels follow each other along x.
    trigger : int
    progress : Progress
        Called after each line of the image.
    """
    maps = dict(maps_of(film, trigger))
    # without rounding, 3 times 0.1 mm would be 0.30000000000000004 mm
    across, down = (_digits(np.round(film[axis].values, _DECIMALS)) for axis in ("x", "y"))
    units = {name: film[name].attrs.get("units", "") for name in ("x", "y", *maps)}
    units["flags"] = ""
    with output.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(f"{name} [{unit}]" if unit else name for name, unit in units.items())
        for row, y in enumerate(down):
            values = (_digits(each[row]) for each in maps.values())
            writer.writerows(zip(across, [y] * len(across), *values, strict=True))
            progress("map", row + 1, film.sizes["y"])


def table_csv(
    columns: Mapping[str, Sequence[object] | AnyArray], *, digits: int = 7, missing: str = ""
) -> str:
    """Write columns as text between commas.

    Parameters
    ----------
    columns : mapping of str to sequence
        Values by heading, all of one length.
    digits : int
        Significant digits of numbers that are not whole.
    missing : str
        What stands for NaN and None.

    Returns
    -------
    str

    Examples
    --------
    >>> table_csv({"load_N": [220.0, None], "stroke": [1, -1]}).splitlines()
    ['load_N,stroke', '220,1', ',-1']
    """

    def text(value: object) -> str:
        if value is None or value != value:  # NaN differs from itself
            return missing
        number = isinstance(value, float | np.floating)
        return f"{value:.{digits}g}" if number else str(value)

    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(columns)
    texts = [[text(value) for value in np.asarray(one, object)] for one in columns.values()]
    writer.writerows(zip(*texts, strict=True))
    return file.getvalue()


def _digits(values: AnyArray) -> list[str]:
    """Numbers with the digits that their type holds, so that reading gives them back; words."""
    if values.dtype.kind in "OUST":
        return [str(each) for each in values]
    if values.dtype.kind in "iub":
        return [str(int(each)) for each in values]
    return [("NaN" if each == "nan" else each) for each in values.astype(str).tolist()]
