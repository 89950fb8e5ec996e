"""Film statistics for a comparison, with the parts of their errors kept apart."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
import xarray as xr

from erlif.calibration import RunCurve, calibration_of
from erlif.core.arrays import Array
from erlif.core.errors import ErlifError
from erlif.io.files import applicable_theory, region_of, settings_of
from erlif.io.settings import RunSettings
from erlif.pipeline.physics.joint import describe_contact
from erlif.review.comparison.calibrations import RunErrors, quadratic
from erlif.review.comparison.cells import CELL, average_cells, cell_edges, noise_inflation
from erlif.trend import LARGEST_BEYOND, viscosity_at

# Film statistics that are compared.
STATISTICS = ("film_min", "film_mean")

# Share of the variance of a statistic, without that of the calibration, that is the same at every
# trigger of a run. Marks of the surfaces make that of the minimum; flats make 8 % of the variance
# of a pixel of one frame (docs/uncertainty.md).
REPEATING = {"film_min": 1.0, "film_mean": 0.08}

_SAMPLED = 12  # triggers from whose maps the errors of the mean are taken
_RESIDUAL = 0.1  # of the variance of a mean that its known parts may leave unexplained
_LEAST_OWN = 0.1  # of a standard deviation is not that of the calibration, at least
_CHOSEN = ("crank_speed", "speed", "frequency", "load")  # what a run of one mechanism may choose


@dataclass(frozen=True)
class RunRecord:
    """A run as it is compared.

    Attributes
    ----------
    name : str
        Name of the run; `erlif.io.files.label_films` distinguishes runs of one name.
    settings : RunSettings
    errors : RunErrors
        Of the calibration.
    frames_key : str
        Hash of the frames of camera 1; empty where it is not recorded.
    identity : str
        Identity of the film; empty where it is not recorded.
    angle : Array
        Crank angle of the triggers, else their number, (trigger,).
    by_angle : bool
        Whether `angle` is a crank angle. [degree]
    value : dict[str, Array]
        Film statistics by name, (trigger,). [um]
    std : dict[str, Array]
        Their standard deviation, all parts. [um]
    own_std : dict[str, Array]
        The part that the calibration does not share. [um]
    gradient : dict[str, Array]
        Change with the parameters of the calibration, (trigger, parameter).
    speed : Array | None
        Speed of the joint without sign, else sliding speed, (trigger,). [rad s-1] or [m s-1]
    speed_name : str
        "rocker_speed" or "sliding_speed"; empty without a speed.
    load : Array | None
        (trigger,) [N]
    viscosity : Array | None
        Of the oil, where [oil] gives it, (trigger,). [Pa s]
    theory : Array | None
        Minimum film that theory predicts, (trigger,). [um]
    patch_ratio : Array | None
        Ratio of the cameras on the reference patch, (trigger,). [1]
    """

    name: str
    settings: RunSettings
    errors: RunErrors
    frames_key: str
    identity: str
    angle: Array
    by_angle: bool
    value: dict[str, Array]
    std: dict[str, Array]
    own_std: dict[str, Array]
    gradient: dict[str, Array]
    speed: Array | None
    speed_name: str
    load: Array | None
    viscosity: Array | None
    theory: Array | None
    patch_ratio: Array | None


def read_run(film: xr.Dataset) -> RunRecord:
    """Take from a film what is compared.

    Parameters
    ----------
    film : xarray.Dataset
        With settings and calibration among its attributes.

    Returns
    -------
    RunRecord

    Raises
    ------
    OutputError
        If the film does not hold its settings or its calibration.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> record = read_run(example_film())
    >>> record.name, record.by_angle, record.value["film_min"].shape
    ('example', True, (6,))
    """
    settings, calibration = settings_of(film), calibration_of(film)
    covariance = calibration.full_covariance
    by_angle = "crank_angle" in film
    triggers = film.sizes["trigger"]
    value, std, own, gradient = {}, {}, {}, {}
    for name in STATISTICS:
        value[name] = film[name].values.astype(float)
        std[name] = film[f"{name}_std"].values.astype(float)

    # a mean over less than the region is not that of the same place
    if "share_beyond_range" in film:
        partial = film.share_beyond_range.values > LARGEST_BEYOND
        value["film_mean"] = np.where(partial, np.nan, value["film_mean"])

    passed = _shares(film)
    lowest = None
    if "film_min_x" in film:
        lowest = film.film_min_x.values.astype(float), film.film_min_y.values.astype(float)
    gradient["film_min"] = _film_gradients(value["film_min"], calibration, passed, lowest)
    own["film_min"] = _remainder(std["film_min"], gradient["film_min"], covariance)
    sampled = np.unique(np.linspace(0, triggers - 1, min(triggers, _SAMPLED)).astype(int))
    parts = [_mean_errors(film, int(k), calibration.at(float(passed[k]))) for k in sampled]
    random = np.array([noise for noise, _ in parts])
    offset = np.array([change for _, change in parts])

    # the gradient at the mean film, with what the spread of films in the region adds
    at = _film_gradients(value["film_mean"], calibration, passed)
    known = np.isfinite(offset).all(axis=1) & np.isfinite(at[sampled]).all(axis=1)
    added = (offset[known] - at[sampled][known]).mean(axis=0) if known.any() else 0.0
    gradient["film_mean"] = at + added
    nearest = np.abs(np.arange(triggers)[:, None] - sampled[None, :]).argmin(axis=1)
    frames = np.maximum(film.frames_used.values[nearest], 1) / np.maximum(film.frames_used, 1)
    own["film_mean"] = random[nearest] * np.sqrt(np.asarray(frames))
    left = _remainder(std["film_mean"], gradient["film_mean"], covariance) ** 2
    left -= own["film_mean"] ** 2
    large = left > _RESIDUAL * std["film_mean"] ** 2  # as of a background
    own["film_mean"] = np.sqrt(own["film_mean"] ** 2 + np.where(large, left, 0.0))

    angle = film.crank_angle.values if by_angle else np.arange(triggers)
    hashes = json.loads(str(film.attrs.get("input_hashes", "{}")))
    return RunRecord(
        name=settings.name,
        settings=settings,
        errors=RunErrors.of(film, calibration),
        frames_key=str(hashes.get(settings.camera1.files, "")),
        identity=str(film.attrs.get("identity", "")),
        angle=np.asarray(angle, float),
        by_angle=by_angle,
        value=value,
        std=std,
        own_std=own,
        gradient=gradient,
        **_conditions(film, settings, calibration),
    )


def _conditions(film: xr.Dataset, settings: RunSettings, calibration: RunCurve) -> dict[str, Any]:
    """Speed, load, viscosity and theory of the triggers, and the reference patch, where known."""
    name = next((each for each in ("rocker_speed", "sliding_speed") if each in film), "")
    theory = applicable_theory(film)
    contact = describe_contact(settings)
    viscosity = None
    if contact is not None and ("temperature" in film or isinstance(contact.viscosity, float)):
        conditions = film[[each for each in ("film_min", "temperature") if each in film]]
        viscosity = viscosity_at(conditions.reset_coords(drop=True), contact.viscosity)
        viscosity = np.broadcast_to(viscosity, (film.sizes["trigger"],))

    # the patch shows drift of cameras and light, which no calibration may take out
    patch = None
    if "reference_film" in film:
        # the measured ratio, whatever the calibration
        films = zip(film.reference_film.values, _shares(film), strict=True)
        patch = np.array([float(calibration.at(float(at)).predict(one)) for one, at in films])
    return {
        "speed": np.abs(film[name].values) if name else None,
        "speed_name": name,
        "load": film["joint_load"].values if "joint_load" in film else None,
        "viscosity": viscosity,
        "theory": None if theory is None else theory.values,
        "patch_ratio": patch,
    }


def _shares(film: xr.Dataset) -> Array:
    """Share of the run that has passed at each trigger; all of it where that is not stored. [1]"""
    known = "share_passed" in film
    return film.share_passed.values if known else np.ones(film.sizes["trigger"])


def _film_gradients(
    value: Array,
    calibration: RunCurve,
    passed: Array,
    place: tuple[Array, Array] | None = None,
) -> Array:
    """Change of a film of each trigger with the parameters, (trigger, parameter).

    `place` has column and row of each, [px].
    """
    if not calibration.varies:
        return calibration.film_gradient(value, place=place).T
    places = [None] * value.size if place is None else list(zip(*place, strict=True))
    return np.array(
        [
            calibration.at(float(share)).film_gradient(one, place=at)
            for one, share, at in zip(value, passed, places, strict=True)
        ]
    )


def _remainder(std: Array, gradient: Array, covariance: Array) -> Array:
    """Standard deviation without the part of the calibration."""
    shared = quadratic(gradient, covariance)
    return np.asarray(np.sqrt(np.maximum(std**2 - shared, (_LEAST_OWN * std) ** 2)))


def _mean_errors(film: xr.Dataset, trigger: int, calibration: RunCurve) -> tuple[float, Array]:
    """Noise of the mean film of one map, and its change with the parameters of the calibration."""
    region = region_of(film)
    # names of further columns could be those of methods: the axes are selected by position
    inside = film[["thickness", "thickness_std", "thickness_std_shared"]].isel(
        x=(film.x.values >= region.x[0]) & (film.x.values <= region.x[1]),
        y=(film.y.values >= region.y[0]) & (film.y.values <= region.y[1]),
    )
    one = inside.isel(trigger=trigger)
    value = one.thickness.values.astype(float)
    variance = one.thickness_std.values.astype(float) ** 2
    valid = np.isfinite(value)
    parameters = calibration.full_covariance.shape[0]
    if min(value.shape) < 2 * CELL or not valid.any():
        return float("nan"), np.full(parameters, np.nan)
    noise = noise_inflation(value, variance) * float(variance[valid].sum())
    edges = {axis: cell_edges([inside], axis) for axis in ("x", "y")}
    cells = average_cells(inside, trigger, calibration, edges)
    weight = np.nan_to_num(cells.count) * np.isfinite(cells.film)
    change = (cells.gradient * weight[..., None]).sum(axis=(0, 1)) / max(float(weight.sum()), 1.0)
    return float(np.sqrt(noise) / valid.sum()), change


def refuse_unlike(records: Sequence[RunRecord]) -> None:
    """Refuse films that are no runs to be compared.

    Parameters
    ----------
    records : sequence of RunRecord

    Raises
    ------
    ErlifError
        With fewer than two films, twice the same film or frames, or other mechanisms.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> refuse_unlike([read_run(example_film())])
    Traceback (most recent call last):
        ...
    erlif.core.errors.ErlifError: Expected two films or more; got 1. Name the films of the runs to \
be compared.
    """
    if len(records) < 2:
        raise ErlifError(
            f"Expected two films or more; got {len(records)}. Name the films of the runs to be "
            "compared."
        )
    # a run compared with itself would share its noise and seem certain
    for one, other in combinations(records, 2):
        same = one.identity and one.identity == other.identity
        if same or (one.frames_key and one.frames_key == other.frames_key):
            raise ErlifError(
                f"Expected films of different runs; two of them, {one.name} and {other.name}, were "
                "made from the same frames and share their noise. Leave one of them out."
            )
        if _motion(one.settings) != _motion(other.settings):
            raise ErlifError(
                f"Expected runs of one mechanism; {one.name} has {_mechanism(one.settings)}, "
                f"{other.name} has {_mechanism(other.settings)}. Compare runs of the same "
                "mechanism."
            )
        if one.by_angle != other.by_angle:
            raise ErlifError(
                f"Expected crank angles in all films or in none; of {one.name} and {other.name} "
                "one has them. Compare runs with the same kind of log."
            )


def _motion(settings: RunSettings) -> dict[str, object]:
    """The table [mechanism] without its speeds and its load."""
    if settings.mechanism is None:
        return {}
    names = type(settings.mechanism).model_fields
    return {key: getattr(settings.mechanism, key) for key in names if key not in _CHOSEN}


def _mechanism(settings: RunSettings) -> str:
    """A mechanism in words."""
    table = _motion(settings)
    if not table:
        return "no [mechanism]"
    lengths = ", ".join(
        f"{key} {1e3 * each:g} mm" for key, each in table.items() if isinstance(each, float)
    )
    return f"{table['kind']} ({lengths})" if lengths else str(table["kind"])
