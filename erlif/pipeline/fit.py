"""A film to the physics that carries it: viscosity, start and mount fitted to its positions."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.calibration import calibration_of
from erlif.core.errors import ConfigError
from erlif.core.progress import ShowProgress, choose_progress
from erlif.files import open_film
from erlif.models.reynolds import Journal
from erlif.pipeline.joint import describe_joint
from erlif.pipeline.predict import is_film, read_film
from erlif.pipeline.prediction import build_journal, build_motion
from erlif.prediction import (
    Comparison,
    MeasuredMotion,
    compare_models,
    film_temperature,
    measured_minima,
    measured_positions,
)
from erlif.prediction.comparison import STEADY
from erlif.prediction.fit import LOAD_LINE_STD
from erlif.trend import VogelLaw

_POSITIONS = (
    "pin_displacement",
    "pin_position_cov",
    "pin_position_cov_random",
    "pin_position_gradient",
)
_STEADY = {"film_hamrock_dowson": "film_hamrock_dowson", "film_regime_map": "film_theory"}
"""Variables of a film with steady formulas, and their names in the comparison."""


def fit_film(path: str | Path, *, progress: ShowProgress = None) -> Comparison:
    """Fit the models of what may carry the film of an oscillating joint, and compare them.

    Parameters
    ----------
    path : path
        A film, or a run directory that holds film.nc or film.zarr.
    progress : "bar", bool or callable, optional
        As for `erlif.process`.

    Returns
    -------
    Comparison

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
    place = path if is_film(path) else _film_in(path)
    source = read_film(place)
    if "load" not in source.frames:
        raise ConfigError(
            'Expected the load for a fit of the film: add load = "50 lbf" to [joint] in run.toml, '
            "or load_N to the log, and process the run again."
        )
    with open_film(place) as film:
        motion = build_motion(source.settings, source.frames)
        journal = build_journal(source.settings, motion.viscosity)
        measured = _measured(film, journal)
        steady = {
            ours: film[name].values * 1e-6
            for name, ours in _STEADY.items()
            if name in film and ours in STEADY
        }
    used = source.frames.used.values
    given = source.settings.prediction.load_line is not None
    found = compare_models(
        measured,
        journal,
        motion.motion,
        steps=motion.steps,
        trigger=np.where(used, source.frames.trigger.values, -1),
        crank=motion.crank,
        steady=steady,
        load_line_std=0.1 * LOAD_LINE_STD if given else LOAD_LINE_STD,
        progress=report,
    )

    # the temperature of the film belongs to its viscosity where the law of the oil is known
    joint = describe_joint(source.settings)
    if found.fit is None or joint is None or not isinstance(joint.viscosity, VogelLaw):
        return found
    warm = film_temperature(found.fit.estimates["viscosity"], joint.viscosity)
    estimates = {**found.fit.estimates, "temperature": warm}
    return replace(found, fit=replace(found.fit, estimates=estimates))


def _film_in(run_dir: Path) -> Path:
    """The film of a run directory."""
    for name in ("film.nc", "film.zarr"):
        if (run_dir / name).exists():
            return run_dir / name
    raise ConfigError(
        f"Expected film.nc in {run_dir} for a fit; there is none. Run erlif process {run_dir} "
        "first, or give the film."
    )


def _measured(film: xr.Dataset, journal: Journal) -> MeasuredMotion:
    """Positions of the pin, else minima."""
    if all(name in film for name in _POSITIONS):
        return measured_positions(film[list(_POSITIONS)], calibration_of(film).full_covariance)

    # the error of a minimum is not split; either part is at most all of it
    std = film["film_min_std"].values * 1e-6
    return measured_minima(
        film["film_min"].values * 1e-6, std, clearance=journal.clearance, std_shared=std
    )
