"""Film against the duty parameter: the power of each run, and one for all."""

from __future__ import annotations

import math

import numpy as np
import scipy

from erlif.core.arrays import Array
from erlif.review.comparison.calibrations import joint_covariance
from erlif.review.comparison.records import RunRecord
from erlif.trend import SLOWEST, Exponent, fit_exponent

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
    calibrations = joint_covariance(
        [record.calibration for record in records], [record.calibration_key for record in records]
    )
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
