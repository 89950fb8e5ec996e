"""The pressure of the film of a run, from the measured positions of its pin."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.calibration import calibration_of
from erlif.core.arrays import Array, Mask
from erlif.core.errors import ConfigError, ModelError
from erlif.core.format import describe_origin
from erlif.core.progress import Progress, ShowProgress, choose_progress
from erlif.core.variables import PRESSURE
from erlif.io.files import open_film, set_coordinates, settings_of, take
from erlif.io.settings import RunSettings
from erlif.models.contact import conformal_radius
from erlif.pipeline.physics.joint import joint_and_oil
from erlif.pipeline.physics.prediction import (
    build_journal,
    build_motion,
    describe_sideways,
    swinging_joint,
)
from erlif.pipeline.plane import ObjectPlane
from erlif.prediction.fit import LOAD_LINE_STD
from erlif.prediction.gaps import LARGEST_GAP, MOST_FILLED, find_motion_in_gaps
from erlif.prediction.pin_motion import FEWEST, PinMotion, find_pin_motion
from erlif.prediction.pressure import CHANGING, CLEAR, RESTING, find_pressures
from erlif.trend import PinView, load_line_covariance, viscosity_at

# Places along sliding and along the axis at which the pressure is given.
GRID = (48, 12)

# Share of recordings whose load counts as not balanced by chance. It is divided between three
# tests: the median, the sum over all triggers, and the single trigger.
FALSE_ALARM = 0.05

_MICRO, _MILLI, _KILO = 1e6, 1e3, 1e-3
# Factors from SI to the units of the file.
_SCALES = {"kPa": _KILO, "mm": _MILLI}

_NUMBER_UNITS = np.array([1e-6, 1e-6, 1e-3, 1e-3])  # of a position in SI: um, and um/mm


def pressure_from_film(
    film: xr.Dataset | str | Path, *, progress: ShowProgress = None
) -> xr.Dataset:
    """Find the pressure in the film of an oscillating joint from the measured film and its rate.

    The position of the pin is measured at each trigger, its rate by a smooth path through the
    positions. The Reynolds equation gives the pressure of this film. No load is put in: the load
    that the pressure makes is compared with the logged one.

    Parameters
    ----------
    film : xarray.Dataset or path
        As `erlif.process` returns it, of a crank-rocker with [joint] and [oil].
    progress : "bar", bool or callable, optional
        As for `erlif.process`.

    Returns
    -------
    xarray.Dataset
        pressure and pressure_std (trigger, y, x) and pressure_profile and pressure_profile_std
        (trigger, place) [kPa]; by trigger peak_pressure [kPa], its place peak_place [mm] along
        sliding, load_from_pressure and side_from_pressure [N], each with its _std;
        peak_std_random, peak_std_shared and peak_std_settings [kPa], by noise, by errors that all
        triggers share, and by viscosity and clearance; peak_by_viscosity and peak_by_clearance [1];
        load_cov (trigger, trigger_other) [N2]; pressure_measured and pressure_solved, 1 or 0;
        film_rate and film_rate_std [um s-1] at the load line; cavity and cavity_change [1]; load
        [N]. NaN where the pressure is not known. Attributes: statement, what the pressure is good
        for and what would make it better; balance, the load in comparison; given, whether errors of
        viscosity and clearance are part of the stated ones.

    Raises
    ------
    ErlifError
        If the film is of another joint or too few triggers have a position.

    Examples
    --------
    >>> found = pressure_from_film("film.nc")  # doctest: +SKIP
    >>> found.attrs["statement"]  # doctest: +SKIP
    """
    report = choose_progress(progress)
    if isinstance(film, str | Path):
        with open_film(film) as source:
            return _find_pressure(source, report)
    return _find_pressure(take(film, "film", where="film"), report)


def _find_pressure(film: xr.Dataset, progress: Progress) -> xr.Dataset:
    """The pressure of an open film."""
    settings = settings_of(film)
    if settings.joint is not None and settings.joint.liner is not None:
        raise ConfigError(
            "Expected a rigid bushing for the pressure of the measured pin, whose position "
            "includes the yield of a liner; run.toml has liner in [joint]. Use erlif predict."
        )
    view = _view(film, settings)
    known = _known(film)
    positions = _follow_pin(film, settings, known)
    motion = find_pin_motion(
        positions.time,
        positions.angle,
        positions.turning,
        positions.value,
        period=positions.period,
        **positions.errors,
    )
    joint = swinging_joint(settings).joint
    conditions = film[[name for name in ("crank_angle", "temperature") if name in film]].load()
    viscosity = viscosity_at(conditions, joint.viscosity)[positions.order]
    x, y = _image_grid(film)
    line = settings.prediction.load_line_std
    if line is None:
        line = film.pin_displacement.attrs.get("load_line_std", 0.0) / _MILLI
    along, across = (x, y) if view.sliding_along_x else (y, x)
    pressures = find_pressures(
        build_journal(settings, 1.0),
        motion,
        viscosity=viscosity,
        place=(along - view.load_line) / _MILLI,
        axial=(across - view.axial_origin) / _MILLI,
        settings_std=_settings_std(settings, viscosity),
        load_line_std=float(line),
        fill=partial(_fill_motion, film, settings, positions),
        progress=progress,
    )
    return _pressure_by_trigger(film, settings, view, pressures, motion, positions.order, (x, y))


def _settings_std(settings: RunSettings, viscosity: Array) -> tuple[float, float]:
    """Standard deviations of viscosity and clearance over their values; 0 where none is stated."""
    joint, oil = joint_and_oil(settings)
    clearance = joint.bushing_radius - joint.pin_radius
    return (
        float(oil.viscosity_std or 0.0) / float(np.mean(viscosity)),
        float(joint.clearance_std or 0.0) / clearance,
    )


def _view(film: xr.Dataset, settings: RunSettings) -> PinView:
    """The joint as the camera sees it; a film of another kind of joint is refused."""
    swinging_joint(settings, "the pressure")
    view = ObjectPlane(settings, (film.sizes["y"], film.sizes["x"])).view
    if view is None or "pin_displacement" not in film:
        raise ConfigError(
            "Expected the position of the pin in the film; there is none, because the image is "
            "wider than half a turn of the pin. Make the film again with: erlif process RUN_DIR"
        )
    line = film.pin_displacement.attrs.get("load_line", view.load_line)
    return replace(view, load_line=float(line))


def _known(film: xr.Dataset) -> Mask:
    """Triggers with a position; too few are refused."""
    cov = film.pin_position_cov.values
    known = np.isfinite(film.pin_displacement.values).all(axis=1)
    known = np.asarray(known & np.isfinite(cov).all(axis=(1, 2)))
    if known.sum() < FEWEST:
        raise ModelError(
            f"Expected {FEWEST} or more triggers with a position of the pin, got {known.sum()} of "
            f"{known.size}: the rate of the film, which makes the pressure, is not known from "
            "fewer. Record the joint over its cycle."
        )
    return known


class _Positions(NamedTuple):
    """Positions of the pin at the triggers that have one, in SI and in the order of their times.

    Attributes
    ----------
    order : numpy.ndarray
        Triggers, (position,).
    time, angle, turning : Array
        As for `find_pin_motion`, (position,).
    value : Array
        (position, number)
    errors : dict
        random_cov, surface_cov, gradient and calibration_cov, as for `find_pin_motion`.
    period : float
        Of a turn. [s]
    """

    order: npt.NDArray[np.intp]
    time: Array
    angle: Array
    turning: Array
    value: Array
    errors: dict[str, Any]
    period: float


def _follow_pin(film: xr.Dataset, settings: RunSettings, known: Mask) -> _Positions:
    """Positions of the pin, and the motion of the bushing."""
    frames = xr.Dataset(
        {
            "crank_angle": ("frame", film.crank_angle.values),
            "cycle": ("frame", np.zeros(known.size, np.int64)),
            "joint_load": ("frame", np.ones(known.size)),  # moves nothing here
        }
    )
    if "time" in film:
        frames["time"] = ("frame", film["time"].values)
    moved = build_motion(settings, frames, viscosity=1.0)  # pressure is in proportion to it
    time, angle = moved.motion.time[moved.steps], np.asarray(moved.motion.angle)[moved.steps]
    turning = _turning(settings, moved.motion.time, moved.crank)[moved.steps]

    order = np.flatnonzero(known)
    order = order[np.argsort(time[order], kind="stable")]
    random, surface, gradient = _covariances(film, order)
    position = np.concatenate([film.pin_displacement.values, film.pin_tilt.values], axis=1)
    errors = {"random_cov": random, "surface_cov": surface, "gradient": gradient}
    return _Positions(
        order,
        time[order],
        angle[order],
        turning[order],
        position[order] * _NUMBER_UNITS,
        errors | {"calibration_cov": calibration_of(film).full_covariance},
        2 * np.pi * float(np.ptp(moved.motion.time) / np.ptp(moved.crank)),
    )


def _turning(settings: RunSettings, time: Array, crank: Array) -> Array:
    """Speed of the bushing along sliding at the steps of a motion. [rad/s]"""
    speed = np.gradient(crank, time)
    linkage = swinging_joint(settings).linkage
    turning = np.asarray(linkage.rocker_speed(crank, crank_speed=speed))
    return turning if settings.prediction.direction == "along" else -turning


def _loads(film: xr.Dataset, settings: RunSettings) -> Array:
    """Load at each trigger, logged or stated; NaN where it is neither. [N]"""
    if "joint_load" in film:
        return np.asarray(film["joint_load"].values, float)
    return np.full(film.sizes["trigger"], settings.load or np.nan)


def _fill_motion(film: xr.Dataset, settings: RunSettings, at: _Positions) -> PinMotion | None:
    """The motion of a guided pin through the gaps of its triggers; None without a known load."""
    load = _loads(film, settings)
    if not np.isfinite(load[at.order]).all():
        return None

    # one turn, closed by its first trigger
    once = np.append(at.order, at.order[0])
    time = np.append(at.time, at.time[0] + at.period)
    columns = {name: film[name].values for name in ("crank_angle", "temperature") if name in film}
    columns |= {"cycle": np.zeros(load.size, np.int64), "joint_load": load}
    frames = xr.Dataset({name: ("frame", values[once]) for name, values in columns.items()})
    moved = build_motion(settings, frames.assign(time=("frame", time)))
    options = settings.prediction
    line = float(options.load_line_std or 0.1 * LOAD_LINE_STD)
    return find_motion_in_gaps(
        build_journal(settings, moved.viscosity),
        moved,
        time=time,
        turning=at.turning,
        position=at.value,
        load_line_std=None if options.load_line is None else line,
        **at.errors,
    )


def _covariances(film: xr.Dataset, order: npt.NDArray[np.intp]) -> tuple[Array, Array, Array]:
    """Covariance by noise and by surfaces, and change with the calibration, in SI."""
    units = _NUMBER_UNITS * _NUMBER_UNITS[:, None]
    whole, random = (
        film[name].values[order] * units for name in ("pin_position_cov", "pin_position_cov_random")
    )
    gradient = film.pin_position_gradient.values[order] * _NUMBER_UNITS[:, None]
    shared = gradient @ calibration_of(film).full_covariance @ np.swapaxes(gradient, 1, 2)
    # the error of the load line turns the position and changes no film
    by_line = load_line_covariance(film)[order] * units
    return random, whole - random - shared - by_line, gradient


def _image_grid(film: xr.Dataset) -> tuple[Array, Array]:
    """Places of the image at which the pressure is given, x and y. [mm]"""
    along_x = settings_of(film).optics.x_axis == "sliding"
    counts = GRID if along_x else GRID[::-1]
    x, y = (
        np.linspace(float(film[name][0]), float(film[name][-1]), min(count, film.sizes[name]))
        for name, count in zip(("x", "y"), counts, strict=True)
    )
    return x, y


def _pressure_by_trigger(
    film: xr.Dataset,
    settings: RunSettings,
    view: PinView,
    pressures: xr.Dataset,
    motion: PinMotion,
    order: npt.NDArray[np.intp],
    grid: tuple[Array, Array],
) -> xr.Dataset:
    """The pressure in the units of the laboratory, by all triggers of the film."""
    total = film.sizes["trigger"]

    def spread(values: Array) -> Array:
        filled = np.full((total, *values.shape[1:]), np.nan)
        filled[order] = values
        return filled

    columns: dict[str, Array] = {}
    for name in [name for name in PRESSURE if name in pressures.data_vars and name != "load_cov"]:
        values = spread(pressures[name].values.astype(float)) * _SCALES.get(
            PRESSURE[name].units, 1.0
        )
        turned = values.ndim == 3 and not view.sliding_along_x
        columns[name] = np.swapaxes(values, 1, 2) if turned else values
    columns["peak_place"] += view.load_line
    columns["load_cov"] = np.full((total, total), np.nan)
    columns["load_cov"][np.ix_(order, order)] = pressures["load_cov"].values
    columns["pressure_measured"][np.isnan(columns["pressure_measured"])] = 0
    columns["pressure_solved"][np.isnan(columns["pressure_solved"])] = 1

    rate = -motion.rate[:, 0] * _MICRO
    rate_std = np.sqrt((motion.random_cov + motion.shared_cov)[:, 4, 4]) * _MICRO
    columns["film_rate"], columns["film_rate_std"] = spread(rate), spread(rate_std)
    load = _loads(film, settings)
    radius = float(conformal_radius(view.pin_radius, bushing_radius=view.bushing_radius))
    thinnest = spread(view.least_clearance - np.hypot(*motion.position[:, :2].T) * _MICRO) / _MICRO
    reach = np.sqrt(2 * radius * np.maximum(thinnest, 0.0))
    length = joint_and_oil(settings)[0].length
    columns["peak_of_load"] = _KILO * load / (length * 0.5 * np.pi * reach)
    columns["joint_load"] = load

    x, y = grid
    places = {"x": x, "y": y, "place": x if view.sliding_along_x else y}
    result = xr.Dataset(
        {name: PRESSURE[name].fill(values) for name, values in columns.items()},
        {name: PRESSURE[name].fill(values) for name, values in places.items()},
    ).assign_coords(trigger=film["trigger"].variable)
    of_motion = {name: film[name].variable for name in ("encoder_angle", "crank_angle", "stroke")}
    result = set_coordinates(result.assign(of_motion))
    # name the mount
    kept = ("settings", "settings_version", "settings_stated")
    result.attrs.update({name: film.attrs[name] for name in kept if name in film.attrs})
    return result.assign_attrs(
        **describe_origin(f"pressure from the film, {settings.name}", f"pressure {settings.name}"),
        film_identity=str(film.attrs.get("identity", "")),
        statement=state_limits(result),
        balance=state_balance(result),
        given=state_given(result),
    )


def state_given(pressure: xr.Dataset) -> str:
    """State which errors of viscosity and clearance the pressure includes; as `state_limits`."""
    joint, oil = joint_and_oil(settings_of(pressure))
    given = (
        ("viscosity", float(oil.viscosity_std or 0.0), "Pa s", "oil"),
        ("clearance", _MICRO * float(joint.clearance_std or 0.0), "um", "joint"),
    )
    stated = [f"{name} ± {std:.2g} {unit} ([{table}])" for name, std, unit, table in given if std]
    absent = {name: f"{name}_std in [{table}]" for name, std, _, table in given if not std}
    lines = []
    if stated:
        lines.append(f"The errors hold those of {' and '.join(stated)}.")
    if absent:
        it = "it" if len(absent) == 1 else "them"
        lines.append(
            f"The pressure is that of the given {' and '.join(absent)}, without an error of {it}; "
            f"{' and '.join(absent.values())} would be part of it."
        )

    # the peak moves with both, whether or not an error is stated
    changes = pressure.peak_by_viscosity.values, pressure.peak_by_clearance.values
    if all(np.isfinite(change).any() for change in changes):
        viscosity, clearance = (float(np.nanmedian(change)) for change in changes)
        lines.append(
            f"One per cent more viscosity changes the peak by {viscosity:+.2g} %, one per cent "
            f"more clearance by {clearance:+.2g} % (medians)."
        )
    return " ".join(lines)


def state_limits(pressure: xr.Dataset) -> str:
    """State in words at which triggers the pressure is measured, and what limits the others.

    Parameters
    ----------
    pressure : xarray.Dataset
        From `pressure_from_film`.

    Returns
    -------
    str
    """
    measured = pressure.pressure_measured.values > 0
    count, total = int(measured.sum()), measured.size
    std, peak = pressure.peak_pressure_std.values, pressure.peak_pressure.values
    lines = []
    if count:
        share = 100 * np.median(std[measured] / peak[measured])
        lines.append(
            f"The pressure is measured at {count} of {total} triggers, its peak to {share:.1f} % "
            "(median standard deviation)."
        )
    quick = pressure.cavity_change.values > CHANGING
    closing = ~measured & (quick | np.roll(quick, 1) | np.roll(quick, -1))
    if closing.any():
        lines.append(
            f"Cavities close or open at {closing.sum()} triggers or beside them "
            f"({_list_triggers(closing)}), where the film changes more quickly than a smooth path "
            "can follow: no pressure there. More triggers in a cycle would help."
        )
    history = pressure.cavity_history.values
    rate, error = pressure.film_rate.values, pressure.film_rate_std.values
    if not count and np.nanmax(np.abs(rate) / error) < RESTING:
        return (
            "The film is at rest within its errors, and no pressure follows from it: it changes by "
            f"{np.nanmedian(np.abs(rate)):.2g} um/s, known to ± {np.nanmedian(error):.2g} um/s. "
            "Record from the moment of loading on, more cycles, or with more light."
        )
    if np.isinf(history).any():
        return (
            "The film has cavities, whose extent depends on the motion before, and no trigger was "
            f"recorded over {100 * LARGEST_GAP:.0f} % or more of a turn of the crank. The motion "
            f"of a guided pin under the logged load fills up to {100 * MOST_FILLED:.0f} % where it "
            "describes the film; here the gap is longer, the load is not known (load in [joint]), "
            "or it does not (load_line in [prediction] narrows it): no pressure. Record the joint "
            "over its cycle, with triggers that are even in time or crank angle; marks of the "
            "rocker leave gaps at its dead points."
        )
    old = ~measured & ~closing & (history > CLEAR)
    if old.any():
        lines.append(
            f"Cavities at {old.sum()} triggers ({_list_triggers(old)}) are older than the "
            "recording, and the pin sinks in it: no pressure there. Record a later turn, or the "
            "turn before as well."
        )
    unsolved = pressure.pressure_solved.values == 0
    if unsolved.any():
        lines.append(
            f"At {unsolved.sum()} triggers ({_list_triggers(unsolved)}) no oil can follow the "
            "measured film: it opens, closes or jumps in a way for which the Reynolds equation has "
            "no solution. No pressure there. erlif predict FILM --fit states whether any theory "
            "describes this film; check load, clearance and the times of the frames."
        )
    refused = ~measured & ~closing & ~old & ~unsolved
    if refused.any():
        lines.append(
            f"No pressure is known at {refused.sum()} triggers ({_list_triggers(refused)}): "
            f"{_state_refusal(pressure.isel(trigger=refused))}"
        )
    return " ".join(lines)


def _list_triggers(which: Mask) -> str:
    """The first eight triggers of a kind."""
    names = [str(k) for k in np.flatnonzero(which)]
    return ", ".join(names[:8] + ["..."] * (len(names) > 8))


def _state_refusal(refused: xr.Dataset) -> str:
    """State why the pressure is unknown at these triggers, and the remedy."""
    random, shared, settings = (
        refused[f"peak_std_{name}"].values for name in ("random", "shared", "settings")
    )
    if not np.isfinite(random).any():
        return (
            "the gap that continues the image closes within the error of its tilt, or no position "
            "was measured. A wider roi in [thickness] along the axis or more light would help."
        )

    # the peak that the load makes is what has to be resolved
    goal = (CLEAR * refused.peak_of_load.values) ** 2 - shared**2 - settings**2
    if (goal > 0).any():
        factor = float(np.nanmedian((random**2 / goal)[goal > 0]))
        cure = (
            f"It needs at least {factor:.2g} times the light, or as many times the cycles or the "
            "triggers in a cycle; the path through the positions is as smooth already as they "
            "allow."
            if factor > 1
            else "Noise is not the reason, as the peak of a film that carries the load would "
            "exceed it: this film does not close as one under its load. erlif predict FILM --fit "
            "states whether any theory describes it."
        )
    else:
        by_settings = np.nanmedian(settings) > np.nanmedian(shared)
        given = "smaller viscosity_std in [oil] and clearance_std in [joint] do"
        helps = given if by_settings else "a better calibration does"
        cure = (
            "Errors that all triggers share, those of calibration, surfaces, viscosity and "
            f"clearance, are too large by themselves: more light or cycles do not help, {helps}."
        )
    return (
        f"the film changes by {np.nanmedian(np.abs(refused.film_rate)):.2g} um/s there, known to ± "
        f"{np.nanmedian(refused.film_rate_std):.2g} um/s, and the standard deviation of the peak "
        f"is above {100 * CLEAR:.0f} % of it. {cure}"
    )


def state_balance(pressure: xr.Dataset) -> str:
    """Compare the load from the pressure with the logged one, in words; as `state_limits`."""
    measured = pressure.pressure_measured.values > 0
    load, std = (pressure[name].values for name in ("load_from_pressure", "load_from_pressure_std"))
    logged = pressure["joint_load"].values
    measured &= np.isfinite(logged) & np.isfinite(load) & np.isfinite(std)
    if not measured.any():
        return "No load to compare with."

    logged = logged[measured]
    ratio = load[measured] / logged
    cov = pressure.load_cov.values[np.ix_(measured, measured)] / np.outer(logged, logged)
    tests = weigh_loads(ratio, cov)
    text = (
        f"The pressure carries {100 * tests.ratio:.1f} ± {100 * tests.std:.1f} % of the load "
        f"(median of the {tests.used} triggers where it is known best; one standard deviation)"
    )
    if not tests.shifted and not tests.differs and not tests.off.any():
        chance = f"all triggers with their correlations: p = {tests.chance:.2g}"
        return f"{text}: the load is balanced ({chance})."
    off = np.zeros(measured.size, bool)
    off[measured] = tests.off
    if tests.off.any():
        text += (
            f"; it differs from the load by more than {tests.limit:.1f} standard deviations at "
            f"{off.sum()} of {measured.sum()} triggers ({_list_triggers(off)})"
        )
    elif tests.differs and not tests.shifted:
        text += (
            "; over all triggers it differs from the load by more than its correlated errors allow "
            f"(p = {tests.chance:.1g})"
        )
    causes = _name_causes(pressure, tests.ratio, shifted=tests.shifted)
    return f"{text}. What fits: {'; '.join(causes)}."


class _Balance(NamedTuple):
    """Tests of the load of all triggers against the logged one."""

    ratio: float  # median of the better known half, over the logged load
    std: float  # its standard deviation
    used: int  # triggers of that half
    shifted: bool  # whether the median differs
    chance: float  # of a larger sum of squares over all triggers
    differs: bool  # whether that is too small
    off: Mask  # single triggers that differ, (trigger,)
    limit: float  # standard deviations from which they do


def weigh_loads(ratio: Array, cov: Array) -> _Balance:
    """Test loads over the logged ones, with their covariance, against 1.

    The sum of squared deviations over their variances is a weighted sum of chi-squares, whose mean
    and variance follow from the correlations (Satterthwaite 1946). It is not the chi-square of the
    inverse covariance: that is made of differences which the smooth path leaves almost without an
    error.
    """
    from scipy.special import chdtrc, ndtri

    error = np.sqrt(np.diag(cov))
    one = float(-ndtri(FALSE_ALARM / 6))  # a third of the alarms, two sides
    good = error <= np.median(error)
    middle = float(np.median(ratio[good]))

    # a median of independent values is known worse than their mean, but no worse than a single one
    mean_std = float(np.sqrt(cov[np.ix_(good, good)].mean() * np.pi / 2))
    std = min(mean_std, float(np.median(error[good])))

    count = ratio.size
    pull = (ratio - 1) / error
    correlation = cov / np.outer(error, error)
    freedom = count**2 / float((correlation**2).sum())
    chance = float(chdtrc(freedom, freedom / count * float(pull @ pull)))
    limit = float(-ndtri(FALSE_ALARM / (6 * count)))
    return _Balance(
        ratio=middle,
        std=std,
        used=int(good.sum()),
        shifted=abs(middle - 1) > one * std,
        chance=chance,
        differs=chance < FALSE_ALARM / 3,
        off=np.abs(pull) > limit,
        limit=limit,
    )


def _name_causes(pressure: xr.Dataset, ratio: float, *, shifted: bool) -> list[str]:
    """List possible causes of a load that differs by this ratio, or at single triggers."""
    pin = describe_sideways(settings_of(pressure).prediction)
    mount = f"{pin} in [prediction]"
    if "prediction.sideways" not in str(pressure.attrs.get("settings_stated", "")).split(", "):
        mount = "free sideways is assumed, as [prediction] states no mount"
    causes = [
        f"the mount: {mount} (free and guided pins have different load lines and cavities)",
        "load line or direction of the motion in [prediction]",
        "clearance and length in [joint]",
    ]

    # a scale moves all triggers alike, and none makes a load negative
    if shifted and ratio > 0:
        would = "would have to be {:.2g} times the stated one".format
        scales = [
            f"the load or its unit, which {would(ratio)}",
            f"the viscosity of the oil in the gap, which {would(1 / ratio)}",
        ]
        return [*scales, *causes]
    return causes
