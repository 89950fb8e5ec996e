"""The table of runs that are processed together."""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from pathlib import Path

from erlif.core.bounded import read_rows
from erlif.core.errors import ConfigError

_COLUMNS = ("run_dir", "calibration", "output")

# Size of a table that is read: 16 MB hold 100,000 runs. [byte]
_LARGEST = 2**24


@dataclass(frozen=True)
class RunEntry:
    """A run to be processed, with what differs from the defaults.

    Attributes
    ----------
    run_dir : Path
        Directory with ``run.toml``.
    calibration : Path | None
        Default: the calibration that run.toml names.
    output : Path | None
        Default: ``film.nc`` in the run directory.
    """

    run_dir: Path
    calibration: Path | None = None
    output: Path | None = None


def read_run_table(path: Path) -> list[RunEntry]:
    """Read a table of runs: ``run_dir`` and, optionally, ``calibration`` and ``output``.

    Parameters
    ----------
    path : Path
        CSV file in UTF-8. Relative paths start from the directory of the table; an empty cell
        stands for the default.

    Returns
    -------
    list of RunEntry
        In the order of the rows.

    Raises
    ------
    ConfigError
        If the file cannot be read, has another column or no run, or if a row has no run_dir or
        another number of cells than the header. The header is row 1.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as directory:
    ...     path = Path(directory, "runs.csv")
    ...     _ = path.write_text("run_dir,output\\nmonday,monday.zarr\\ntuesday,\\n")
    ...     one, two = read_run_table(path)
    >>> one.run_dir.name, one.output.name, two.output
    ('monday', 'monday.zarr', None)
    """
    try:
        rows = read_rows(path, largest=_LARGEST)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise ConfigError(
            f"Expected a table of runs in {path}; it cannot be read: {reason}. Name a CSV file in "
            "UTF-8 with a column run_dir, or the run directories themselves."
        ) from error
    header = rows[0][1] if rows else []
    _check_header(header, path)
    if len(rows) == 1:
        raise ConfigError(
            f"Expected at least one run in {path}; it holds the header alone. Write one row for "
            "each run."
        )

    entries = []
    for number, row in rows[1:]:
        if len(row) != len(header):
            raise ConfigError(
                f"Expected {len(header)} cells in row {number} of {path}, as in the header; got "
                f"{len(row)}. Put a path that holds a comma into double quotes."
            )
        cells = dict(zip(header, row, strict=True))
        if not cells["run_dir"]:
            raise ConfigError(
                f"Expected a run_dir in row {number} of {path}; the cell is empty. Name a run "
                "directory, or take the row out."
            )
        named = {name: path.parent / cell for name, cell in cells.items() if cell}
        entries.append(RunEntry(**named))
    return entries


def _check_header(header: list[str], path: Path) -> None:
    expected = (
        "Expected a run directory, or a table with the columns run_dir and, optionally, "
        f"calibration and output in {path}"
    )
    for name in header:
        if name not in _COLUMNS:
            near = difflib.get_close_matches(name, _COLUMNS, n=1, cutoff=0.5)
            hint = f"did you mean {near[0]!r}? Correct it." if near else "take it out."
            raise ConfigError(f"{expected}; got {name!r}; {hint}")
        if header.count(name) > 1:
            raise ConfigError(f"{expected}; {name} comes {header.count(name)} times. Keep one.")
    if "run_dir" not in header:
        raise ConfigError(f"{expected}; run_dir is missing. Name the columns in the first row.")
