"""A film written in the format of another program.

Tables are CSV: a row for each trigger, or for each pixel of one map.

Stacks of images are TIFF, for ImageJ and Fiji.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray
from erlif.core.errors import OutputError
from erlif.core.progress import Progress, silent
from erlif.core.version import __version__
from erlif.io.conversion.contents import choose_trigger, maps_of, table_columns
from erlif.io.conversion.matlab import write_matlab
from erlif.io.conversion.vtk_xml import write_series
from erlif.io.files import (
    describe_trigger,
    open_film,
    reading_film,
    refuse_existing,
    replacing,
    take,
)
from erlif.io.files.headers import MAPS


@dataclass(frozen=True)
class Export:
    """A format to export to.

    Attributes
    ----------
    suffixes : tuple[str, ...]
        Suffixes of its files, the usual one first; of a folder none.
    ending : str
        What the default name of the output has in place of the suffix of the film.
    write : Callable[..., None] | None
        Writes chosen triggers of a film; None where that depends on what is chosen.
    """

    suffixes: tuple[str, ...]
    ending: str
    write: Callable[..., None] | None = None


# Size from which on the stack has one directory for all images, in place of one for each: addresses
# of TIFF end at 4 GiB. ImageJ finds the images by their order. [byte]
LARGEST = 2**32 - 2**20

_DISPLAYED = (1.0, 99.0)  # per cent of the pixels within the displayed range
_ALL_FLAGS = 255.0


def write_stack(film: xr.Dataset, output: Path, *, triggers: list[int], progress: Progress) -> None:
    """Write a hyperstack with a channel for each map and a time for each trigger.

    Flags are numbers from 0 to 255 in the fourth channel. Pixels without a thickness are NaN.

    Arguments as in `write_matlab`.
    """
    import tifffile

    shape = (len(triggers), len(MAPS), film.sizes["y"], film.sizes["x"])
    labels = [
        f"{name} {film[name].attrs.get('units', '')}".removesuffix(" 1")
        + f", {describe_trigger(film, trigger)}"
        for trigger in triggers
        for name in MAPS
    ]

    def images() -> Iterator[AnyArray]:
        for k, trigger in enumerate(triggers):
            for _, image in maps_of(film, trigger):
                yield image.astype(np.float32)
            progress("maps", k + 1, len(triggers))

    with tifffile.TiffWriter(output, imagej=True) as writer:
        writer.write(
            images(),
            shape=shape,
            dtype=np.float32,
            photometric="minisblack",
            resolution=(_per_mm(film.x.values), _per_mm(film.y.values)),
            software=f"erlif {__version__}",
            truncate=4 * int(np.prod(shape)) > LARGEST,
            metadata={
                "axes": "TCYX",
                "unit": "mm",
                "mode": "grayscale",
                "Labels": labels,
                "Ranges": _ranges(film, triggers),
                "Info": f"{film.attrs.get('title', '')}\n{film.attrs.get('settings', '')}",
            },
        )


def _per_mm(place: AnyArray) -> float:
    """Pixels per mm along an axis, whichever way it runs; 1 for a single pixel."""
    return 1.0 if place.size < 2 else (place.size - 1) / abs(float(place[-1] - place[0]))


def _ranges(film: xr.Dataset, triggers: list[int]) -> tuple[float, ...]:
    """Smallest and largest displayed value of each channel, from the trigger in the middle."""
    limits: list[float] = []
    for name, image in maps_of(film, triggers[len(triggers) // 2]):
        known = image[np.isfinite(image)]
        low, high = np.percentile(known, _DISPLAYED) if known.size else (0.0, 1.0)
        limits += (0.0, _ALL_FLAGS) if name == "flags" else (float(low), float(high))
    return tuple(limits)


# Formats by the word that chooses them.
EXPORTS = {
    "csv": Export((".csv",), ".csv"),
    "mat": Export((".mat",), ".mat", write_matlab),
    "tiff": Export((".tif", ".tiff"), ".tif", write_stack),
    "vtk": Export(("",), "_vtk", write_series),
}


def export(
    film: xr.Dataset | str | Path,
    output: str | Path,
    *,
    to: str | None = None,
    trigger: int | None = None,
    crank_angle: float | None = None,
    encoder_angle: float | None = None,
    overwrite: bool = False,
    progress: Progress = silent,
) -> Path:
    """Write a film in the format of another program.

    Maps are read one at a time, so that memory does not grow with the run. The same film gives the
    same bytes.

    Parameters
    ----------
    film : xarray.Dataset or path
        As `erlif.process` returns it, or its file.
    output : path
        File to write; for VTK a folder.
    to : str, optional
        ``"csv"``, ``"mat"``, ``"tiff"`` or ``"vtk"``; default: by the suffix of `output`. CSV is a
        table of the triggers, or of the pixels where one trigger is chosen.
    trigger : int, optional
        Write this trigger alone.
    crank_angle, encoder_angle : float, optional
        The same by one of its angles. [degree]
    overwrite : bool
        Replace an earlier output.
    progress : Progress, optional
        Called as the work proceeds.

    Returns
    -------
    Path
        `output`.

    Raises
    ------
    OutputError
        If the format is unknown, the output exists or cannot be written, or `film` is no film.
    ErlifError
        If there is no such trigger.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.show.plots import example_film
    >>> with TemporaryDirectory() as directory:
    ...     path = export(example_film(), f"{directory}/film.csv")
    ...     path.read_text().splitlines()[0][:40]
    'trigger,frames_used [1],crank_angle [deg'
    """
    output = Path(output)
    kind = format_of(output, to)
    refuse_existing(output, overwrite=overwrite)
    write, ending = EXPORTS[kind].write, EXPORTS[kind].ending
    named = {"name": output.name.removesuffix(ending)} if kind == "vtk" else {}
    with opened_film(film) as source:
        chosen = choose_trigger(
            source, trigger=trigger, crank_angle=crank_angle, encoder_angle=encoder_angle
        )
        triggers = list(range(source.sizes["trigger"])) if chosen is None else [chosen]
        with replacing(output) as scratch:
            if write is None and chosen is not None:
                write_map_table(source, scratch, trigger=chosen, progress=progress)
            elif write is None:
                write_trigger_table(source, scratch)
            else:
                write(source, scratch, triggers=triggers, progress=progress, **named)
    return output


def format_of(output: Path, to: str | None) -> str:
    """Find the format of an output.

    Parameters
    ----------
    output : Path
        File or folder to be written.
    to : str or None
        Format that the user chose; None: by the suffix.

    Returns
    -------
    str
        A key of `EXPORTS`.

    Raises
    ------
    OutputError
        If the format is unknown, or the suffix belongs to another one.

    Examples
    --------
    >>> format_of(Path("film.tif"), None)
    'tiff'
    """
    if to is None:
        kinds = [kind for kind, form in EXPORTS.items() if output.suffix in form.suffixes]
        if kinds and output.suffix:
            return kinds[0]
        raise OutputError(
            f"Expected an output whose suffix names its format; got {output.name}. Give to, one of "
            f"{', '.join(EXPORTS)}."
        )
    if to not in EXPORTS:
        raise OutputError(
            f"Expected a format to export to, one of {', '.join(EXPORTS)}; got {to}. Choose one of "
            "them."
        )
    suffixes = EXPORTS[to].suffixes
    if output.suffix not in suffixes:
        expected = f"a name in {' or '.join(suffixes)}" if suffixes[0] else "a folder's name"
        raise OutputError(
            f"Expected {expected} for the format {to}; got {output.name}. Give another name."
        )
    return to


@contextmanager
def opened_film(film: xr.Dataset | str | Path, *, where: str = "film") -> Iterator[xr.Dataset]:
    """The film, opened and closed again where it is a file; `where` names the argument."""
    if isinstance(film, xr.Dataset):
        yield take(film, "film", where=where)
        return
    with open_film(film) as opened, reading_film(film):
        yield opened


# Decimals of a position in mm, a picometre.
_DECIMALS = 9


def write_trigger_table(film: xr.Dataset, output: Path) -> None:
    """Write one row for each trigger, with the numbers of `table_columns`.

    Parameters
    ----------
    film : xarray.Dataset
    output : Path
        File to write. Names with units stand in the first row; a number that is not known is NaN.
    """
    columns = table_columns(film)
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
    """Format values as text, numbers with all digits of their type."""
    if values.dtype.kind in "OUST":
        return [str(each) for each in values]
    if values.dtype.kind in "iub":
        return [str(int(each)) for each in values]
    return [("NaN" if each == "nan" else each) for each in values.astype(str).tolist()]
