"""``erlif simulate``: frames of a known film from the virtual rig."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from erlif.commands.lines import verbosity
from erlif.commands.options import PATH, Command, QuantityOption, together
from erlif.commands.progress import show_progress
from erlif.core.speed.imports import large_imports
from erlif.core.tables import read_table
from erlif.rig.settings import CHOICES, SIDEWAYS, RigSettings, read_rig_settings

# Digits of one side of a picture; other alphabets have digits that are no numbers.
_SIDE = re.compile("[0-9]{1,6}")

# The options show the defaults of the rig itself.
DEFAULT = RigSettings()

# Time between the directory and its first frame, in which `erlif watch` is started. [s]
_DELAY = 10.0

# Of the pixels; turning marks alone leave the wedge in fewer.
_SHARE_OUTSIDE = 0.01


def _picture_size(ctx: click.Context, option: click.Parameter, value: str) -> tuple[int, int]:
    """Read columns and rows of a picture, "320x256"."""
    width, _, height = value.lower().partition("x")
    if not (_SIDE.fullmatch(width) and _SIDE.fullmatch(height)):
        raise click.BadParameter(
            f"{value!r} is not a picture size; write columns x rows, for example 320x256."
        )
    return int(width), int(height)


# Help of the options that are settings of the rig, in the order of `--help`.
RIG_OPTIONS: dict[str, str] = read_table("erlif.commands", "simulate.toml")

# Types that do not follow from default or choice.
_TYPES: dict[str, Any] = {
    "spacing": QuantityOption("deg", "ANGLE"),
    "film": QuantityOption("um", "LENGTH", "reynolds"),
    "sideways": QuantityOption("N/m", "STIFFNESS", *SIDEWAYS),
    "cavitation_pressure": QuantityOption("kPa", "PRESSURE"),
    "load": QuantityOption("N", "LOAD"),
    "viscosity": QuantityOption("Pa s", "VISCOSITY"),
    "stated_viscosity": QuantityOption("Pa s", "VISCOSITY"),
    "marks": QuantityOption("um", "LENGTH"),
    "cmm_noise": QuantityOption("um", "LENGTH"),
    "reference": QuantityOption("um", "LENGTH"),
    "bleaching": (float, float),
}


def _rig_option(name: str, text: str) -> Callable[[Command], Command]:
    """The option of a setting of the rig, with its default and its choices."""
    default = DEFAULT.film_reference if name == "film" else getattr(DEFAULT, name)
    # without a type click takes that of the default
    kind = _TYPES.get(name) or (click.Choice(CHOICES[name]) if name in CHOICES else None)
    flag = "--" + name.removeprefix("write_").replace("_", "-")
    if isinstance(kind, QuantityOption) and not isinstance(default, str):
        default = f"{default:.6g} {kind.unit}"
    if isinstance(default, bool):
        flag += flag.replace("--", "/--no-")
    return click.option(flag, name, default=default, show_default=True, type=kind, help=text)


# Options that help lists; with ``-v`` it lists all.
_COMMON = (
    *("seed", "size", "mechanism", "pictures", "spacing", "cycles", "film", "load", "viscosity"),
    *("planned", "stated", "live", "faults", "overwrite", "verbose"),
)


class _ShortHelp(click.Command):
    """A command of many options, of which help lists the common ones."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options into the help."""
        options = [each for each in self.get_params(ctx) if isinstance(each, click.Option)]
        common = [each for each in options if each.name in _COMMON or "--help" in each.opts]
        shown = options if verbosity() else common
        records = [record for each in shown if (record := each.get_help_record(ctx))]
        with formatter.section("Options"):
            formatter.write_dl(records)
        if left := len(options) - len(shown):
            formatter.write_paragraph()
            formatter.write_text(f"{left} more options: erlif -v {self.name} --help")


@click.command(cls=_ShortHelp)
@click.argument("out", type=click.Path(path_type=Path, file_okay=False))
@click.option(
    "--seed",
    default=0,
    show_default=True,
    type=click.IntRange(min=0),
    help="Random seed.",
)
@click.option(
    "--size",
    default=f"{DEFAULT.width}x{DEFAULT.height}",
    show_default=True,
    callback=_picture_size,
    metavar="WIDTHXHEIGHT",
    help="Columns x rows of both cameras; the field stays 19.2 mm wide.",
)
@together(*(_rig_option(*each) for each in RIG_OPTIONS.items()))
@click.option(
    "--parts",
    "planned",
    type=PATH,
    help="plan.toml of erlif plan, at rest. Options take precedence.",
)
@click.option(
    "--settings",
    "stated",
    type=PATH,
    help="Further settings (docs/simulator.md). Options take precedence.",
)
@click.option(
    "--live",
    type=QuantityOption("Hz", "RATE"),
    help='Write frames in real time, such as "10 Hz".',
)
@click.option(
    "--fault",
    "faults",
    metavar="FAULT@FRAME",
    multiple=True,
    help="With --live, such as camera2-stops@40.",
)
@click.option("--overwrite", is_flag=True, help="Replace fixture, run and truth.nc in OUT.")
def simulate(
    out: Path,
    seed: int,
    size: tuple[int, int],
    film: float | str,
    planned: Path | None,
    stated: Path | None,
    live: float | None,
    faults: tuple[str, ...],
    overwrite: bool,
    **options: Any,
) -> None:
    """Photograph a known film with a virtual rig.

    Writes OUT/fixture and OUT/run in the format of the laboratory, and OUT/truth.nc with the true
    film thickness.

    \b
    Example:
      erlif simulate rehearsal --size 320x256 --seed 7
      erlif calibrate rehearsal/fixture
      erlif process rehearsal/run
    """
    with large_imports():
        from erlif.rig import simulate as photograph
        from erlif.rig.live import Fault, write_live

    planned_faults = [Fault.read(text) for text in faults]
    rig = _rig_of_options(size, film, options)
    given = {name: getattr(rig, name) for name in _fields_of_options(click.get_current_context())}
    if planned is not None:
        from erlif.planning.plan import rig_of

        # plan and file of settings decide what no option states
        rig = replace(rig_of(planned), **given)
    if stated is not None:
        rig = replace(rig, **read_rig_settings(stated) | given)
    with show_progress(lines=False) as progress:

        def show(what: str, number: int, total: int) -> None:
            progress(what, number, total)
            # without a terminal there is no bar; one line per piece of work instead
            if number == total and not sys.stderr.isatty():
                click.echo(f"{what}s written: {total}")

        photograph(out, seed=seed, rig=rig, overwrite=overwrite, progress=show)
    click.echo(f"written: {', '.join(str(out / name) for name in ('fixture', 'run', 'truth.nc'))}")
    if live is not None:  # at once: a watch that waits for the run takes no frame as arrived
        click.echo(
            f"recording starts in {_DELAY:g} s; in another terminal: erlif watch {out / 'run'}"
        )
        with show_progress() as progress:
            write_live(
                out / "run",
                rate=live,
                gain=rig.gain,
                read_noise=rig.read_noise,
                faults=planned_faults,
                delay=_DELAY,
                progress=progress,
            )
    if note := _note_of_range(out / "truth.nc"):
        click.echo(note, err=True)


def _note_of_range(path: Path) -> str:
    """Note that over 1 % of the true film lies outside the wedge; empty where it does not."""
    import xarray as xr  # at use: the help of the command needs none of it

    outside, thinnest, thickest = 0.0, math.inf, -math.inf
    with xr.open_dataset(path) as truth:
        low, high = float(truth.wedge.min()), float(truth.wedge.max())
        for film in truth.film:  # one trigger in memory
            outside += float(((film < low) | (film > high)).mean()) / len(truth.film)
            thinnest, thickest = min(thinnest, float(film.min())), max(thickest, float(film.max()))
    if outside <= _SHARE_OUTSIDE:
        return ""
    return (
        f"Note: {100 * outside:.0f} % of the true film ({thinnest:.3g} to {thickest:.3g} um) "
        f"lies outside the wedge of the fixture ({low:.3g} to {high:.3g} um); "
        "erlif process marks it as out of range. Choose another --film, --viscosity, --load or "
        "--elapsed to stay inside."
    )


def _rig_of_options(
    size: tuple[int, int], film: float | str, options: dict[str, Any]
) -> RigSettings:
    """The rig as the options have it, each the field of its name."""
    theory = film == "reynolds"
    return RigSettings(
        width=size[0],
        height=size[1],
        film="reynolds" if theory else "law",
        film_reference=DEFAULT.film_reference if theory else float(film),
        tilt=0.0 if theory else DEFAULT.tilt,
        **options,
    )


def _fields_of_options(context: click.Context) -> Iterator[str]:
    """Settings of the rig that the user changed by an option."""
    fields = {"size": ("width", "height"), "film": ("film", "film_reference", "tilt")}
    for option in context.params:
        given = context.get_parameter_source(option) == ParameterSource.COMMANDLINE
        if given and (option in fields or hasattr(DEFAULT, option)):
            yield from fields.get(option, (option,))
