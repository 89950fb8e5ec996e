"""``erlif simulate``: frames of a known film from the virtual rig."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from erlif.rig.settings import CHOICES, SIDEWAYS, RigSettings

_SIDE = re.compile("[0-9]{1,6}")
"""Digits of one side of a picture; other alphabets have digits that are no numbers."""

DEFAULT = RigSettings()
"""The options show the defaults of the rig itself."""

_SHARE_OUTSIDE = 0.01
"""Of the pixels; turning marks alone leave the wedge in fewer."""


class PictureSize(click.ParamType[tuple[int, int]]):
    """Columns x rows, such as 320x256."""

    name = "WIDTHxHEIGHT"

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[int, int]:
        """Two numbers from the text of the option."""
        if isinstance(value, tuple):
            return value
        width, _, height = str(value).lower().partition("x")
        if not (_SIDE.fullmatch(width) and _SIDE.fullmatch(height)):
            self.fail(
                f"{value!r} is not a picture size; write columns x rows, for example 320x256.",
                param,
                ctx,
            )
        return int(width), int(height)


class SidewaysChoice(click.ParamType["float | str"]):
    """Free, guided, or the stiffness of a spring that holds the pin at right angles to the load."""

    name = "free|guided|N/m"

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> float | str:
        """A number, or the word itself."""
        if value in SIDEWAYS:
            return str(value)
        try:
            return float(str(value))
        except ValueError:
            self.fail(
                f"{value!r} is none of {', '.join(SIDEWAYS)} and no stiffness in N/m, such as "
                "50000.",
                param,
                ctx,
            )


class FilmChoice(click.ParamType["float | str"]):
    """A film at top speed, or the word for the film of theory."""

    name = "UM|reynolds"

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> float | str:
        """A number, or the word itself."""
        if value == "reynolds":
            return "reynolds"
        try:
            return float(str(value))
        except ValueError:
            self.fail(
                f"{value!r} is neither a film in um, such as 6, nor the word reynolds.", param, ctx
            )


@click.command()
@click.argument("out", type=click.Path(path_type=Path, file_okay=False))
@click.option(
    "--seed",
    default=0,
    show_default=True,
    type=click.IntRange(min=0),
    help="Seed of the random numbers; the same seed gives the same files.",
)
@click.option(
    "--size",
    default=f"{DEFAULT.width}x{DEFAULT.height}",
    show_default=True,
    type=PictureSize(),
    help="Columns x rows of both cameras; the field stays 19.2 mm wide.",
)
@click.option(
    "--mechanism",
    default=DEFAULT.mechanism,
    show_default=True,
    type=click.Choice(CHOICES["mechanism"]),
    help="Motion: a linkage, a disc, a slider, or none.",
)
@click.option(
    "--pictures",
    default=DEFAULT.pictures,
    show_default=True,
    help="Frame pairs in a cycle of a disc or slider, or of a static film.",
)
@click.option(
    "--spacing",
    default=DEFAULT.spacing,
    show_default=True,
    help="Rocker angle between two triggers, in degrees.",
)
@click.option(
    "--cycles", default=DEFAULT.cycles, show_default=True, help="Number of turns of the crank."
)
@click.option(
    "--film",
    default=DEFAULT.film_reference,
    show_default=True,
    type=FilmChoice(),
    help="Minimum film thickness at top speed, in um, of a power law; or reynolds, the film that "
    "load and motion produce, which changes from cycle to cycle.",
)
@click.option(
    "--elapsed",
    default=DEFAULT.elapsed,
    show_default=True,
    help="Film reynolds: turns of the crank from loading, with a centred pin, to the first cycle.",
)
@click.option(
    "--sideways",
    default=DEFAULT.sideways,
    show_default=True,
    type=SidewaysChoice(),
    help="Film reynolds: how the pin is held at right angles to the load.",
)
@click.option(
    "--cavitation-pressure",
    default=DEFAULT.cavitation_pressure,
    show_default=True,
    help="Film reynolds: pressure of cavities over the ambient one, in kPa.",
)
@click.option(
    "--mount/--no-mount",
    "write_mount",
    default=True,
    show_default=True,
    help="Film reynolds: write the mount of the pin, the cavitation pressure and the load line "
    "into run.toml.",
)
@click.option("--load", default=DEFAULT.load, show_default=True, help="Mean load, in N.")
@click.option(
    "--viscosity",
    default=DEFAULT.viscosity,
    show_default=True,
    help="Viscosity of the oil, in Pa s.",
)
@click.option(
    "--stated-viscosity",
    default=DEFAULT.stated_viscosity,
    show_default=True,
    help="Viscosity that run.toml states, in Pa s; 0: the true one.",
)
@click.option(
    "--exponent",
    default=DEFAULT.exponent,
    show_default=True,
    help="Exponent of the film thickness over speed/load.",
)
@click.option(
    "--marks",
    default=DEFAULT.marks,
    show_default=True,
    help="Height of the turning marks, rms in um.",
)
@click.option(
    "--bubbles",
    default=DEFAULT.bubbles,
    show_default=True,
    help="Largest number of bubbles in a frame.",
)
@click.option(
    "--light",
    default=DEFAULT.light,
    show_default=True,
    help="Exposure; 1 reaches nearly full scale.",
)
@click.option(
    "--vibration",
    default=DEFAULT.vibration,
    show_default=True,
    help="Vibration of camera 2, rms in pixels.",
)
@click.option(
    "--fixture-frames",
    default=DEFAULT.fixture_frames,
    show_default=True,
    help="Number of frame pairs of the wedge.",
)
@click.option(
    "--cmm-noise",
    default=DEFAULT.cmm_noise,
    show_default=True,
    help="Noise of the measured profile of the wedge, in um.",
)
@click.option(
    "--zero/--no-zero",
    "write_zero",
    default=True,
    show_default=True,
    help="Write the encoder's zero into run.toml.",
)
@click.option(
    "--encoder",
    default=DEFAULT.encoder,
    show_default=True,
    type=click.Choice(CHOICES["encoder"]),
    help="Link that carries the encoder.",
)
@click.option(
    "--reading",
    default=DEFAULT.reading,
    show_default=True,
    type=click.Choice(CHOICES["reading"]),
    help="What the encoder shows; wrapped and ticks start again at 0 within the stroke.",
)
@click.option(
    "--pulses-per-cycle",
    default=DEFAULT.pulses_per_cycle,
    show_default=True,
    help="Frames per turn at even crank angles, 50.89 for example; 0: at marks of the rocker.",
)
@click.option(
    "--log",
    default=DEFAULT.log,
    show_default=True,
    type=click.Choice(CHOICES["log"]),
    help="One row for each of the frames, or a log in time at 10 kHz.",
)
@click.option(
    "--background",
    default=DEFAULT.background,
    show_default=True,
    help="Even light that is not film, over the median light of the run.",
)
@click.option(
    "--background-beam",
    default=DEFAULT.background_beam,
    show_default=True,
    help="The same with the shape of the laser beam.",
)
@click.option(
    "--background-pages",
    default=DEFAULT.background_pages,
    show_default=True,
    help="Frames of the dry joint written for each camera.",
)
@click.option(
    "--bleaching",
    type=(float, float),
    default=DEFAULT.bleaching,
    show_default=True,
    help="Shares of dye 1 and dye 2 that each pulse destroys.",
)
@click.option(
    "--reference",
    default=DEFAULT.reference,
    show_default=True,
    help="Film of a patch that stays the same, in um; 0: none.",
)
@click.option(
    "--plan",
    "planned",
    type=click.Path(path_type=Path),
    help="plan.toml of `erlif plan`: its dyes, filters, light, cameras and films, at rest. Other "
    "options that are given go before it.",
)
@click.option("--overwrite", is_flag=True, help="Replace OUT/fixture, OUT/run and OUT/truth.nc.")
def simulate(
    out: Path,
    seed: int,
    size: tuple[int, int],
    film: float | str,
    planned: Path | None,
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
    from tqdm import tqdm

    from erlif.rig import simulate as photograph

    rig = _rig_of_options(size, film, options)
    if planned is not None:
        from erlif.planning.plan import rig_of

        given = {
            name: getattr(rig, name) for name in _fields_of_options(click.get_current_context())
        }
        rig = replace(rig_of(planned), **given)
    with tqdm(unit="frame", disable=None) as bar:

        def show(what: str, number: int, total: int) -> None:
            if number == 1:
                bar.reset(total)
                bar.set_description(what)
            bar.update()

            # without a terminal there is no bar; one line per piece of work instead
            if bar.disable and number == total:
                click.echo(f"{what}s written: {total}")

        photograph(out, seed=seed, rig=rig, overwrite=overwrite, progress=show)
    click.echo(f"written: {', '.join(str(out / name) for name in ('fixture', 'run', 'truth.nc'))}")
    if note := _note_of_range(out / "truth.nc"):
        click.echo(note, err=True)


def _note_of_range(path: Path) -> str:
    """A sentence where the true film leaves the wedge by more than 1 % of all pixels."""
    import xarray as xr  # at use: the help of the command needs none of it

    outside, thinnest, thickest = 0.0, math.inf, -math.inf
    with xr.open_dataset(path) as truth:
        low, high = float(truth.wedge.min()), float(truth.wedge.max())
        for film in truth.film:  # one trigger in memory
            outside += float(((film < low) | (film > high)).mean()) / truth.sizes["trigger"]
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
