"""Variables missing from a film because run.toml lacks a table, or the log a column."""

from __future__ import annotations

from collections.abc import Iterator

import xarray as xr

from erlif.core.notes import Note, remark
from erlif.io.settings import RotationSettings, RunSettings, SinusoidalSettings

_THEORY = ("film_hamrock_dowson", "film_theory")
_POSITION = ("pin_displacement", "pin_tilt", "film_curvature", "film_curvature_axial")
_EXPONENTS = ("speed_exponent", "speed_exponent_mean", "speed_exponent_gap_mean")


def note_omissions(settings: RunSettings, triggers: xr.Dataset) -> list[Note]:
    """Name what is left out of a film for each table that run.toml lacks, and what to add.

    Parameters
    ----------
    settings : RunSettings
    triggers : xarray.Dataset
        The film, or its triggers as `erlif.pipeline.film.describe_triggers` returns them.

    Returns
    -------
    list of Note
        One for each missing table; empty for a run with all of them.
    """
    notes = []
    for table, names, cure in _lacking(settings, triggers):
        absent = ", ".join(name for name in names if name not in triggers)
        if absent:
            notes.append(remark(table, f"{_absent(table, settings)}; left out: {absent}. {cure}"))
    return notes


def _absent(table: str, settings: RunSettings) -> str:
    if not table.startswith("column"):
        return "run.toml has no such table"
    logged = settings.encoder is not None and settings.encoder.file is not None
    return "the log has none" if logged else "there is no log"


def _lacking(
    settings: RunSettings, triggers: xr.Dataset
) -> Iterator[tuple[str, tuple[str, ...], str]]:
    """Yield each missing table, the variables that need it, and the remedy."""
    moving = "sliding_speed" in triggers or "rocker_speed" in triggers
    if settings.mechanism is None and not moving:
        theory = _THEORY if settings.surfaces else ()
        motion = ("stroke", "crank_angle", "sliding_speed", *theory, *_EXPONENTS)
        cure = (
            "A static film needs none; for a film in motion add [mechanism], or a column of the "
            "sliding speed to the log."
        )
        yield "[mechanism]", motion, cure
    elif settings.linkage is None and "encoder_angle" not in triggers:
        cure = "Add it where the angle is to be known."
        yield "column angle_deg", ("encoder_angle", "crank_angle"), cure

    if "joint_load" not in triggers and moving:
        # these hold a load of their own
        driven = isinstance(settings.mechanism, RotationSettings | SinusoidalSettings)
        tables = "[mechanism]" if driven else "[contact]" if settings.contact else "[joint]"
        cure = f'Add the column to the log, or load = "20 N" to {tables}.'
        yield "column load_N", ("joint_load", *_EXPONENTS), cure

    if not settings.surfaces:
        speed = ("sliding_speed",) if settings.linkage is not None else ()
        theory = _THEORY if moving else ()
        cure = "Add [joint] for a pin in a bushing, or [contact] for a ball, barrel or roller."
        yield "[joint]", (*speed, *theory, "film_parameter", *_POSITION), cure
    elif settings.contact is not None and moving and "sliding_speed" not in triggers:
        cure = "Log the speed: the joint of this linkage has another one than the contact."
        yield "column of the sliding speed", ("sliding_speed", *_THEORY), cure
    elif settings.oil is None and moving:
        yield "[oil]", _THEORY, "Add [oil] for the theory."
