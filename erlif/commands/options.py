"""Arguments and options that several commands share."""

from __future__ import annotations

from pathlib import Path

import click

from erlif.core.errors import OutputError

PATH = click.Path(path_type=Path)
"""A file or directory. The stages check whether it exists; their messages reach the user."""

OVERWRITE = click.option("--overwrite", is_flag=True, help="Replace an existing output.")

WORKERS = click.option(
    "--workers", type=click.IntRange(min=1), help="Threads; default: one per processor."
)

SCHEDULER = click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Workers of dask in place of threads: local:N starts N on this machine; or the address of "
    "a scheduler, such as tcp://HOST:8786, or its scheduler file.",
)

SKIP_BAD_FRAMES = click.option(
    "--skip-bad-frames",
    is_flag=True,
    help="Leave out unreadable frame pairs; the output lists them.",
)

ALLOW_OUTSIDE = click.option(
    "--allow-outside",
    is_flag=True,
    help="Follow links and names of files that leave the directory.",
)


def several(
    ctx: click.Context, option: click.Parameter, value: str | None
) -> tuple[str, ...] | None:
    """Split the value of an option at its commas, without repetitions."""
    if value is None:
        return None
    names = [name.strip() for name in value.split(",")]
    return tuple(dict.fromkeys(name for name in names if name))


def expect_suffix(output: Path, *suffixes: str, option: str = "-o") -> None:
    """Refuse an output name whose suffix belongs to another file format.

    Parameters
    ----------
    output : Path
        Name that the user gave.
    *suffixes : str
        Suffixes of the formats that the command writes, such as ``".nc"``.
    option : str
        Option of the command that names the output.

    Raises
    ------
    OutputError
        If the name ends in another suffix.
    """
    if output.suffix not in suffixes:
        raise OutputError(
            f"Expected a name in {' or '.join(suffixes)} for the output; got {output.name}. "
            f"Name it so with {option}."
        )
