"""The transient prediction of a run: its journal, its motion, and its place in the film."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import ConfigError, ErlifError
from erlif.core.notes import Note, warn
from erlif.io.ingest import Run
from erlif.io.settings import CrankRockerSettings, PredictionOptions, RunSettings
from erlif.models.mechanism import CrankRocker
from erlif.models.reynolds import Journal
from erlif.models.reynolds.full_film import FullFilm
from erlif.pipeline.physics.bore import axial_shape, departure, foundation_of
from erlif.pipeline.physics.given import given_errors
from erlif.pipeline.physics.joint import (
    build_linkage,
    describe_contact,
    describe_joint,
    joint_and_oil,
)
from erlif.pipeline.plane import ObjectPlane
from erlif.prediction import (
    FrameMotion,
    ImageLine,
    follow_motion,
    gap_in_view,
    predict_triggers,
)
from erlif.trend import LubricatedJoint, compare_with_roughness, predict_film, viscosity_at

# Regime whose surfaces keep their shape, as the transient prediction takes them.
_RIGID = "isoviscous-rigid"

# Whose the steady formulas are over a bore with a shape.
_STRAIGHT = "of a straight bore"


class Prediction(NamedTuple):
    """The transient prediction of a run.

    Attributes
    ----------
    triggers : xarray.Dataset
        film_predicted_min, film_predicted_min_std and film_predicted_mean [um], eccentricity [1]
        and attitude [degree], on dim trigger; empty without a prediction.
    frames : xarray.Dataset
        The same and elapsed_cycles [1], on dim frame; empty without a prediction.
    notes : list of Note
        Why there is none, or what limits it.
    """

    triggers: xr.Dataset
    frames: xr.Dataset
    notes: list[Note]


NO_PREDICTION = Prediction(xr.Dataset(), xr.Dataset(), [])


def swings(settings: RunSettings) -> bool:
    """Whether the tables describe a joint whose film can be predicted over the cycle."""
    tables = settings.joint, settings.oil
    return isinstance(settings.mechanism, CrankRockerSettings) and None not in tables


class SwingingJoint(NamedTuple):
    """Speed of the crank, linkage and joint of an oscillating motion.

    Attributes
    ----------
    crank_speed : float
        [rad/s]
    linkage : CrankRocker
    joint : LubricatedJoint
    """

    crank_speed: float
    linkage: CrankRocker
    joint: LubricatedJoint


def swinging_joint(settings: RunSettings, what: str = "the prediction") -> SwingingJoint:
    """The joint of settings that describe one that swings; others are refused by what they lack.

    Parameters
    ----------
    settings : RunSettings
    what : str
        What needs such a joint, for the message.

    Returns
    -------
    SwingingJoint

    Raises
    ------
    ConfigError
    """
    links, joint = settings.mechanism, describe_joint(settings)
    if isinstance(links, CrankRockerSettings) and joint is not None:
        linkage = build_linkage(links)
        assert isinstance(linkage, CrankRocker)
        return SwingingJoint(links.crank_speed, linkage, joint)
    if links is not None and not isinstance(links, CrankRockerSettings):
        raise ConfigError(
            f'Expected [mechanism] of kind "crank-rocker" for {what} of an oscillating joint; this '
            f'run has kind "{links.kind}", of which erlif has none. Use the measured film alone, '
            "or the shapes of erlif.models.reynolds."
        )
    needed = {"mechanism": links, "joint": settings.joint, "oil": settings.oil}
    missing = " and ".join(f"[{name}]" for name, table in needed.items() if table is None)
    raise ConfigError(
        f"Expected [mechanism], [joint] and [oil] for {what} of an oscillating joint; run.toml has "
        f"no {missing}. Add what is missing."
    )


def frames_of_run(run: Run, cycle: xr.Dataset) -> xr.Dataset:
    """Collect the variables of every frame that the prediction needs.

    Parameters
    ----------
    run : Run
    cycle : xarray.Dataset
        As `locate_run` returns it.

    Returns
    -------
    xarray.Dataset
        On dim frame: trigger, cycle, crank_angle [degree], load [N], used (whether the frame was
        measured), and where they are logged time [s] and temperature [degree_Celsius].
    """
    names = [name for name in ("trigger", "cycle", "crank_angle") if name in cycle]
    frames = cycle[names].reset_coords(drop=True)
    for name in ("time", "temperature", "joint_load"):
        if name in run.log:
            frames[name] = ("frame", run.log[name].values)
    if "joint_load" not in frames and run.settings.load is not None:
        frames["joint_load"] = xr.full_like(cycle.trigger, run.settings.load, float)
    used = np.zeros(cycle.sizes["frame"], bool)
    used[list(run.pairs.usable)] = True
    return frames.assign(used=("frame", used))


def build_journal(settings: RunSettings, viscosity: float) -> Journal:
    """The joint of the settings, which have one, with a viscosity [Pa s], for the solver."""
    (joint, oil), options = joint_and_oil(settings), settings.prediction
    rms = float(np.hypot(joint.pin.roughness or 0.0, joint.bushing.roughness or 0.0))
    return Journal(
        pin_radius=joint.pin_radius,
        bushing_radius=joint.bushing_radius,
        length=joint.length,
        viscosity=viscosity,
        pressure_viscosity=oil.pressure_viscosity,
        cavitation_pressure=options.cavitation_pressure,
        long=options.long,
        axial_shape=axial_shape(joint),
        foundation=foundation_of(joint),
        roughness=rms if options.rough else None,
    )


def tabulate_theory(settings: RunSettings) -> None:
    """Make the tables of a squeezed film, which need no frame, before the fits ask for them."""
    if swings(settings):
        FullFilm.of(replace(build_journal(settings, 1.0), foundation=None))


def build_motion(
    settings: RunSettings, frames: xr.Dataset, *, viscosity: float | None = None
) -> FrameMotion:
    """The motion of the joint through its frames; `frames` as `frames_of_run` returns them.

    Without a viscosity [Pa s], that of the settings at the temperatures of the frames is taken.

    Raises
    ------
    ConfigError
        If the settings describe no joint that swings.
    EncoderError
        As `erlif.prediction.follow_motion`.
    """
    crank_speed, linkage, joint = swinging_joint(settings)
    return follow_motion(
        frames,
        linkage,
        crank_speed=crank_speed,
        viscosity=viscosity_at(frames, joint.viscosity) if viscosity is None else viscosity,
        direction=1 if settings.prediction.direction == "along" else -1,
    )


def film_along_sliding(settings: RunSettings, predicted: xr.Dataset, position: Array) -> Array:
    """Predicted film at the places of the image along sliding.

    Parameters
    ----------
    settings : RunSettings
    predicted : xarray.Dataset
        eccentricity [1] and attitude [degree], of triggers, frames, or one of them; the attribute
        load_line [mm] of attitude is where the angles begin.
    position : array, (pixel,)
        Positions of the image along sliding. [mm]

    Returns
    -------
    array, (..., pixel)
        The gap of the radii in [joint]. [um]
    """
    joint = build_journal(settings, 1.0)  # of any viscosity: the gap is that of the radii
    eccentric = predicted["eccentricity"].values * joint.clearance
    angle = np.radians(predicted["attitude"].values)
    place = 1e-3 * (position - float(predicted["attitude"].attrs["load_line"]))
    gap = gap_in_view(eccentric * np.cos(angle), eccentric * np.sin(angle), joint, place)
    return 1e6 * gap


def predict_run(plane: ObjectPlane, film: xr.Dataset, frames: xr.Dataset) -> Prediction:
    """Predict the film of a run.

    Parameters
    ----------
    plane : ObjectPlane
        With the settings of the run.
    film : xarray.Dataset
        film_min and film_min_std (trigger) [um], from which the start film is found unless the
        settings give it; attribute load_line of pin_displacement, unless the settings give it.
    frames : xarray.Dataset
        As `frames_of_run` returns them.

    Returns
    -------
    Prediction

    Raises
    ------
    ErlifError
        If the film cannot be predicted.
    """
    settings, options = plane.settings, plane.settings.prediction
    motion = build_motion(settings, frames)
    line = _load_line(settings, film, plane.along)
    predicted = predict_triggers(
        film,
        build_journal(settings, motion.viscosity),
        motion,
        trigger=frames.trigger.values,
        used=frames.used.values,
        view=ImageLine(1e-3 * (plane.along - line), plane.within, 1e-6 * plane.bore_height),
        sideways=options.sideways if isinstance(options.sideways, str) else float(options.sideways),
        start_film=None if options.start_film == "fit" else float(options.start_film),
        given=given_errors(settings, film, frames),
    )
    names = ["film_predicted_min", "film_predicted_min_std", "film_predicted_mean"]
    names += ["eccentricity", "attitude"]
    by_frame = predicted[[f"{name}_frame" for name in names]]
    by_frame = by_frame.rename({f"{name}_frame": name for name in names})
    for one in (predicted, by_frame):
        one["attitude"].attrs["load_line"] = line
    return Prediction(
        predicted[names], by_frame.assign(elapsed_cycles=predicted.elapsed_cycles), []
    )


def _load_line(settings: RunSettings, film: xr.Dataset, position: Array) -> float:
    """The load line of the settings, else that of the measured positions, else the middle. [mm]"""
    if settings.prediction.load_line is not None:
        return 1e3 * float(settings.prediction.load_line)
    middle = float(position.mean())
    if "pin_displacement" not in film:
        return middle
    return float(film["pin_displacement"].attrs.get("load_line", middle))


def try_prediction(plane: ObjectPlane, film: xr.Dataset, frames: xr.Dataset) -> Prediction:
    """Predict the film of a run where its tables allow it; a failure becomes a note.

    Parameters
    ----------
    plane, film, frames
        As for `predict_run`.

    Returns
    -------
    Prediction
        Without variables where the joint does not swing, or the prediction failed.
    """
    if not swings(plane.settings) or "joint_load" not in frames or "crank_angle" not in frames:
        return NO_PREDICTION
    try:
        return predict_run(plane, film, frames)
    # a measured film is worth more than its prediction, whatever went wrong in the latter
    except (ErlifError, ArithmeticError, ValueError, IndexError) as error:
        return NO_PREDICTION._replace(
            notes=[warn("[prediction]", f"the film over the cycle is not predicted: {error}")]
        )


def predict_theory(settings: RunSettings, film: xr.Dataset) -> xr.Dataset:
    """Films by theory, and the film parameter, as far as tables and log allow.

    Parameters
    ----------
    settings : RunSettings
    film : xarray.Dataset
        On dim trigger.

    Returns
    -------
    xarray.Dataset
        As `erlif.trend.predict_film`; empty without [joint] and [contact].

    Raises
    ------
    ConfigError
        If Vogel's law has no temperature.
    """
    contact = describe_contact(settings)
    if contact is not None and "sliding_speed" in film and "joint_load" in film:
        steady = predict_film(film, contact)
        if settings.joint is not None and settings.joint.bore is not None:
            for name in ("film_hamrock_dowson", "film_theory"):
                steady[name].attrs |= {"formula_error": math.inf, "formula_of": _STRAIGHT}
        return steady
    if not settings.surfaces or "film_min" not in film:
        return xr.Dataset()
    one, other = settings.surfaces
    return compare_with_roughness(film.film_min, one.roughness, other.roughness)


def join_theories(settings: RunSettings, steady: xr.Dataset, predicted: xr.Dataset) -> xr.Dataset:
    """Join steady and transient films of theory, and state why the transient one applies.

    Parameters
    ----------
    settings : RunSettings
    steady : xarray.Dataset
        As `erlif.trend.predict_film` returns it.
    predicted : xarray.Dataset
        The triggers of a `Prediction`.

    Returns
    -------
    xarray.Dataset
        `steady` and `predicted`; the steady films alone without a prediction.
    """
    if "film_theory" not in steady or not predicted:
        return steady

    reason, regime = _why_transient(settings), steady["film_theory"].attrs["regime"]
    both = steady.merge(predicted, combine_attrs="drop_conflicts")
    both["film_predicted_min"].attrs |= {
        "regime": f"transient Reynolds, {describe_sideways(settings.prediction)}",
        "reason": reason,
        "notes": _describe_assumptions(settings, predicted, regime),
    }
    for name in steady.keys() & {"film_theory", "film_theory_central", "film_hamrock_dowson"}:
        both[name].attrs["comment"] = f"steady formula, for reference: {reason}"
    return both


def describe_sideways(options: PredictionOptions) -> str:
    """Describe the sideways support of the pin in words."""
    if isinstance(options.sideways, str):
        return f"pin {options.sideways}" + (" sideways" if options.sideways == "free" else "")
    return f"pin held sideways by {options.sideways * 1e-3:.4g} N/mm"


def _why_transient(settings: RunSettings) -> str:
    """State why a steady formula does not describe this joint."""
    crank_speed, linkage, joint = swinging_joint(settings)
    low, high = linkage.limits()
    swing, stroke = np.degrees(high - low), joint.stroke * 1e3
    return (
        f"the joint swings by {swing:.1f} deg in {np.pi / crank_speed:.3g} s and carries oil "
        f"{stroke:.3g} mm to and fro; a steady formula describes a surface that moves one way for "
        "long"
    )


def _describe_assumptions(settings: RunSettings, predicted: xr.Dataset, regime: str) -> str:
    """List the assumptions of the transient prediction, one per line."""
    attrs, pressure = predicted["film_predicted_min"].attrs, settings.prediction.cavitation_pressure
    departs = departure(settings)
    source = "fitted to the measured minima" if attrs["start_film_fitted"] else "as given"
    lines = [
        f"minimum film of {attrs['start_film']:.3g} um at the first frame, {source}",
        f"round rigid bodies with parallel axes{departs and ', changed by '}{departs}, flooded at "
        f"the unloaded side and at the ends; the film ruptures at {pressure * 1e-3:.3g} kPa",
    ]
    if "deflection" in attrs:
        lines.append(
            f"the liner yields by up to {attrs['deflection']:.2g} um at the thinnest film: the "
            "minimum is that of the deflected wall, mean and map are those of the wall at rest"
        )
    if regime != _RIGID:
        lines.append(
            f"the regime map finds the {regime} regime, in which the surfaces deflect or the oil "
            "thickens: the prediction takes the surfaces as rigid"
        )
    return "\n".join(lines)
