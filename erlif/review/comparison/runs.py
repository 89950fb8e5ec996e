"""Runs against each other, as one dataset.

The film is set against the duty parameter: a power for each run, and one for all.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import scipy
import xarray as xr

from erlif.calibration import NO_SYSTEMATICS, Calibration, open_calibration
from erlif.core.arrays import Array
from erlif.core.errors import ErlifError
from erlif.core.progress import Progress, silent
from erlif.core.version import __version__
from erlif.io.conversion.contents import choose_trigger
from erlif.io.conversion.export import opened_film
from erlif.io.files import fastest_trigger, label_films, refuse_repeated
from erlif.review.comparison.calibrations import joint_covariance
from erlif.review.comparison.charts import control_chart, drift_between
from erlif.review.comparison.difference import (
    average_difference,
    common_angles,
    correct_for_many,
    difference_map,
)
from erlif.review.comparison.records import STATISTICS, RunRecord, read_run, refuse_unlike
from erlif.review.comparison.settings import list_differing
from erlif.trend import SLOWEST, Exponent, fit_exponent

# Corrected probability below which two runs are stated to differ.
SIGNIFICANT = 0.05


def compare(
    films: Sequence[xr.Dataset | str | Path],
    *,
    pair: tuple[int, int] = (0, 1),
    crank_angle: float | None = None,
    calibrations: Sequence[str | Path] = (),
    progress: Progress = silent,
) -> xr.Dataset:
    """Compare runs: film against duty parameter, differences with their errors, control chart.

    Parameters
    ----------
    films : sequence of Dataset or path
        Two or more, of one mechanism.
    pair : (int, int)
        Films of the difference map, counted from 0.
    crank_angle : float, optional
        Crank angle of the difference map; default: the fastest trigger of the first of the pair.
        [degree]
    calibrations : sequence of path
        Further calibrations for the control chart.
    progress : Progress, optional
        Called as the work proceeds.

    Returns
    -------
    xarray.Dataset
        On run: power of the duty parameter. On (run, trigger): duty parameter and film. On pair:
        difference of each film statistic, its standard deviation, the probability of chance
        corrected for the number of tests, and whether the runs differ. On (map_y, map_x): the
        difference map. The control chart where films have a reference patch or several
        calibrations. On (setting, run): the settings that differ. docs/compare.md describes all.

    Raises
    ------
    ErlifError
        If the films cannot be compared.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> thicker = film.assign(film_min=film.film_min + 0.5, film_mean=film.film_mean + 0.5)
    >>> found = compare([film, thicker])
    >>> found.difference.sel(statistic="film_min").values.round(3).tolist()
    [0.5]
    >>> found.differs.sel(statistic="film_min").values.tolist()
    [1]
    """
    refuse_repeated([film for film in films if not isinstance(film, xr.Dataset)])
    with ExitStack() as stack:
        opened = [stack.enter_context(opened_film(film, where="films")) for film in films]
        records = []
        for k, film in enumerate(opened):
            records.append(read_run(film))
            progress("films", k + 1, len(opened))
        # a film that is in memory only has no file
        sources = [film.encoding.get("source") for film in opened]
        files = [Path(source) if source else None for source in sources]
        labels = label_films([record.name for record in records], files)
        records = [
            replace(record, name=label) for record, label in zip(records, labels, strict=True)
        ]
        refuse_unlike(records)

        # calibrations beside the films extend the chart, and show how the rig changes
        known = _distinct(records, [open_calibration(path) for path in calibrations])
        drift = drift_between([replace(each, systematics=NO_SYSTEMATICS) for each in known])
        records = [replace(each, errors=replace(each.errors, drift=drift)) for each in records]
        first, second = _check_pair(pair, len(records))

        comparison = _compare_pairs(records).merge(_compare_powers(records))
        stated = list_differing([record.settings for record in records])
        if stated:
            keys, values = list(stated), np.array(list(stated.values()))
            comparison = comparison.assign_coords(setting=keys)
            comparison["stated"] = (
                ("setting", "run"),
                values,
                {"long_name": "settings that differ"},
            )
        one, other = opened[first], opened[second]
        triggers = _choose_triggers(one, other, crank_angle)
        mapped = difference_map(one, other, triggers=triggers, drift=drift)

    chart = control_chart(records, known)
    names = {"x": "map_x", "y": "map_y"} | {str(name): f"map_{name}" for name in mapped.data_vars}
    attrs = {f"map_{name}": value for name, value in mapped.attrs.items()}
    comparison = comparison.merge(mapped.rename(names).drop_attrs(deep=False)).merge(chart)
    return comparison.assign_attrs(
        title="runs compared",
        erlif_version=__version__,
        history=f"erlif {__version__}: compare {', '.join(record.name for record in records)}",
        calibration_drift=drift,
        map_first_run=records[first].name,
        map_second_run=records[second].name,
        **attrs,
        **comparison.attrs,
    )


def _check_pair(pair: tuple[int, int], count: int) -> tuple[int, int]:
    first, second = pair
    if first == second or min(pair) < 0 or max(pair) >= count:
        raise ErlifError(
            f"Expected two different films from 0 to {count - 1} for the difference map; got "
            f"{first} and {second}. Choose two of them."
        )
    return first, second


def _choose_triggers(one: xr.Dataset, other: xr.Dataset, angle: float | None) -> tuple[int, int]:
    """Triggers of the difference map."""
    if angle is None:
        first = fastest_trigger(one)
        if "crank_angle" not in one:
            return first, min(first, other.sizes["trigger"] - 1)
        angle = float(one.crank_angle[first])
    chosen = [choose_trigger(film, crank_angle=angle) for film in (one, other)]
    return int(chosen[0] or 0), int(chosen[1] or 0)


def _distinct(records: list[RunRecord], further: list[Calibration]) -> list[Calibration]:
    """Calibrations of the films and further ones, each once."""
    by_key = {record.errors.fixture: record.errors.curve for record in records}
    kept = [replace(one.calibration, systematics=one.systematics) for one in by_key.values()]
    for each in further:
        # a film stores the parameters of its calibration to the last digit
        if not any(np.array_equal(each.parameters, other.parameters) for other in kept):
            kept.append(each)
    return kept


def _compare_pairs(records: list[RunRecord]) -> xr.Dataset:
    """Differences of the film statistics of all pairs of runs."""
    angle = common_angles(records)
    pairs = list(combinations(records, 2))
    errors = [(first.errors, second.errors) for first, second in pairs]
    table = [
        [average_difference(first, second, name, angle=angle) for name in STATISTICS]
        for first, second in pairs
    ]

    def collect(field: str) -> Array:
        return np.array([[getattr(each, field) for each in row] for row in table])

    probability = collect("probability")
    corrected = correct_for_many(probability.ravel()).reshape(probability.shape)
    dims = ("pair", "statistic")
    um, one = {"units": "um"}, {"units": "1"}
    variables: dict[str, Any] = {
        "difference": (dims, collect("value"), um | {"long_name": "second run less first"}),
        "difference_std": (dims, collect("std"), um),
        "difference_std_own": (dims, collect("own_std"), um),
        "difference_std_changed": (
            dims,
            collect("changed_std"),
            um | {"long_name": "by what changes from run to run, and by the calibrations"},
        ),
        "largest_term": (dims, collect("largest"), {"long_name": "of difference_std_changed"}),
        "probability": (dims, probability, one | {"long_name": "of chance"}),
        "probability_corrected": (dims, corrected, one | {"long_name": "after Holm (1979)"}),
        "differs": (dims, (corrected < SIGNIFICANT).astype(np.uint8), one),
        "difference_at": ((*dims, "angle"), collect("at"), um),
        "difference_at_std": ((*dims, "angle"), collect("at_std"), um),
        "same_calibration": ("pair", [int(a.fixture == b.fixture) for a, b in errors], one),
        "same_rig": ("pair", [int(a.rig == b.rig) for a, b in errors], one),
        "rig_differs": (
            "pair",
            [", ".join(key for key in a.rig if a.rig[key] != b.rig.get(key)) for a, b in errors],
            {"long_name": "what makes the runs those of two rigs"},
        ),
    }
    coords = {
        "run": ("run", [record.name for record in records]),
        "statistic": ("statistic", list(STATISTICS)),
        "first": ("pair", [first.name for first, _ in pairs]),
        "second": ("pair", [second.name for _, second in pairs]),
        "recorded": ("run", [record.errors.date for record in records]),
        "serials": ("run", [record.errors.serials for record in records]),
        "angle": ("angle", angle, {"units": "degree"} if records[0].by_angle else {}),
    }
    method = "at common crank angles, interpolated linearly between triggers where they differ"
    attrs = {"method": method if records[0].by_angle else "trigger by trigger"}
    regions = [record.settings.thickness for record in records]
    if any((one.roi, one.exclude) != (regions[0].roi, regions[0].exclude) for one in regions):
        attrs["note"] = (
            "the regions of the film statistics differ (roi or exclude in [thickness]): a "
            "difference can be that of two places"
        )
    return xr.Dataset(variables, coords, attrs)


def _compare_powers(records: list[RunRecord]) -> xr.Dataset:
    """Film against the duty parameter, with the powers of all runs."""
    duties, unit, meaning = duty_parameters(records)
    # runs may have different numbers of triggers; the rest is NaN
    longest = max(record.angle.size for record in records)

    def pad(values: Array | None) -> Array:
        full = np.full(longest, np.nan)
        if values is not None:
            full[: values.size] = values
        return full

    of_trigger = ("run", "trigger")
    um = {"units": "um"}
    table = xr.Dataset()
    for name in STATISTICS:
        table[name] = (of_trigger, np.array([pad(each.value[name]) for each in records]), um)
        std = np.array([pad(each.std[name]) for each in records])
        table[f"{name}_std"] = (of_trigger, std, um)
    if any(record.theory is not None for record in records):
        table["film_theory"] = (of_trigger, np.array([pad(each.theory) for each in records]), um)
    if not duties:
        return table

    speed = np.array([pad(record.speed) for record in records])
    table["speed"] = (of_trigger, speed, {"units": unit.removesuffix(" N-1").split("s ")[-1]})
    table["duty"] = (of_trigger, np.array([pad(each) for each in duties]), {"units": unit})
    table["duty"].attrs["long_name"] = meaning
    fits = {name: fit_runs(records, duties, name) for name in STATISTICS}
    for field, name in (("value", "exponent"), ("std", "exponent_std"), ("log_scale", "log_scale")):
        values = np.array([[getattr(one, field) for one in fits[each]] for each in STATISTICS])
        table[name] = (("run", "statistic"), values[:, :-1].T, {"units": "1"})
        table[f"joint_{name}"] = ("statistic", values[:, -1], {"units": "1"})
    return table


_UNITS = {"rocker_speed": "rad s-1", "sliding_speed": "m s-1"}


def duty_parameters(records: list[RunRecord]) -> tuple[list[Array], str, str]:
    """Duty parameter of the triggers of each run: viscosity times speed over load.

    Without the viscosity of all runs it is speed over load.

    Parameters
    ----------
    records : list of RunRecord

    Returns
    -------
    values : list of array, (trigger,)
        Empty where a run has no speed or no load.
    unit : str
    meaning : str
        What it is made of, in words.

    Examples
    --------
    >>> from erlif.review.comparison import read_run
    >>> from erlif.show.plots import example_film
    >>> duty_parameters([read_run(example_film())])[1:]
    ('Pa s rad s-1 N-1', 'viscosity times |rocker_speed| over load')
    """
    names = {record.speed_name for record in records}
    if names not in ({"rocker_speed"}, {"sliding_speed"}):
        return [], "", ""
    (name,) = names
    oily = all(record.viscosity is not None for record in records)
    values = []
    for record in records:
        if record.speed is None or record.load is None:
            return [], "", ""
        factor = record.viscosity if oily and record.viscosity is not None else 1.0
        with np.errstate(divide="ignore", invalid="ignore"):  # of a joint without load
            values.append(np.asarray(factor * record.speed / record.load))
    unit = f"{_UNITS[name]} N-1"
    if oily:
        return values, f"Pa s {unit}", f"viscosity times |{name}| over load"
    return values, unit, f"|{name}| over load"


def fit_runs(records: list[RunRecord], duties: list[Array], statistic: str) -> list[Exponent]:
    """Fit film = c duty^n to each run, then to all runs together.

    Triggers slower than a tenth of the fastest of their run are left out. Errors of a fixture are
    common to all its runs; what lies between it and a run, and marks of the surfaces, to the
    triggers of a run.

    Parameters
    ----------
    records : list of RunRecord
    duties : list of array
        As `duty_parameters` returns them.
    statistic : str
        "film_min" or "film_mean".

    Returns
    -------
    list of Exponent
        One for each run, then the joint one.

    Examples
    --------
    The minimum film of the example follows the speed to the power of 0.6:

    >>> from erlif.review.comparison import read_run
    >>> from erlif.show.plots import example_film
    >>> record = read_run(example_film())
    >>> duties, *_ = duty_parameters([record, record])
    >>> [round(one.value, 6) for one in fit_runs([record, record], duties, "film_min")]
    [0.6, 0.6, 0.6]
    """
    return [
        *(_fit_power([one], [duty], statistic) for one, duty in zip(records, duties, strict=True)),
        _fit_power(records, duties, statistic),
    ]


def _fit_power(records: list[RunRecord], duties: list[Array], statistic: str) -> Exponent:
    """One power for all triggers of some runs."""
    calibrations = joint_covariance([record.errors for record in records])
    ends = np.cumsum([record.gradient[statistic].shape[1] for record in records])
    shared = ends[-1]
    marks = statistic == "film_min"

    film, std, duty, rows = [], [], [], []
    for n, (record, each) in enumerate(zip(records, duties, strict=True)):
        speed = np.asarray(record.speed)
        # a trigger without speed or load has no duty parameter
        known = np.isfinite(each) & (each > 0)
        fast = known & (speed >= SLOWEST * np.max(speed, where=known, initial=0.0))
        gradient = np.zeros((fast.sum(), shared + len(records)))
        own_gradient, end = record.gradient[statistic][fast], ends[n]
        gradient[:, end - own_gradient.shape[1] : end] = own_gradient
        own = record.own_std[statistic][fast]
        if marks:  # the same at every trigger of a run
            gradient[:, shared + n] = own
        rows.append(gradient)
        film.append(record.value[statistic][fast])
        std.append(_SMALL * record.value[statistic][fast] if marks else own)
        duty.append(each[fast])
    # the marks of two runs are independent
    covariance = scipy.linalg.block_diag(calibrations, np.eye(len(records)))
    one = np.concatenate(film)
    if one.size == 0:
        return Exponent(math.nan, math.nan, math.nan, 0)
    return fit_exponent(
        one,
        np.concatenate(std),
        speed=np.ones_like(one),  # triggers are chosen above, by the speed of their run
        load=1 / np.concatenate(duty),
        gradient=np.nan_to_num(np.concatenate(rows)),
        covariance=covariance,
    )


# Relative noise of a minimum film beside its marks; the scatter about the line adds to it.
_SMALL = 1e-4
