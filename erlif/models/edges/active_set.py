"""Pressure that closes a gap and nowhere pulls: conjugate gradients on the cells in contact.

Polonsky and Keer (1999), for cells of any size: the gap of each is weighed by its own compliance.
The deflection is linear in the pressure, and symmetric for cells weighted by their areas. Where
cells touch, gap plus deflection equals a motion of the rigid body; elsewhere the gap is open and
the pressure is zero.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array, Mask
from erlif.core.errors import ModelError


@dataclass(frozen=True)
class Contact:
    """Solution of a contact problem.

    Attributes
    ----------
    pressure : array
        Pressure of the cells. [Pa]
    deflection : array
        Deflection of both bodies under it. [m]
    motion : array, (mode,)
        Amplitude of each rigid mode.
    iterations : int
        Steps of the conjugate gradients.
    residual : float
        Largest error of the gap, over the deflection of a cell under its own largest pressure. [1]
    """

    pressure: Array
    deflection: Array
    motion: Array
    iterations: int
    residual: float


def solve_active_set(
    deflect: Callable[[Array], Array],
    gap: Array,
    *,
    diagonal: Array | float,
    modes: Array,
    area: Array | float = 1.0,
    targets: Array | None = None,
    motion: Array | None = None,
    start: Array | None = None,
    tolerance: float = 1e-5,
    most_iterations: int = 2000,
) -> Contact:
    """Find the pressure of a frictionless contact of given load or given motion.

    Parameters
    ----------
    deflect : callable
        Deflection of a pressure, for arrays of the shape of `gap`.
    gap : array
        Gap of the undeformed bodies. [m]
    diagonal : float or array
        Deflection of a cell under unit pressure on itself. [m/Pa]
    modes : array, (mode, ...)
        Approach of the surfaces in each rigid mode; the first is the translation.
    area : float or array
        Areas of the cells. [m2]
    targets : array, (mode,), optional
        Sum of pressure times area times each mode, where the loads are given. [N, N m]
    motion : array, (mode,), optional
        Amplitudes of the modes, where the motion is given.
    start : array, optional
        First pressure. [Pa]
    tolerance : float
        Residual at which the search ends. [1]
    most_iterations : int
        Steps after which the search is given up.

    Returns
    -------
    Contact
        Pressure, deflection and motion.

    Raises
    ------
    ModelError
        A load that no contact carries, or no convergence.

    Examples
    --------
    Two springs of unit stiffness; only the higher one carries a small load:

    >>> contact = solve_active_set(
    ...     lambda p: p, np.array([0.0, 2.0]), diagonal=1.0, modes=np.ones((1, 2)), targets=[1.0]
    ... )
    >>> contact.pressure, contact.motion
    (array([1., 0.]), array([1.]))
    """
    weight = np.broadcast_to(np.asarray(area, float), gap.shape)
    own = np.broadcast_to(np.asarray(diagonal, float), gap.shape)
    free = targets is not None
    aims = np.asarray(targets if free else [], dtype=float)
    fixed = np.tensordot(np.asarray(motion, float), modes, 1) if not free else np.zeros(gap.shape)

    def rigid(values: Array, touching: Mask) -> Array:
        """Modes that leave a rest of the gap whose pressures, over `own`, carry no load."""
        inside = modes[:, touching] * (weight / own)[touching]
        matrix = inside @ modes[:, touching].T
        found: Array = np.linalg.lstsq(matrix, inside @ values[touching], rcond=1e-14)[0]
        return found

    def carry(pressure: Array) -> Array:
        """Factor, one and the tilts, by which the pressure carries the loads."""
        touching = pressure > 0
        loaded = modes[:, touching] * (weight[touching] * pressure[touching])
        if len(modes) == 1:
            return np.asarray(aims[0] / loaded.sum())
        tilts = modes[:, touching] / modes[0, touching]
        factor = np.zeros(gap.shape)
        factor[touching] = np.linalg.lstsq(loaded @ tilts.T, aims, rcond=1e-14)[0] @ tilts
        return factor

    pressure = np.maximum(start, 0.0) if start is not None else np.full(gap.shape, float(free))
    if free:
        pressure = np.maximum(pressure * carry(pressure), 0.0)
    direction, deflection = np.zeros(gap.shape), np.zeros(gap.shape)
    last_square, keep, known, shrunk = 1.0, False, False, False

    for step in range(most_iterations + 1):
        touching = pressure > 0
        if not known:
            deflection = deflect(pressure)
        residual = gap + deflection - fixed
        if free:
            amplitudes = rigid(residual, touching)
            residual -= np.tensordot(amplitudes, modes, 1)

        # a closed gap where cells touch, an open one elsewhere
        wrong = np.where(touching, np.abs(residual), np.maximum(-residual, 0.0)) / own
        peak = float(pressure.max())
        error = float(wrong.max()) / peak if peak > 0 else float(wrong.max() > 0) * np.inf
        if error <= tolerance and known:
            known, keep = False, False  # the deflection was updated; compute it once more
            continue
        if error <= tolerance:
            found = amplitudes if free else np.asarray(motion, float)
            return Contact(pressure, deflection, found, step, error)
        if peak == 0:  # a given motion starts from the cells that overlap
            pressure = np.maximum(-residual, 0.0) / own
            continue

        # conjugate direction within the contact, and the step that minimises along it
        missing = residual / own
        square = float(np.sum((weight * residual * missing)[touching]))
        turn = square / last_square if keep else 0.0
        direction = np.where(touching, missing + turn * direction, 0.0)
        if free and turn and shrunk:  # cells that left took a part of the load with them
            lost = np.tensordot(rigid(direction * own, touching), modes, 1) / own
            direction = np.where(touching, direction - lost, 0.0)
        raw = deflect(direction)
        along = float(np.sum((weight * direction * raw)[touching]))
        if free and np.count_nonzero(touching) <= len(modes):
            # so few cells follow any motion; others have to join them
            direction, length = np.zeros(gap.shape), 1.0
        elif along <= 0:
            raise ModelError(
                "The contact has no solution: its deflection is not positive for every pressure; "
                "check that gap, loads and cells are in SI units."
            )
        else:
            length = float(np.sum((weight * residual * direction)[touching])) / along
        pressure = pressure - length * direction
        leaving = pressure < 0
        pressure[leaving] = 0.0
        shrunk = bool(leaving.any())

        # cells that overlap join the contact, and the directions start anew
        joining = (pressure == 0) & (residual < 0)
        pressure[joining] = -length * missing[joining]
        last_square, keep = square, not joining.any()

        # the deflection follows from that of the step as long as the contact stays the same
        known = keep and not shrunk and len(modes) == 1
        if known:
            deflection = deflection - length * raw
        if free:
            factor = carry(pressure)
            pressure = np.maximum(pressure * factor, 0.0)
            deflection = deflection * factor
    raise ModelError(
        f"The contact has not settled after {most_iterations} iterations (residual {error:.1e}, "
        f"asked for {tolerance:.1e}); use fewer cells or a larger tolerance."
    )
