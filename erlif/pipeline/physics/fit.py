"""A film to the physics that carries it: viscosity, start and mount fitted to its positions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.calibration import calibration_of
from erlif.core.arrays import Array
from erlif.core.errors import ConfigError, ErlifError
from erlif.core.notes import warn
from erlif.core.progress import Progress, ShowProgress, choose_progress, silent
from erlif.io.files import formula_label, open_film, takes
from erlif.io.settings import RunSettings
from erlif.models.reynolds import Journal
from erlif.pipeline.physics.agreement import viscosity_powers
from erlif.pipeline.physics.bore import departure
from erlif.pipeline.physics.exponents import speed_of_trend
from erlif.pipeline.physics.given import given_errors, reading_error
from erlif.pipeline.physics.joint import describe_contact, describe_viscosity, joint_and_oil
from erlif.pipeline.physics.predict import film_beside, is_film, read_film
from erlif.pipeline.physics.prediction import build_journal, build_motion, swinging_joint
from erlif.prediction import (
    Estimate,
    MeasuredMotion,
    ModelComparison,
    SteadyFilm,
    compare_films,
    compare_models,
    film_temperature,
    measured_minima,
    measured_positions,
)
from erlif.prediction.comparison import HELD, REGIME_MAP
from erlif.prediction.fit import FEWEST_TRIGGERS, LOAD_LINE_STD, MISFIT
from erlif.trend import VogelLaw, fast_triggers, viscosity_at

# Films of steady formulas in film.nc, and the powers of the viscosity in those of a rigid line
# contact.
_STEADY = {"film_hamrock_dowson": 0.7, "film_theory": 1.0}

_FAR = 3.0  # standard deviations of a fitted load line from that of the film, from which it counts
_MILLI = 1e3
_CHANCE = 1e-3  # that errors alone move the tilt so far, from which the pin rocks


@takes(path="run or film")
def fit_film(path: str | Path, *, progress: ShowProgress = None) -> ModelComparison:
    """Fit the models of what may carry the film of an oscillating joint, and compare them.

    A pin on a sideways spring is fitted where no other model describes the positions.

    Parameters
    ----------
    path : path
        A film, or a run directory that holds film.nc or film.zarr.
    progress : "bar", bool or callable, optional
        As for `erlif.process`.

    Returns
    -------
    ModelComparison

    Raises
    ------
    ErlifError
        If there is no film, its settings describe no joint that swings, or nothing can be fitted.

    Examples
    --------
    >>> fit_film(Path("data_samples/straight_bushing")).verdict  # doctest: +SKIP
    'Squeeze carries the film of a pin that is free sideways, and the pin sinks (very strong ...'
    """
    report = choose_progress(progress)
    path = Path(path)
    place = path if is_film(path) else film_beside(path)
    if place is None:
        raise ConfigError(
            f"Expected film.nc in {path} for a fit; there is none. Run erlif process {path} first, "
            "or give the film."
        )
    source = read_film(place)
    with open_film(place) as film:
        run = film, source.settings, source.frames
        comparison = _compare_models(*run, ("free", "guided"), progress=report)
        # of four unknowns in a film with cavities: slow, and needed by no other film
        if not comparison.candidates[0].describes:
            comparison = _compare_models(*run, ("free", "guided", "spring"), progress=report)

    if comparison.fit is None:
        return comparison
    found = comparison.fit.estimates
    beside = _beside_sheet(found["viscosity"], source.settings, source.frames)
    notes = comparison.fit.notes
    line, seen = found.get("load_line"), source.film.get("pin_displacement", xr.DataArray())
    if line is not None and "load_line" in seen.attrs:
        about = 1e-3 * float(seen.attrs["load_line"])
        low, high = line.low + about, line.high + about
        beside["load_line"] = replace(line, value=line.value + about, low=low, high=high)
        if abs(line.value) > _FAR * line.std and comparison.fit.sideways == "free":
            middle = f"{_MILLI * (about + line.value):.2f}"
            text = (
                f"the displacements are about {_MILLI * about:.2f} mm, and the orbit has it at "
                f'{middle} ± {_MILLI * line.std:.2f} mm. Set load_line = "{middle} mm" in '
                "[prediction], and run erlif process again"
            )
            notes = (*notes, warn("load line", text))
    fit = replace(comparison.fit, estimates={**found, **beside}, notes=notes)
    return replace(comparison, fit=fit)


def _beside_sheet(
    viscosity: Estimate, settings: RunSettings, frames: xr.Dataset
) -> dict[str, Estimate]:
    """Compare the fitted viscosity with that of [oil], if this has an error or a law.

    The temperature of the film does not change the viscosity that is fitted, but what is expected
    of the oil.
    """
    _, oil = joint_and_oil(settings)
    law = swinging_joint(settings).joint.viscosity
    expected = float(viscosity_at(frames, law).mean())
    parts = {"oil": float(oil.viscosity_std or 0.0) / expected}
    beside: dict[str, Estimate] = {}
    if isinstance(law, VogelLaw):
        parts["temperature"] = reading_error(settings, frames)
        beside["temperature"] = film_temperature(viscosity, law)
    parts = {name: std * viscosity.value / expected for name, std in parts.items() if std}
    if parts:
        ratio = viscosity.times(1 / expected, "1")
        wide = ratio.widened(parts)
        beside["viscosity_ratio"] = replace(wide, parts={**wide.parts, **ratio.parts})
    return beside


def state_physics(
    film: xr.Dataset, settings: RunSettings, frames: xr.Dataset, shared: Array | None = None
) -> tuple[str, dict[str, float]]:
    """State which physics carries a film and how certain that is, without films with cavities.

    The film of a free pin, squeeze in closed form, a constant gap, the steady formulas and powers
    of speed over load are fitted to the positions of a pin; all but the first two to the minima of
    a contact without one, at speeds above a tenth of the highest. Where none describes the film and
    the pin stays on one line, as a guided one does, the text names the command that fits this.

    Parameters
    ----------
    film : xarray.Dataset
        The root group of film.nc.
    settings : RunSettings
    frames : xarray.Dataset
        As `erlif.pipeline.physics.prediction.frames_of_run` returns them.
    shared : array, (trigger, source), optional
        Errors of the minima that all triggers share, for a contact without a pin. [um]

    Returns
    -------
    verdict : str
        Which physics carries the film in a first sentence, then what limits it; empty where nothing
        is predicted.
    taken : dict of str to float
        viscosity, viscosity_std and viscosity_given: what the transient film of a free pin takes,
        start and load line fitted with it, beside that of [oil]; empty where it does not describe
        the film. [Pa s]
    """
    contact = settings.joint is None and shared is not None and {*_STEADY} <= set(film)
    if not contact and not {"film_predicted_min", "pin_displacement"} <= set(film):
        return "", {}
    if settings.joint is not None and settings.joint.liner is not None:
        return "", {}  # its films take a minute
    try:
        if settings.joint is None and shared is not None:
            return _compare_films(film, settings, shared).verdict, {}
        found = _compare_models(film, settings, frames, ("free", "any guided"))
    # the measured film is complete without this sentence
    except (ErlifError, ArithmeticError, ValueError, np.linalg.LinAlgError):
        return "", {}
    free = next((one for one in found.candidates if one.name == HELD["free"]), None)
    if free is None or not free.describes or settings.prediction.sideways != "free":
        return found.verdict, {}
    viscosity = free.estimates["viscosity"]
    given = float(viscosity_at(frames, swinging_joint(settings).joint.viscosity).mean())
    taken = {"viscosity": viscosity.value, "viscosity_std": viscosity.std, "viscosity_given": given}
    return found.verdict, taken if viscosity.std < viscosity.value else {}


def _compare_models(
    film: xr.Dataset,
    settings: RunSettings,
    frames: xr.Dataset,
    sideways: Sequence[str],
    progress: Progress = silent,
) -> ModelComparison:
    """Compare the models of the film; a spring needs positions."""
    if "joint_load" not in frames:
        raise ConfigError(
            'Expected the load for a fit of the film: add load = "50 lbf" to [joint] in run.toml, '
            "or load_N to the log, and process the run again."
        )
    motion = build_motion(settings, frames)
    journal = build_journal(settings, motion.viscosity)
    departs, steady = departure(settings), _steady_films(film, settings)
    given = given_errors(settings, film, frames)
    line = given.load_line
    measured = _measured_motion(film, journal)
    found = compare_models(
        measured,
        journal,
        motion,
        trigger=np.where(frames.used.values, frames.trigger.values, -1),
        steady=[] if departs else steady,
        drive=_drive(film),
        viscosity_std=joint_and_oil(settings)[1].viscosity_std,
        sideways=[one for one in sideways if one != "spring" or measured.is_position],
        load_line_std=LOAD_LINE_STD if line is None else line,
        given=given,
        progress=progress,
    )
    if departs:
        reason = f"of a straight, rigid and smooth joint; run.toml has {departs}"
        others = dict.fromkeys([one.name for one in steady], reason)
        found = replace(found, not_fitted={**found.not_fitted, **others})

    rocking = _rocking(film)
    if not rocking:
        return found
    middle = found.verdict[0].lower() + found.verdict[1:]
    text = f"The pin rocks by {rocking:.2g} nm/mm, which no model has; in its middle {middle}"
    return replace(found, verdict=text)


def _steady_films(film: xr.Dataset, settings: RunSettings) -> list[SteadyFilm]:
    """The films of steady formulas in a film, as `compare_models` takes them."""
    names, contact = [name for name in _STEADY if name in film], describe_contact(settings)
    powers = _STEADY if contact is None else viscosity_powers(film, contact, names)
    return [
        SteadyFilm(
            REGIME_MAP if name == "film_theory" else formula_label(film),
            film[name].values * 1e-6,
            powers[name],
            # infinite outside the regime of a formula, where its shape alone is compared
            error=float(film[name].attrs.get("formula_error", 0)),
        )
        for name in names
    ]


def _drive(film: xr.Dataset) -> Array | None:
    """Speed over load of the triggers; None where one of them is not known."""
    speed = speed_of_trend(film)
    return (film[speed] / film["joint_load"]).values if {speed, "joint_load"} <= {*film} else None


def _compare_films(film: xr.Dataset, settings: RunSettings, shared: Array) -> ModelComparison:
    """Compare the steady films of a contact without a pin by the minima of fast triggers."""
    oil = settings.oil
    assert oil is not None  # there are films of theory
    fast = fast_triggers(film[speed_of_trend(film)].values)
    measured = np.where(fast, film["film_min"].values, np.nan) * 1e-6
    return compare_films(
        measured,
        film["film_min_std_random"].values * 1e-6,
        shared * 1e-6,
        viscosity=float(viscosity_at(film, describe_viscosity(oil))[fast].mean()),
        viscosity_std=oil.viscosity_std,
        steady=_steady_films(film, settings),
        drive=_drive(film),
    )


def _rocking(film: xr.Dataset) -> float:
    """Range of the tilt of the pin towards the load where it moves beyond its random error, else 0.
    [nm/mm]
    """
    if "pin_tilt" not in film:
        return 0.0
    tilt, variance = film.pin_tilt.values[:, 0], film.pin_position_cov_random.values[:, 2, 2]
    known = np.isfinite(tilt) & (variance > 0)
    tilt, variance = tilt[known], variance[known]
    if tilt.size < FEWEST_TRIGGERS:
        return 0.0
    from scipy.special import chdtrc  # slow to load

    chi = float(((tilt - np.average(tilt, weights=1 / variance)) ** 2 / variance).sum())
    return 1e3 * float(np.ptp(tilt)) if chdtrc(tilt.size - 1, chi / MISFIT**2) < _CHANCE else 0.0


def _measured_motion(film: xr.Dataset, journal: Journal) -> MeasuredMotion:
    """Positions of the pin, else minima: where too few positions are known, and on a liner, whose
    yield is part of the positions.
    """
    if journal.foundation is None and "pin_displacement" in film:
        positions = measured_positions(film, calibration_of(film).full_covariance)
        if positions.known.sum() >= FEWEST_TRIGGERS:
            return positions

    # the error of a minimum is not split; either part is at most all of it
    std = film["film_min_std"].values * 1e-6
    return measured_minima(
        film["film_min"].values * 1e-6, std, clearance=journal.least_clearance, std_shared=std
    )
