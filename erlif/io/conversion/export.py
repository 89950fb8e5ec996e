"""A film written in the format of another program."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from erlif.core.errors import OutputError
from erlif.core.progress import Progress, silent
from erlif.io.conversion.contents import choose_trigger
from erlif.io.conversion.matlab import write_matlab
from erlif.io.conversion.stack import write_stack
from erlif.io.conversion.table import write_map_table, write_trigger_table
from erlif.io.conversion.vtk_xml import write_series
from erlif.io.files import open_film, reading_film, refuse_existing, replacing, take


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
    with _opened(film) as source:
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
def _opened(film: xr.Dataset | str | Path) -> Iterator[xr.Dataset]:
    """The film, opened and closed again where it is a file."""
    if isinstance(film, xr.Dataset):
        yield take(film, "film", where="film")
        return
    with open_film(film) as opened, reading_film(film):
        yield opened
