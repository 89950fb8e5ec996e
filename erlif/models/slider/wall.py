"""Wall of springs between bushing and pin, by cells: places that carry loads, and worn profiles."""

from __future__ import annotations

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError

# Of the eccentricity that carries the load; it takes 2 to 10.
_NEWTON_STEPS = 100

# Share of the load by which the pressure may miss it.
_BALANCED = 1e-11

# Stiffness all round, over that of a cell: few cells in contact leave a direction open.
_RIDGE = 1e-9

# Share of the missing load that a step may leave to count as closer whatever the energy.
_CLOSER = 0.5


class Wall:
    """Cells on a wall of springs.

    Clearance [m], number of cells, area of a cell [m2] and stiffness of the wall [Pa/m]; an area
    in rad stands for a stiffness of force over displacement and angle.
    """

    def __init__(self, clearance: float, *, cells: int, area: float, stiffness: float) -> None:
        self.clearance, self.area, self.stiffness = clearance, area, stiffness
        self.cells, self.cell = cells, 2 * np.pi / cells
        self.angle = (np.arange(cells) - cells // 2) * self.cell
        self.normal = np.stack([np.cos(self.angle), np.sin(self.angle)])
        self.products = np.einsum("ic,jc->cij", self.normal, self.normal).reshape(cells, 4)

    def value_at(self, values: Array, angle: Array) -> Array:
        """Values (steps, cells) at one angle of each step, linear between cells."""
        whole, share = np.divmod((angle - self.angle[0]) / self.cell, 1.0)
        step, lower = np.arange(angle.size), whole.astype(int) % self.cells
        upper = (lower + 1) % self.cells
        found: Array = (1 - share) * values[step, lower] + share * values[step, upper]
        return found

    def touching(self, worn: Array, place: Array, direction: Array, least: Array) -> Array:
        """Places moved along a direction until the pin overlaps the wall."""
        for _ in range(_NEWTON_STEPS):
            deepest = np.max(place @ self.normal - self.clearance - worn, axis=1)
            apart = deepest <= 0
            if not np.any(apart):
                break
            place = place + direction * np.where(apart, least - deepest, 0.0)[:, None]
        return place

    def balance(
        self, worn: Array, force: Array, softened: float, start: Array
    ) -> tuple[Array, Array]:
        """Places of the pin (n, 2) and pressures (n, cells) that carry the forces (n, 2).

        The place is where the energy of the wall less the work of the force is least. This energy
        is convex; Newton's method with a ridge that grows until the energy falls (Levenberg and
        Marquardt) finds it from anywhere.
        """
        bears = self.stiffness / softened * self.area
        size = np.hypot(*force.T)
        base = self.touching(worn, start, force / size[:, None], size / bears)
        overlap, missing, energy = self._meet(worn, force, bears, base)
        ridge = np.full(size.shape, _RIDGE)
        for _ in range(_NEWTON_STEPS):
            if np.all(np.hypot(*missing.T) <= _BALANCED * size):
                return base, np.maximum(overlap, 0.0) * bears / self.area
            stiffness = ((overlap > 0) @ self.products).reshape(-1, 2, 2)
            stiffness = bears * (stiffness + ridge[:, None, None] * np.eye(2))
            step = np.linalg.solve(stiffness, missing[:, :, None])[:, :, 0]
            tried, missing_there, energy_there = self._meet(worn, force, bears, base + step)

            # at the end the energy changes by less than its rounding, the missing load by more
            lower = energy_there < energy
            lower |= np.hypot(*missing_there.T) < _CLOSER * np.hypot(*missing.T)
            ridge = np.where(lower, np.maximum(ridge / 10, _RIDGE), np.maximum(10 * ridge, 1e-3))
            keep = lower[:, None]
            base, overlap = np.where(keep, base + step, base), np.where(keep, tried, overlap)
            missing = np.where(keep, missing_there, missing)
            energy = np.where(lower, energy_there, energy)
        raise ModelError(
            "The pressure on the wall does not carry the joint force: check modulus, thickness and "
            "force, or choose more cells."
        )

    def _meet(
        self, worn: Array, force: Array, bears: float, place: Array
    ) -> tuple[Array, Array, Array]:
        """Overlap by cells, load that the wall does not carry, and energy less work."""
        overlap = place @ self.normal - self.clearance - worn
        pressed = np.maximum(overlap, 0.0)
        missing = force - bears * pressed @ self.normal.T
        energy = bears / 2 * np.sum(pressed**2, axis=1) - np.sum(force * place, axis=1)
        return overlap, missing, energy


class PinCells:
    """Cells of the pin seen from the cells of the bushing, at each step of a cycle.

    Between cells the depth is linear; what is worn is divided by the same shares, so that nothing
    is lost.
    """

    def __init__(self, wall: Wall, turned: Array) -> None:
        # a place of the bushing lies on the pin further back by the turn of the pin
        whole, self.share = np.divmod(-turned / wall.cell, 1.0)
        lower = np.arange(wall.cells) + whole.astype(int)[:, None]
        self.lower, self.upper = lower % wall.cells, (lower + 1) % wall.cells

    def gather(self, depth: Array) -> Array:
        """Depth of the pin at every cell of the bushing; (steps, cells)."""
        share = self.share[:, None]
        found: Array = (1 - share) * depth[self.lower] + share * depth[self.upper]
        return found

    def scatter(self, worn: Array) -> Array:
        """Sum over the steps of what is worn at the cells of the bushing; (cells,)."""
        share, cells = self.share[:, None], worn.shape[1]
        kept = np.bincount(self.lower.ravel(), ((1 - share) * worn).ravel(), cells)
        passed_on = np.bincount(self.upper.ravel(), (share * worn).ravel(), cells)
        return np.asarray(kept + passed_on, float)
