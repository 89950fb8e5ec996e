"""Friction of a test log: load from cells, torque from its arm, one value for two oscillations."""

from __future__ import annotations

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import EnduranceError
from erlif.joint.models.friction import friction_coefficient

_REVERSES = 0.3  # of the larger torque: a smaller one against it is noise about zero
_ENDS = (5.0, 95.0)  # percentiles of the torque, which single jerks do not shift
_CYCLES = 2  # oscillations in a bin, so that both directions weigh alike
_SAMPLES = 8  # samples of an oscillation that separate its two directions
_UNLOADED = 0.01  # of the highest load: below it a coefficient has no meaning


def measure_friction(
    log: xr.Dataset,
    *,
    pin_radius: float,
    arm: float | None = None,
    torque_ratio: float = 1.0,
    tare: float = 0.0,
) -> xr.Dataset:
    """Compute load, torque and friction coefficient of a test log.

    Parameters
    ----------
    log : xarray.Dataset
        From `erlif.joint.friction.read_torque_log`: over ``time``, ``cells`` (cell, time) [N], and
        ``torque`` [N m] or ``arm_force`` [N]; ``temperature`` and ``vibration`` travel along.
    pin_radius : float
        Radius of the pin. [m]
    arm : float, optional
        Distance of the arm's load cell from the axis; needed where the log has its force. [m]
    torque_ratio : float
        T* of the pressure distribution, see `erlif.joint.models.friction.friction_coefficient`. [1]
    tare : float
        Reading of the cells together without load. [N]

    Returns
    -------
    xarray.Dataset
        Over ``time``: load [N], torque [N m], friction [1] (NaN without load), and the
        temperature and vibration. A torque that reverses becomes one value for each two
        oscillations, half the difference of its directions: an offset of the cell cancels. The
        attribute ``period`` is that of such a torque. [s] ``pin_radius`` and ``arm`` are the
        lengths that were used. [m]

    Raises
    ------
    EnduranceError
        If the arm is missing, a length or ratio is not a positive number, the tare exceeds the
        load, or a torque of both signs is sampled too slowly or does not reverse with the
        oscillation.

    Examples
    --------
    200 N on an arm of 0.5 m, 40 kN on two cells, a pin of 25 mm:

    >>> log = xr.Dataset(
    ...     {"cells": (("cell", "time"), [[2e4, 2e4], [2e4, 2e4]]),
    ...      "arm_force": ("time", [200.0, 202.0])},
    ...     {"time": [0.0, 1.0]},
    ... )
    >>> measure_friction(log, pin_radius=0.025, arm=0.5).friction.values
    array([0.1  , 0.101])
    """
    require_option(pin_radius=pin_radius, torque_ratio=torque_ratio)
    load = log["cells"].sum("cell").values - tare
    if not np.max(load) > 0:
        raise EnduranceError(
            f"Expected a tare below the reading of the cells, at most {np.max(load) + tare:g} N; "
            f"got {tare:g} N. Correct the tare, or choose other columns for the cells."
        )
    torque = torque_of(log, arm)
    time = log["time"].values
    other_sensors = {name: log[name].values for name in ("temperature", "vibration") if name in log}
    columns = {"load": load, "torque": torque, **other_sensors}
    attributes = {**log.attrs, "pin_radius": pin_radius}
    if "torque" not in log:
        attributes["arm"] = arm

    # both signs, and not only noise about zero
    low, high = np.percentile(torque, _ENDS)
    if min(-low, high) > _REVERSES * max(-low, high):
        time, columns, attributes["period"] = _over_oscillations(time, columns)
    else:
        columns["torque"] = np.abs(torque)

    loaded = columns["load"] > _UNLOADED * np.max(columns["load"])
    friction = np.full(time.size, np.nan)
    friction[loaded] = friction_coefficient(
        columns["torque"][loaded],
        load=columns["load"][loaded],
        radius=pin_radius,
        torque_ratio=torque_ratio,
    )
    units = {"load": "N", "torque": "N m", "temperature": "degree_Celsius", "vibration": "1"}
    if "vibration" in log:
        units["vibration"] = log["vibration"].attrs.get("units", "1")
    measured = xr.Dataset(
        {name: ("time", values, {"units": units[name]}) for name, values in columns.items()},
        {"time": ("time", time, {"units": "s"})},
        attributes,
    )
    measured["friction"] = ("time", friction, {"units": "1"})
    return measured


def require_option(**options: float) -> None:
    """Refuse an option of a command, or a key of its settings, that is not positive.

    Parameters
    ----------
    **options : float

    Raises
    ------
    EnduranceError

    Examples
    --------
    >>> require_option(arm=0.3)
    """
    for name, value in options.items():
        if not 0 < value < np.inf:
            raise EnduranceError(
                f"Expected a positive {name}; got {value:g}. Give its value, with the unit in the "
                "command and the settings."
            )


def torque_of(log: xr.Dataset, arm: float | None) -> Array:
    """Return the torque of a log, or that of the force on the arm which holds it.

    Parameters
    ----------
    log : Dataset
        From `erlif.joint.friction.read_torque_log`.
    arm : float or None
        Arm of the load cell. [m]

    Returns
    -------
    array, (time,)
        [N m]

    Raises
    ------
    EnduranceError
        If neither the torque nor the arm is known, or the arm is not positive.

    Examples
    --------
    >>> torque_of(xr.Dataset({"arm_force": ("time", [400.0])}), 0.3)
    array([120.])
    """
    if arm is not None:
        require_option(arm=arm)
    if "torque" in log:
        torque: Array = log["torque"].values
        return torque
    if arm is None:
        raise EnduranceError(
            "Expected the arm of the load cell whose force is logged; it is not given. Give it: "
            '--arm "30 cm".'
        )
    force: Array = log["arm_force"].values
    return force * arm


def _over_oscillations(
    time: Array, columns: dict[str, Array]
) -> tuple[Array, dict[str, Array], float]:
    """Columns as one value for each two oscillations, and the period of these."""
    torque = columns["torque"]
    low, high = np.percentile(torque, _ENDS)
    positive = torque > 0.5 * (low + high)
    turns = np.flatnonzero(positive[1:] & ~positive[:-1])
    if turns.size <= _CYCLES:
        raise EnduranceError(
            "Expected a torque of both signs to reverse with each oscillation; it becomes positive "
            f"{turns.size} times in the whole log. Log the size of the torque, or take erlif "
            "friction for a motion that reverses now and then."
        )
    period = float(np.median(np.diff(time[turns])))
    interval = float(np.median(np.diff(time)))
    if period < _SAMPLES * interval:
        raise EnduranceError(
            f"Expected a torque that reverses to be sampled at least {_SAMPLES} times in an "
            f"oscillation; it is sampled {period / interval:.1f} times. Record faster, or log the "
            "size of the torque; take erlif friction for a motion that reverses now and then."
        )

    width = _CYCLES * period
    number = np.floor((time - time[0]) / width).astype(int)
    starts = np.flatnonzero(np.diff(number, prepend=-1))
    counts = np.diff(np.append(starts, time.size))
    whole = counts >= 0.9 * width / interval  # gaps and the end leave bins that are not full
    parts = [slice(a, a + n) for a, n in zip(starts[whole], counts[whole], strict=True)]

    def half_difference(inside: Array) -> float:
        above = inside > 0.5 * (inside.max() + inside.min())
        if not above.any():
            return 0.0
        return 0.5 * float(np.median(inside[above]) - np.median(inside[~above]))

    binned = {
        name: np.array(
            [(half_difference if name == "torque" else np.mean)(values[part]) for part in parts]
        )
        for name, values in {"time": time, **columns}.items()
    }
    return binned.pop("time"), binned, period


# Friction coefficients of metal in a bushing, from well lubricated to dry and galled. [1]
#
# No limits of a source: a value beyond them is far more often a slip of units than a bearing.
LOWEST, HIGHEST = 0.005, 1.5


def doubt_friction(
    friction: float, *, radius: float | None = None, arm: float | None = None
) -> list[str]:
    """State what is implausible about a friction coefficient and the lengths it comes from.

    Parameters
    ----------
    friction : float
        Friction coefficient. [1]
    radius : float, optional
        Radius of the pin or shaft. [m]
    arm : float, optional
        Distance of the arm's load cell from the axis. [m]

    Returns
    -------
    list of str
        Lines that begin with "warning:"; none for a plausible coefficient.

    Examples
    --------
    >>> doubt_friction(0.15, radius=0.03336, arm=0.3)
    []
    >>> doubt_friction(0.013, radius=0.4, arm=0.3)
    ['warning: the arm of 300 mm is no longer than the radius of 400 mm; check their units']
    """
    doubts = []
    if not LOWEST <= friction <= HIGHEST:
        where = "" if radius is None else f" of {1e3 * radius:.6g} mm"
        force = "torque" if arm is None else f"arm force, the arm of {1e3 * arm:.6g} mm"
        doubts.append(
            f"warning: a friction coefficient of {friction:.2g} is implausible ({LOWEST:g} to "
            f"{HIGHEST:g} expected). Check the radius{where}, the unit of the {force}, and the "
            "unit of the load"
        )
    if radius is not None and arm is not None and arm <= radius:
        doubts.append(
            f"warning: the arm of {1e3 * arm:.6g} mm is no longer than the radius of "
            f"{1e3 * radius:.6g} mm; check their units"
        )
    return doubts
