"""Contact of pin and bushing: a Winkler wall, and the law of eqs. 12 and 13 in two bores.

Mukras et al. (2008). A bore gives the elastic force of an eccentric pin as the gradient of its
energy, so that the motion keeps the balance of energy whatever the shape, round or worn.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, sqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.models.arguments import check_fields

if TYPE_CHECKING:
    import xarray as xr

# Of the eccentricity that carries the load; it takes 2 to 10.
_NEWTON_STEPS = 100

# Share of the load by which the pressure may miss it.
_BALANCED = 1e-11

# Stiffness all round, over that of a cell: few cells in contact leave a direction open.
_RIDGE = 1e-9

# Share of the missing load that a step may leave to count as closer whatever the energy.
_CLOSER = 0.5

# Cells of a profile at least: fewer do not resolve a contact.
_FEWEST_CELLS = 24


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
        """Compute overlap of the cells, load not carried, and energy less work."""
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


@dataclass(frozen=True)
class ContactLaw:
    """Contact of pin and bushing in the general joint. Mukras et al. (2008), eqs. 12 and 13.

    The force is that of `erlif.models.contact.impact_force`, with a rate of penetration of the
    speed of the touch at most.

    Attributes
    ----------
    stiffness : float
        K, see `erlif.models.contact.impact_stiffness`. [N/m^1.5]
    restitution : float
        Coefficient of restitution, 0 to 1. [1]
    slowest_impact : float
        Speed below which a touch is damped as one of this speed. [m/s]

    Raises
    ------
    ModelError
        A stiffness or speed that is not one positive number, or a restitution outside 0 to 1.

    Notes
    -----
    The damping of the law is divided by the speed of the touch, so a pin laid down at no speed
    would stand still: `slowest_impact` ends the law there. A pin that strikes the bore without
    having left it penetrates faster than at its last touch, and the force of the law would be many
    times the elastic one: the rate counts as the speed of the touch at most. In an impact of a free
    body it never is more. The source does not state what was done.
    """

    stiffness: float
    restitution: float = 0.8
    slowest_impact: float = 0.01

    def __post_init__(self) -> None:
        check_fields(self, slowest_impact="number")


class Press(NamedTuple):
    """Elastic contact of the pin at a place in its bushing.

    Attributes
    ----------
    penetration : float
        Deepest overlap of pin and bushing, negative while they are apart. [m]
    force : float
        Elastic force. [N]
    x : float
        Its direction on the bushing along the line of the slider. [1]
    y : float
        Its direction across that line. [1]
    twist : float
        Couple by which the profile of the pin resists its turning, over the force. [m]
    energy : float
        Elastic energy. [J]
    """

    penetration: float
    force: float
    x: float
    y: float
    twist: float
    energy: float


class RoundBore:
    """Unworn bushing: F = K d^1.5 along the eccentricity. Mukras et al. (2008), eq. 12.

    The eccentricity is pin centre less bushing centre; `cp` and `sp` are cosine and sine of the rod
    angle and `turned` is the angle of the crank against the rod. [m, rad]
    """

    #: Share of the penetration by which the sliding surface lies within the pin: the bore.
    sunk = 1.0

    def __init__(self, law: ContactLaw, clearance: float) -> None:
        self.stiffness, self.clearance = law.stiffness, clearance

    def press(self, ex: float, ey: float, _cp: float, _sp: float, _turned: float) -> Press:
        """Elastic contact at an eccentricity."""
        reach = hypot(ex, ey)
        nx, ny = (ex / reach, ey / reach) if reach else (1.0, 0.0)
        depth = reach - self.clearance
        if depth <= 0:
            return Press(depth, 0.0, nx, ny, 0.0, 0.0)
        force = self.stiffness * depth * sqrt(depth)
        return Press(depth, force, nx, ny, 0.0, 0.4 * force * depth)

    def rest(
        self, force_x: float, force_y: float, _cp: float, _sp: float, _turned: float
    ) -> tuple[float, float]:
        """Displacement of the pin at which the contact carries a force, (x, y). [m]"""
        force = hypot(force_x, force_y)
        reach = self.clearance + (force / self.stiffness) ** (2 / 3)
        return reach * force_x / (force or 1.0), reach * force_y / (force or 1.0)


class WornBore:
    """Bushing and pin with worn profiles: a wall of springs, of which each bears its own overlap.

    The wall bears k int max(overlap, 0) n d(angle). In the round bore of clearance c a shallow
    overlap is d - c angle^2 / 2, and the integral is (4 sqrt(2) / 3) k d^1.5 / sqrt(c): the law of
    eq. 12, with the clearance where eq. 13 has it. This fixes k for the K of the law.

    The profiles are those of `erlif.joint.models.slider_wear.wear_slider_crank`; arguments are
    those of `RoundBore`.
    """

    sunk = 0.0  #: the wall yields to the pin, so that they slide on the surface of the pin

    def __init__(self, law: ContactLaw, clearance: float, worn: xr.Dataset) -> None:
        depth, pin_depth, angle = _profiles(worn)
        if not clearance > 0:
            raise ModelError(
                "clearance must be positive where the joint is worn: the stiffness of eq. 13 "
                f"belongs to an unworn clearance, got {clearance:g} m."
            )
        stiffness = 3 / (4 * sqrt(2)) * law.stiffness * sqrt(clearance)
        cell = 2 * np.pi / angle.size
        self.wall = Wall(clearance, cells=angle.size, area=cell, stiffness=stiffness)
        self.worn = clearance + depth
        self.bears = stiffness * cell
        self.pin = _PinProfile(pin_depth) if np.any(pin_depth != 0) else None

    def press(self, ex: float, ey: float, cp: float, sp: float, turned: float) -> Press:
        """Elastic contact at an eccentricity."""
        along, across = -(ex * cp + ey * sp), ex * sp - ey * cp
        overlap = np.array((along, across)) @ self.wall.normal - self.worn
        slope = None
        if self.pin:
            pin_depth, slope = self.pin.at(turned)
            overlap -= pin_depth
        deepest = int(overlap.argmax())
        depth = float(overlap[deepest])
        if depth <= 0:
            gx, gy = self.wall.normal[:, deepest].tolist()
            twist = float(slope[deepest]) if slope is not None else 0.0
            return Press(depth, 0.0, sp * gy - cp * gx, -sp * gx - cp * gy, twist, 0.0)

        # force and couple are the derivatives of the energy of the springs
        np.maximum(overlap, 0.0, out=overlap)
        gx, gy = (self.wall.normal @ overlap).tolist()
        size = hypot(gx, gy)
        gx, gy = gx / size, gy / size
        return Press(
            depth,
            self.bears * size,
            sp * gy - cp * gx,
            -sp * gx - cp * gy,
            float(overlap @ slope) / size if slope is not None else 0.0,
            0.5 * self.bears * float(overlap @ overlap),
        )

    def rest(
        self, force_x: float, force_y: float, cp: float, sp: float, turned: float
    ) -> tuple[float, float]:
        """Displacement of the pin at which the contact carries a force, (x, y). [m]"""
        force = np.array([[-(force_x * cp + force_y * sp), force_x * sp - force_y * cp]])
        worn = self.worn - self.wall.clearance
        if self.pin:
            worn = worn + self.pin.at(turned)[0]
        start = force / np.hypot(*force[0]) * self.wall.clearance
        place, _ = self.wall.balance(worn[None], force, 1.0, start)
        along, across = place[0].tolist()
        return across * sp - along * cp, -along * sp - across * cp


class _PinProfile:
    """Depth of the pin and its slope at the cells of the bushing, smooth between cells."""

    def __init__(self, depth: Array) -> None:
        from scipy.interpolate import CubicSpline

        self.cells, self.cell = depth.size, 2 * np.pi / depth.size
        spline = CubicSpline(
            np.arange(depth.size + 1) * self.cell, np.append(depth, depth[0]), bc_type="periodic"
        )
        # twice round, so that any turn is one slice
        self.powers = np.concatenate([spline.c, spline.c], axis=1)

    def at(self, turned: float) -> tuple[Array, Array]:
        """Depth [m] and slope [m/rad] where the cells of the bushing are."""
        whole, share = divmod(-turned / self.cell, 1.0)
        first = int(whole) % self.cells
        c3, c2, c1, c0 = self.powers[:, first : first + self.cells]
        x = share * self.cell
        return ((c3 * x + c2) * x + c1) * x + c0, (3 * c3 * x + 2 * c2) * x + c1


def _profiles(worn: xr.Dataset) -> tuple[Array, Array, Array]:
    """Depths of bushing and pin and the angles of their cells, which go round once."""
    missing = {"depth", "pin_depth", "angle"} - set(worn.variables)
    if missing or worn["depth"].dims != ("angle",):
        raise ModelError(
            "worn must be one profile of wear_slider_crank, with depth and pin_depth over angle: "
            "choose a number of cycles with isel(cycle=-1)."
        )
    depth, pin_depth = worn.depth.values.astype(float), worn.pin_depth.values.astype(float)
    angle, cells = worn.angle.values, depth.size
    expected = (np.arange(cells) - cells // 2) * 2 * np.pi / cells
    if cells < _FEWEST_CELLS or not np.allclose(angle, expected):
        raise ModelError(
            f"worn must have {_FEWEST_CELLS} cells or more that go round the bushing once, evenly "
            f"and with one at angle 0, got {cells}."
        )
    if not (np.all(depth >= 0) and np.all(pin_depth >= 0)):
        raise ModelError("worn must have depths that are numbers and not negative.")
    return depth, pin_depth, angle
