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

# Steps after which the search is given up.
MOST_ITERATIONS = 2000


@dataclass(frozen=True)
class CellContact:
    """Solution of a contact problem.

    Attributes
    ----------
    pressure, deflection : array
        Pressure of the cells [Pa], and deflection of both bodies under it [m].
    gap : array
        Gap that remains. [m]
    motion : array, (mode,)
        Amplitude of each rigid mode.
    iterations : int
        Steps of the conjugate gradients.
    residual : float
        Largest error of the gap, over the deflection of a cell under its own largest pressure. [1]
    """

    pressure: Array
    deflection: Array
    gap: Array
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
) -> CellContact:
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

    Returns
    -------
    CellContact
        Pressure, deflection and motion; without pressure where a given motion leaves a gap
        everywhere.

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
    cells = _Cells(
        np.broadcast_to(np.asarray(area, float), gap.shape),
        np.broadcast_to(np.asarray(diagonal, float), gap.shape),
        modes,
    )
    free = targets is not None
    aims = np.asarray(targets if free else [], dtype=float)
    amplitudes = np.asarray([0.0] * len(modes) if free else motion, float)

    pressure = np.maximum(start, 0.0) if start is not None else np.full(gap.shape, float(free))
    if free:
        pressure = np.maximum(pressure * cells.load_factor(pressure, aims), 0.0)
    direction, deflection = np.zeros(gap.shape), np.zeros(gap.shape)
    last_square, keep, known, shrunk = 1.0, False, False, False

    for step in range(MOST_ITERATIONS + 1):
        # the gap that the pressure leaves, less the motion of the body: given, or the best one
        touching = pressure > 0
        if not known:
            deflection = deflect(pressure)
        residual = gap + deflection
        if free:
            amplitudes = cells.fit_motion(residual, touching)
        residual -= np.tensordot(amplitudes, modes, 1)

        error = cells.largest_error(residual, pressure)
        if error <= tolerance and known:
            known, keep = False, False  # the deflection was updated; compute it once more
            continue
        if error <= tolerance:
            return CellContact(pressure, deflection, residual, amplitudes, step, error)
        if not touching.any():  # a given motion starts from the cells that overlap
            pressure = np.maximum(-residual, 0.0) / cells.own
            continue

        # conjugate direction within the contact
        missing = residual / cells.own
        square = float(np.sum((cells.area * residual * missing)[touching]))
        turn = square / last_square if keep else 0.0
        direction = np.where(touching, missing + turn * direction, 0.0)
        if free and turn and shrunk:  # cells that left took a part of the load with them
            lost = np.tensordot(cells.fit_motion(direction * cells.own, touching), modes, 1)
            direction = np.where(touching, direction - lost / cells.own, 0.0)

        # the step that minimises the energy along it; what would pull leaves the contact
        raw = deflect(direction)
        along = float(np.sum((cells.area * direction * raw)[touching]))
        if free and np.count_nonzero(touching) <= len(modes):
            # so few cells follow any motion; others have to join them
            direction, length = np.zeros(gap.shape), 1.0
        elif along <= 0:
            raise ModelError(
                "The contact has no solution: its deflection is not positive for every pressure; "
                "check that gap, loads and cells are in SI units."
            )
        else:
            length = float(np.sum((cells.area * residual * direction)[touching])) / along
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
            factor = cells.load_factor(pressure, aims)
            pressure = np.maximum(pressure * factor, 0.0)
            deflection = deflection * factor
    raise ModelError(
        f"The contact has not settled after {MOST_ITERATIONS} iterations (residual {error:.1e}, "
        f"asked for {tolerance:.1e}); use fewer cells or a larger tolerance."
    )


@dataclass(frozen=True)
class _Cells:
    """Cells of a contact: areas, deflections under their own unit pressure, rigid modes."""

    area: Array
    own: Array
    modes: Array

    def fit_motion(self, values: Array, touching: Mask) -> Array:
        """Fit the modes to values of the touching cells, weighted by cell area over `own`."""
        inside = self.modes[:, touching] * (self.area / self.own)[touching]
        matrix = inside @ self.modes[:, touching].T
        return np.asarray(
            np.linalg.lstsq(matrix, inside @ values[touching], rcond=1e-14)[0], dtype=float
        )

    def load_factor(self, pressure: Array, aims: Array) -> Array:
        """Factor, one and the tilts, by which the pressure carries the loads."""
        touching = pressure > 0
        loaded = self.modes[:, touching] * (self.area[touching] * pressure[touching])
        if len(self.modes) == 1:
            return np.asarray(aims[0] / loaded.sum())
        tilts = self.modes[:, touching] / self.modes[0, touching]
        factor = np.zeros(pressure.shape)
        factor[touching] = np.linalg.lstsq(loaded @ tilts.T, aims, rcond=1e-14)[0] @ tilts
        return factor

    def largest_error(self, residual: Array, pressure: Array) -> float:
        """Largest gap of touching cells or overlap of others, relative to the largest pressure."""
        size = np.where(pressure > 0, np.abs(residual), np.maximum(-residual, 0.0))
        wrong, peak = float((size / self.own).max()), float(pressure.max())
        if peak == 0:  # bodies apart from each other have no error, others have yet to touch
            return np.inf if wrong > 0 else 0.0
        return wrong / peak
