"""Wear round the bushing and on the pin of a slider-crank joint, with the geometry updated.

The procedure is that of Mukras et al. (2008), figures 1 and 11: forces of one cycle, pressure,
wear by Archard's law, new geometry, and one computed cycle for many. Finite elements are replaced
by a Winkler wall (Colbert et al. 2009, B1 to B3).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.models.arguments import (
    Values,
    check_length,
    check_modulus,
    check_specific_wear,
    require_not_negative,
    require_positive,
    require_single,
)
from erlif.models.mechanism import SliderCrank
from erlif.models.reaction import SliderCrankBodies, joint_reaction

if TYPE_CHECKING:
    import xarray as xr

_NEWTON_STEPS = 100
"""Of the eccentricity that carries the load; it takes 2 to 10."""

_BALANCED = 1e-11
"""Share of the load by which the pressure may miss it."""

_RIDGE = 1e-9
"""Stiffness all round, over that of a cell: few cells in contact leave a direction open."""

_UNLOADED = 1e-9
"""Share of the greatest force below which a joint carries nothing: free flight."""

_SAFETY, _CAUTION = 1.25, 3.0
"""Factors of Roache (1994) on an estimated error, with an order as expected and without."""

_EXPECTED_ORDER = (0.8, 1.25)
"""Range of observed orders that counts as the first order of the extrapolation."""


@dataclass(frozen=True)
class WearingJoint:
    """Bushing and pin that wear. A value not positive (wear rates: negative) is refused.

    Attributes
    ----------
    width : float
        Width of the bushing. [m]
    thickness : float
        Thickness of its wall. [m]
    modulus : float
        E' of the wall, see `erlif.models.contact.winkler_modulus`. [Pa]
    specific_wear : float
        Specific wear rate of the bushing. [1/Pa]
    pin_specific_wear : float
        Specific wear rate of the pin. [1/Pa]
    """

    width: float
    thickness: float
    modulus: float
    specific_wear: float
    pin_specific_wear: float = 0.0

    def __post_init__(self) -> None:
        _require_numbers(**vars(self))
        require_positive(width=self.width, thickness=self.thickness, modulus=self.modulus)
        require_not_negative(
            specific_wear=self.specific_wear, pin_specific_wear=self.pin_specific_wear
        )
        check_length(width=self.width, thickness=self.thickness)
        check_modulus(modulus=self.modulus)
        check_specific_wear(specific_wear=self.specific_wear)


def wear_slider_crank(
    linkage: SliderCrank,
    *,
    crank_speed: float,
    bodies: SliderCrankBodies,
    joint: WearingJoint,
    cycles: int,
    extrapolation: int = 500,
    coupled: bool = True,
    simulated: xr.Dataset | None = None,
    steps_per_cycle: int = 72,
    cells: int = 360,
) -> xr.Dataset:
    """Wear the crank-pin joint of a slider-crank round its bushing and on its pin.

    Mukras et al. (2008), eqs. 4, 5 and 20. At each crank angle of a cycle the pressure on the wall
    carries the normal force. Depths on bushing and pin grow by k p ds, and the cycle stands for the
    next `extrapolation` cycles. The eccentricity of the pin in tension lengthens the rod.

    Parameters
    ----------
    linkage : SliderCrank
        Lengths and unworn clearance. [m]
    crank_speed : float
        Speed of the crank. [rad/s]
    bodies : SliderCrankBodies
        Masses, spring, friction and the radius of the pin, single numbers.
    joint : WearingJoint
        Wall and wear rates.
    cycles : int
        Cycles to the end of the test.
    extrapolation : int
        Cycles for which one computed cycle stands, A_E of eq. 5.
    coupled : bool
        False keeps the joint unworn in the dynamics.
    simulated : xarray.Dataset, optional
        Turn of `erlif.models.slider_dynamics.simulate_slider_crank`, from its first time to its
        last, whose forces stand for all cycles. Default: inverse dynamics of the joint with
        continuous contact.
    steps_per_cycle : int
        Crank angles of a cycle by inverse dynamics.
    cells : int
        Cells round bushing and pin.

    Returns
    -------
    xarray.Dataset
        Over `cycle`: worn_volume and pin_volume [m3], greatest_depth and pin_greatest_depth [m],
        clearance in tension [m], greatest_force [N], rubbing of a cycle [N m] and torque_ratio [1],
        pressure over load; with `angle` also depth and pin_depth [m]. The angle of the bushing is 0
        where the rod in tension bears and grows with the crank angle; that of the pin is measured
        from the same place at crank angle 0.

    Raises
    ------
    ModelError
        A value outside its range, a wall that is worn through, or a contact narrower than the
        cells resolve.

    Warns
    -----
    RangeWarning
        Where the rod is in compression although continuous contact presumes tension.

    Notes
    -----
    Within a step the wall is softened by the wear to come, so that a step of any length is stable;
    its error falls with the first power of `extrapolation`, see `bound_extrapolation`. Debris is
    neglected, the worn wall keeps its stiffness, and clearance and depths are small against the
    radius: the overlap of the round parts is e cos - c.

    Examples
    --------
    The first test of the source with a preload of 60 N in a bushing of 8.5 mm:

    >>> bodies = SliderCrankBodies(
    ...     rod_mass=0.8175,
    ...     rod_inertia=5500e-6,
    ...     slider_mass=5.5487,
    ...     spring_stiffness=525.4,
    ...     spring_preload=60.0,
    ...     pin_radius=9.525e-3,
    ... )
    >>> worn = wear_slider_crank(
    ...     SliderCrank(crank=0.0762, coupler=0.2032, clearance=10e-6),
    ...     crank_speed=np.pi,
    ...     bodies=bodies,
    ...     joint=WearingJoint(8.5e-3, thickness=3e-3, modulus=260e6, specific_wear=5.05e-13),
    ...     cycles=32_000,
    ...     extrapolation=2000,
    ... )
    >>> print(f"{worn.worn_volume[-1] * 2200 * 1e3:.2f} g")
    0.27 g
    """
    _require_numbers(
        crank_speed=crank_speed,
        cycles=cycles,
        extrapolation=extrapolation,
        steps_per_cycle=steps_per_cycle,
        cells=cells,
        **vars(bodies),
    )
    whole = {
        "cycles": cycles,
        "extrapolation": extrapolation,
        "steps_per_cycle": steps_per_cycle,
        "cells": cells,
    }
    for name, value in whole.items():
        if not value % 1 == 0:
            raise ModelError(f"{name} must be a whole number, got {value:g}.")
    require_positive(
        crank_speed=crank_speed,
        cycles=cycles,
        extrapolation=extrapolation,
        steps_per_cycle=steps_per_cycle,
        cells=cells,
        pin_radius=bodies.pin_radius,
    )

    def cycle_of(clearance: float) -> _Cycle:
        if simulated is not None:
            return _simulated_cycle(simulated)
        longer = replace(linkage, clearance=clearance if coupled else linkage.clearance)
        return _reaction_cycle(longer, crank_speed, bodies, steps_per_cycle)

    wall = _Wall(linkage.clearance, bodies.pin_radius, joint, cells)
    return _wear(wall, cycle_of, cycles, extrapolation)


def bound_extrapolation(
    extrapolation: int, *, wear: Callable[[int], xr.Dataset], halvings: int = 2
) -> xr.Dataset:
    """Bound the error that an extrapolation factor makes, by halving it. Roache (1994).

    The error of a first-order step falls with the step, so that the last change by halving
    estimates what is left. The bound is 1.25 times this where the changes fall with the first
    order, 3 times where they do not.

    Parameters
    ----------
    extrapolation : int
        Largest extrapolation factor, A_E of Mukras et al. (2008), eq. 5.
    wear : callable
        `wear_slider_crank` as a function of the extrapolation factor.
    halvings : int
        Number of halvings, 2 or more.

    Returns
    -------
    xarray.Dataset
        Over `extrapolation`, falling: worn_volume [m3] and greatest_depth [m] at the end, and of
        each the limit for small steps, the order of convergence and the bound of the error of
        every factor, by the names of the two with the endings _limit, _order and _bound.

    Raises
    ------
    ModelError
        Fewer than two halvings, or a factor that cannot be halved as often.

    Examples
    --------
    A quantity that is off by 1 % at a factor of 1000 and has the first order:

    >>> import xarray as xr
    >>> def wear(factor):
    ...     value = ("cycle", [0.0, 1.0 + 1e-5 * factor])
    ...     return xr.Dataset({"worn_volume": value, "greatest_depth": value})
    >>> found = bound_extrapolation(1000, wear=wear)
    >>> print(f"{found.worn_volume_limit:.6f} {found.worn_volume_bound[0]:.4f}")
    1.000000 0.0125
    """
    import xarray as xr

    if halvings < 2 or extrapolation < 2**halvings:
        raise ModelError(
            f"halvings must be 2 or more and leave a factor of 1 at least, got {halvings} of "
            f"{extrapolation}."
        )
    factors = [extrapolation // 2**k for k in range(halvings + 1)]
    ends = [wear(factor).isel(cycle=-1) for factor in factors]
    found: dict[str, Values] = {}
    for name, unit in (("worn_volume", "m3"), ("greatest_depth", "m")):
        values = np.array([float(end[name]) for end in ends])
        earlier, last = values[-3] - values[-2], values[-2] - values[-1]
        order = float(np.log2(earlier / last)) if earlier * last > 0 else float("nan")
        as_expected = _EXPECTED_ORDER[0] <= order <= _EXPECTED_ORDER[1]

        # by the first order the last change is what is left
        limit = values[-1] - last
        bound = (_SAFETY if as_expected else _CAUTION) * np.maximum(abs(values - limit), abs(last))
        found[name] = ("extrapolation", values, {"units": unit})
        found[f"{name}_limit"] = ((), limit, {"units": unit})
        found[f"{name}_order"] = ((), order, {"units": "1"})
        found[f"{name}_bound"] = ("extrapolation", bound, {"units": unit})
    return xr.Dataset(found, {"extrapolation": ("extrapolation", factors, {"units": "1"})})


@dataclass(frozen=True)
class _Cycle:
    """One cycle of the joint, step by step."""

    normal: Array  # normal force [N]
    place: Array  # its direction in the bushing, 0 in tension [rad]
    turned: Array  # pin against bushing [rad]
    sliding: Array  # sliding distance of the step [m]


def _reaction_cycle(
    linkage: SliderCrank, crank_speed: float, bodies: SliderCrankBodies, steps: int
) -> _Cycle:
    # the end of a cycle is the start of the next, so it is not sampled twice
    angle = np.linspace(0, 2 * np.pi, steps, endpoint=False)
    found = joint_reaction(linkage, crank_angle=angle, crank_speed=crank_speed, bodies=bodies)
    rate = linkage.joint_speed(angle, crank_speed=crank_speed)

    # friction turns the force away from the normal
    phi = linkage.coupler_angle(angle)
    direction = np.arctan2(-found.force_y, -found.force_x) - phi
    direction -= np.sign(rate) * np.arctan(bodies.friction)
    sliding = bodies.pin_radius * np.abs(rate) * 2 * np.pi / crank_speed / steps
    return _Cycle(found.normal, direction, linkage.joint_angle(angle), sliding)


def _simulated_cycle(found: xr.Dataset) -> _Cycle:
    """Cycle of a simulation; steps lie around its samples, half a step at both ends."""
    missing = {"normal", "contact_angle", "slip_speed", "rod_angle"} - set(found.variables)
    if missing:
        raise ModelError(
            "simulated must be a result of simulate_slider_crank; it lacks "
            f"{', '.join(sorted(missing))}."
        )
    step = np.diff(found.time.values)
    share = (np.concatenate([[0.0], step]) + np.concatenate([step, [0.0]])) / 2
    return _Cycle(
        found.normal.values,
        found.contact_angle.values,
        (found.crank_angle - found.rod_angle).values,
        share * np.abs(found.slip_speed.values),
    )


class _Wall:
    """Bushing and pin by cells, and the pressure between them."""

    def __init__(self, clearance: float, radius: float, joint: WearingJoint, cells: int) -> None:
        self.clearance, self.radius, self.joint = clearance, radius, joint
        self.cells, self.cell = cells, 2 * np.pi / cells
        self.angle = (np.arange(cells) - cells // 2) * self.cell
        self.normal = np.stack([np.cos(self.angle), np.sin(self.angle)])
        self.products = np.einsum("ic,jc->cij", self.normal, self.normal).reshape(cells, 4)
        self.area = radius * self.cell * joint.width
        self.stiffness = joint.modulus / joint.thickness

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

        Newton's method with halved steps where it overshoots.
        """
        stiffness = self.stiffness / softened
        size = np.hypot(*force.T)
        ridge = _RIDGE * stiffness * self.area * np.eye(2)
        base = self.touching(worn, start, force / size[:, None], size / (stiffness * self.area))
        step, best = np.zeros_like(start), np.full(size.shape, np.inf)
        share = np.ones(size.shape)
        for _ in range(_NEWTON_STEPS):
            place = base + share[:, None] * step
            overlap = place @ self.normal - self.clearance - worn
            pressure = stiffness * np.maximum(overlap, 0.0)
            missing = force - self.area * pressure @ self.normal.T
            error = np.hypot(*missing.T)
            if np.all(error <= _BALANCED * size):
                return place, pressure

            # where the pin misses the load by more than before, half the way is tried
            closer = (error < best) & np.any(pressure > 0, axis=1)
            share = np.where(closer, 1.0, share / 2)
            active = (overlap > 0) * (stiffness * self.area)
            matrix = (active @ self.products).reshape(-1, 2, 2) + ridge
            new = np.linalg.solve(matrix, missing[:, :, None])[:, :, 0]
            step = np.where(closer[:, None], new, step)
            base, best = np.where(closer[:, None], place, base), np.where(closer, error, best)
        raise ModelError(
            "The pressure on the wall does not carry the joint force: check modulus, thickness and "
            "force, or choose more cells."
        )


def _wear(
    wall: _Wall, cycle_of: Callable[[float], _Cycle], cycles: int, extrapolation: int
) -> xr.Dataset:
    joint = wall.joint
    depth, pin_depth = np.zeros(wall.cells), np.zeros(wall.cells)
    clearance, at = wall.clearance, 0
    place: Array | None = None
    rows: list[dict[str, Values]] = []
    while True:
        cycle = cycle_of(clearance)
        loaded = cycle.normal > _UNLOADED * np.max(cycle.normal, initial=0.0)
        if not np.any(loaded):
            raise ModelError("The joint carries no force in any step of the cycle.")
        pieces = [part[loaded] for part in (cycle.normal, cycle.place, cycle.turned, cycle.sliding)]
        normal, direction, turned, sliding = pieces
        force = normal[:, None] * np.stack([np.cos(direction), np.sin(direction)], axis=1)
        if place is None:
            sunk = wall.clearance + normal / (wall.stiffness * wall.radius * joint.width)
            place = force * (sunk / normal)[:, None]

        # wear to come softens the wall; at the last cycle there is none
        step = min(extrapolation, cycles - at)
        pin = _PinCells(wall, turned)
        reach = step * float(np.sum(sliding))
        softened = 1 + wall.stiffness * reach * (joint.specific_wear + joint.pin_specific_wear)
        worn = depth + pin.gather(pin_depth)
        place, pressure = wall.balance(worn, force, softened, place)
        rubbed = sliding @ pressure
        rows.append(
            {
                "cycle": at,
                "depth": depth,
                "pin_depth": pin_depth,
                "clearance": clearance,
                "greatest_force": float(np.max(normal)),
                "rubbing": float(sliding @ normal),
                "torque_ratio": float(np.sum(rubbed)) * wall.area / float(sliding @ normal),
            }
        )
        if at == cycles:
            return _describe(wall, rows)

        depth = depth + joint.specific_wear * step * rubbed
        pin_depth = pin_depth + joint.pin_specific_wear * step * pin.scatter(
            sliding[:, None] * pressure
        )
        at += step
        if np.max(depth) > joint.thickness:
            raise ModelError(
                f"cycles must end before the wall is worn through: {np.max(depth):.2g} m of "
                f"{joint.thickness:g} m after {at} of {cycles} cycles."
            )

        # the rod in tension is longer by what is worn where the force acts
        worn = depth + pin.gather(pin_depth)
        at_force = wall.value_at(worn, direction)
        clearance = wall.clearance + float(np.average(at_force, weights=normal))


class _PinCells:
    """Cells of the pin seen from the cells of the bushing, at each step of a cycle.

    Between cells the depth is linear; what is worn is divided by the same shares, so that nothing
    is lost.
    """

    def __init__(self, wall: _Wall, turned: Array) -> None:
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


def _describe(wall: _Wall, rows: list[dict[str, Values]]) -> xr.Dataset:
    import xarray as xr

    columns = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    depth, pin_depth = columns["depth"], columns["pin_depth"]
    both, along = ("cycle", "angle"), ("cycle",)
    described = {
        "worn_volume": (along, wall.area * depth.sum(axis=1), "m3", "worn volume of the bushing"),
        "pin_volume": (along, wall.area * pin_depth.sum(axis=1), "m3", "worn volume of the pin"),
        "greatest_depth": (along, depth.max(axis=1), "m", "largest worn depth of the bushing"),
        "pin_greatest_depth": (along, pin_depth.max(axis=1), "m", "largest worn depth of the pin"),
        "clearance": (along, columns["clearance"], "m", "radial clearance in tension"),
        "greatest_force": (along, columns["greatest_force"], "N", "largest normal force"),
        "rubbing": (along, columns["rubbing"], "N m", "normal force over sliding of a cycle"),
        "torque_ratio": (along, columns["torque_ratio"], "1", "pressure over load"),
        "depth": (both, depth, "m", "worn depth of the bushing"),
        "pin_depth": (both, pin_depth, "m", "worn depth of the pin"),
    }
    return xr.Dataset(
        {
            name: xr.Variable(dims, values, {"units": unit, "long_name": text})
            for name, (dims, values, unit, text) in described.items()
        },
        {
            "cycle": ("cycle", columns["cycle"], {"units": "1", "long_name": "cycles"}),
            "angle": ("angle", wall.angle, {"units": "rad", "long_name": "place of contact"}),
        },
    )


def _require_numbers(**arguments: Values) -> None:
    """Refuse arrays and NaN: a NaN would never let the loop over the cycles end."""
    require_single(**arguments)
    for name, value in arguments.items():
        if np.isnan(value):
            raise ModelError(f"{name} must be a number, got NaN.")
