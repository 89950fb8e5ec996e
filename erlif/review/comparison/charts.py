"""Control charts: the ratio of the reference patch from run to run, and the calibrations."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import xarray as xr

from erlif.calibration import Calibration, compare_calibrations
from erlif.core.arrays import Array
from erlif.core.errors import CalibrationError
from erlif.review.comparison.records import RunRecord

# Standard deviations between the centre of a chart and its limits (Shewhart 1931).
LIMIT = 3.0


def control_chart(records: Sequence[RunRecord], calibrations: Sequence[Calibration]) -> xr.Dataset:
    """Chart the reference patch over the runs, and the ratio over the calibrations.

    The value of a run is the mean ratio of the cameras on the patch; its standard deviation is the
    scatter of the triggers over the root of their number, so that the limits are those of the
    noise within a run. The value of a calibration is the ratio of a film in the middle of
    the range that all calibrations cover.

    Parameters
    ----------
    records : sequence of RunRecord
        In the order of the chart.
    calibrations : sequence of Calibration
        Each once; they are put in the order of their dates.

    Returns
    -------
    xarray.Dataset
        patch_ratio, patch_ratio_std (run) with patch_centre and patch_limit; calibration_ratio,
        calibration_ratio_std, calibration_date, calibration_verdict (calibration) with
        calibration_centre, calibration_limit and calibration_film [um]. A part that has fewer than
        two values is left out.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from erlif.show.plots import example_calibration
    >>> one = example_calibration()
    >>> later = replace(one, ratio_at_zero=0.70, date="2026-05-02")
    >>> chart = control_chart([], [later, replace(one, date="2026-03-01")])
    >>> chart.calibration_ratio.values.round(2).tolist(), chart.calibration_date.values.tolist()
    ([0.95, 1.0], ['2026-03-01', '2026-05-02'])
    """
    chart = xr.Dataset()
    patches = [record.patch_ratio for record in records]
    if len(patches) > 1 and all(each is not None for each in patches):
        known = [np.asarray(each)[np.isfinite(np.asarray(each))] for each in patches]
        if all(each.size > 1 for each in known):
            value = np.array([each.mean() for each in known])
            std = np.array([each.std(ddof=1) / np.sqrt(each.size) for each in known])
            chart = _centred("patch", "run", value, std)
    if len(calibrations) > 1:
        chart = chart.merge(_chart_calibrations(sorted(calibrations, key=lambda each: each.date)))
    return chart


def drift_between(calibrations: Sequence[Calibration]) -> float:
    """Change of the ratio from one calibration to the next, beyond their errors; 0 with one. [1]

    The root mean square at a film in the middle of the range that all of them cover.

    Parameters
    ----------
    calibrations : sequence of Calibration

    Returns
    -------
    float

    Examples
    --------
    >>> from dataclasses import replace
    >>> from erlif.show.plots import example_calibration
    >>> one = example_calibration()
    >>> later = replace(one, ratio_at_zero=1.02 * one.ratio_at_zero, date="2026-05-02")
    >>> round(drift_between([one, later]), 2)
    0.02
    """
    chart = control_chart([], calibrations)
    if "calibration_ratio" not in chart:
        return 0.0

    value = chart.calibration_ratio.values
    relative = (chart.calibration_ratio_std.values / value) ** 2
    beyond = np.diff(np.log(value)) ** 2 - relative[1:] - relative[:-1]
    return float(np.sqrt(max(beyond.mean(), 0.0)))


def _chart_calibrations(calibrations: list[Calibration]) -> xr.Dataset:
    """The part of the chart on calibrations, earliest first."""
    low = max(each.thickness_range[0] for each in calibrations)
    high = min(each.thickness_range[1] for each in calibrations)
    if high <= low:
        return xr.Dataset()
    film = 0.5 * (low + high)
    value = np.array([float(each.predict(film)) for each in calibrations])
    std = value * np.array([float(each.log_ratio_std(film)) for each in calibrations])
    # drift is judged from one calibration to the next
    verdicts = ["the first"]
    for earlier, later in pairwise(calibrations):
        try:
            verdicts.append(compare_calibrations(later, earlier).verdict)
        except CalibrationError as error:
            verdicts.append(f"not compared: {error}")
    chart = _centred("calibration", "calibration", value, std)
    return chart.assign(
        calibration_date=("calibration", [each.date for each in calibrations]),
        calibration_verdict=("calibration", verdicts),
        calibration_film=((), film, {"units": "um"}),
    )


def _centred(name: str, dim: str, value: Array, std: Array) -> xr.Dataset:
    """A chart of ratios with its centre and its limits."""
    limit = LIMIT * float(np.sqrt((std**2).mean()))
    columns = {
        "ratio": (dim, value),
        "ratio_std": (dim, std),
        "centre": ((), value.mean()),
        "limit": ((), limit),
    }
    return xr.Dataset(
        {f"{name}_{part}": (*column, {"units": "1"}) for part, column in columns.items()}
    )
