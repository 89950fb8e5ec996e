"""Arguments and options that several commands share."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from erlif.core.errors import ConfigError, OutputError
from erlif.core.units import parse_quantity

Command = TypeVar("Command", bound=Callable[..., Any])

# A file or directory. The stages check whether it exists; their messages reach the user.
PATH = click.Path(path_type=Path)


class QuantityOption(click.ParamType):  # type: ignore[type-arg] # generic since click 8.4 only
    """A number with a unit, such as "51 cm", or one of a few words."""

    def __init__(self, unit: str, name: str, *words: str) -> None:
        self.unit, self.name, self.words = unit, "|".join((name, *words)), words

    def get_metavar(self, param: click.Parameter, ctx: click.Context) -> str:
        """Return the placeholder of the value in the help, without the capitals of click."""
        return self.name

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float | str:
        """The number in the unit of the program, or the word itself."""
        if value in self.words:
            return str(value)
        listed = f", or {' or '.join(self.words)}" if self.words else ""
        try:
            return parse_quantity(value, self.unit)
        except (ConfigError, ValueError) as error:
            self.fail(f"{error}{listed}", param, ctx)


LENGTH, ANGLE = QuantityOption("m", "LENGTH"), QuantityOption("deg", "ANGLE")


def output_option(what: str, default: str) -> Callable[[Command], Command]:
    """``-o``: the path of what a command writes.

    Parameters
    ----------
    what : str
        What stands at the path.
    default : str
        Path without the option, or "none" where nothing is written.
    """
    return click.option(
        "-o",
        "--output",
        type=PATH,
        callback=_expect_folder,
        help=f"{what}; default: {default}.",
    )


def _expect_folder(ctx: click.Context, option: click.Parameter, value: Path | None) -> Path | None:
    """Refuse an output in a folder that does not exist, before all else."""
    from erlif.io.files import expect_folder

    if value is not None:
        expect_folder(value)
    return value


CALIBRATION = click.option(
    "--calibration", type=PATH, help="Default: the calibration that run.toml names."
)

OVERWRITE = click.option("--overwrite", is_flag=True, help="Replace an existing output.")

SKIP_BAD_FRAMES = click.option(
    "--skip-bad-frames",
    is_flag=True,
    help="Leave out frame pairs of which a file is missing or unreadable; the output lists them.",
)

ALLOW_OUTSIDE = click.option(
    "--allow-outside",
    is_flag=True,
    help="Follow links and names of files that leave the directory.",
)


def together(*options: Callable[[Command], Command]) -> Callable[[Command], Command]:
    """Several options as one decorator, in the order of ``--help``."""

    def decorate(command: Command) -> Command:
        # click lists options in the order in which decorators stand, the lowest first
        for option in reversed(options):
            command = option(command)
        return command

    return decorate


# How runs are processed; the pipeline takes these options by the same names.
PROCESSING = together(
    click.option(
        "--workers", type=click.IntRange(min=1), help="Threads; default: one per processor."
    ),
    click.option(
        "--scheduler",
        metavar="ADDRESS",
        help="Workers of dask in place of threads: local:N starts N on this machine; or the "
        "address of a scheduler, such as tcp://HOST:8786, or its scheduler file.",
    ),
    SKIP_BAD_FRAMES,
    ALLOW_OUTSIDE,
    OVERWRITE,
)


def several(
    ctx: click.Context, option: click.Parameter, value: str | None
) -> tuple[str, ...] | None:
    """Split the value of an option at its commas, without repetitions."""
    if value is None:
        return None
    names = [name.strip() for name in value.split(",")]
    return tuple(dict.fromkeys(name for name in names if name))


# A trigger of a film, by its number or by one of its angles.
TRIGGER = together(
    click.option(
        "--trigger",
        type=int,
        help="One trigger; default: each, or the fastest of the outward stroke.",
    ),
    click.option("--crank-angle", type=ANGLE, help='The trigger nearest to it, "90 deg".'),
    click.option("--encoder-angle", type=ANGLE, help="The same by the angle of the log."),
)


def choose_one(film: Path, options: dict[str, Any]) -> tuple[int | None, str]:
    """Take the options of `TRIGGER`: the trigger of a film that they name, and its description.

    None and an empty text where none is given.
    """
    from erlif.io.conversion import choose_trigger
    from erlif.io.files import describe_trigger, open_film

    with open_film(film) as opened:
        # the film is opened in any case: a name that is none is refused before the work starts
        named = {name: options.pop(name) for name in ("trigger", "crank_angle", "encoder_angle")}
        chosen = choose_trigger(opened, **named)
        if chosen is None:
            return None, ""
        return chosen, describe_trigger(opened, chosen)


def expect_suffix(output: Path, *suffixes: str) -> None:
    """Refuse an output name whose suffix belongs to another file format.

    Parameters
    ----------
    output : Path
        Name that the user gave.
    *suffixes : str
        Suffixes of the formats that the command writes, such as ``".nc"``.

    Raises
    ------
    OutputError
        If the name ends in another suffix.
    """
    if output.suffix not in suffixes:
        raise OutputError(
            f"Expected a name in {' or '.join(suffixes)} for the output; got {output.name}. Name "
            "it so with -o."
        )


def expect_output(output: Path, *suffixes: str, overwrite: bool, holds: str = "") -> None:
    """Refuse another suffix, a folder without permission, and what `refuse_existing` refuses."""
    from erlif.io.files import refuse_existing
    from erlif.io.files.replacement import write_error

    expect_suffix(output, *suffixes)
    refuse_existing(output, overwrite=overwrite, holds=holds)
    if output.parent.is_dir() and not os.access(output.parent, os.W_OK):
        raise write_error(output, PermissionError(errno.EACCES, ""))
