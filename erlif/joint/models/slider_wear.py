"""Wear round the bushing and on the pin of a slider-crank joint, with the geometry updated.

The procedure is that of Mukras et al. (2008), figures 1 and 11: forces of one cycle, pressure,
wear by Archard's law, new geometry, and one computed cycle for many. Finite elements are replaced
by a Winkler wall (Colbert et al. 2009, B1 to B3).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from erlif.core.arrays import Array
from erlif.core.described import describe_by
from erlif.core.errors import ModelError
from erlif.core.tables import read_table
from erlif.joint.models.reaction import SliderCrankBodies, joint_reaction
from erlif.joint.models.slider.contact import ContactLaw, PinCells, Wall
from erlif.joint.models.slider_dynamics import simulate_slider_crank
from erlif.models.arguments import (
    Values,
    check_fields,
    formula,
    require_known,
    require_positive,
    require_single,
)
from erlif.models.mechanism import SliderCrank

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["WearingJoint", "bound_extrapolation", "wear_slider_crank"]

# Share of the greatest force below which a joint carries nothing: free flight.
_UNLOADED = 1e-9

# Relative error of a step in the simulation of a cycle: 4e-6 of the friction path at most.
_TOLERANCE = 1e-6

# Difference of the sampled friction path of a cycle from its integral at most, over the path.
_COARSE = 0.1


# Factors of Roache (1994, 2011) on an estimated error, with an order as expected and without.
_SAFETY, _CAUTION = 1.25, 3.0

# Orders within 5 % of the first count as expected, Roache (2011).
_EXPECTED_ORDER = (0.95, 1.05)


@dataclass(frozen=True)
class WearingJoint:
    """Bushing and pin that wear. A value not positive (wear rates: negative) is refused.

    Attributes
    ----------
    width, thickness : float
        Width of the bushing and thickness of its wall. [m]
    modulus : float
        E' of the wall, see `erlif.models.contact.winkler_modulus`. [Pa]
    specific_wear, pin_specific_wear : float
        Specific wear rates of bushing and pin. [1/Pa]
    """

    width: float
    thickness: float
    modulus: float
    specific_wear: float
    pin_specific_wear: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self)


@formula(crank_speed="number")
def wear_slider_crank(
    linkage: SliderCrank,
    *,
    crank_speed: float,
    bodies: SliderCrankBodies,
    joint: WearingJoint,
    cycles: int,
    extrapolation: int = 500,
    coupled: bool = True,
    contact: ContactLaw | None = None,
    settling: int = 0,
    steps_per_cycle: int = 72,
    cells: int = 360,
) -> xr.Dataset:
    """Wear the crank-pin joint of a slider-crank round its bushing and on its pin.

    Mukras et al. (2008), eqs. 4, 5 and 20, with the simplified joint or, by `contact`, the general
    one. At each crank angle of a cycle the pressure on the wall
    carries the normal force. Depths on bushing and pin grow by k p ds, and the cycle stands for the
    next `extrapolation` cycles. In the simplified joint the eccentricity of the pin in tension
    lengthens the rod; in the general joint the pin moves in the worn bushing.

    Parameters
    ----------
    cycles : int
        Cycles to the end of the test.
    extrapolation : int
        Cycles for which one computed cycle stands, A_E of Mukras et al. (2008), eq. 5.
    steps_per_cycle : int
        Crank angles of a computed cycle.
    linkage : SliderCrank
        Lengths and unworn clearance. [m]
    crank_speed : float
        Speed of the crank. [rad/s]
    bodies : SliderCrankBodies
        Masses, spring, friction and the radius of the pin, single numbers.
    joint : WearingJoint
        Wall and wear rates.
    coupled : bool
        False keeps the joint unworn in the dynamics.
    contact : ContactLaw, optional
        Law of the general joint. Each computed cycle is then simulated by
        `erlif.joint.models.slider_dynamics.simulate_slider_crank` with the profiles worn so far.
        Default: inverse dynamics of the joint with continuous contact.
    settling : int
        Turns of the general joint before the one whose forces wear it; the source has one.
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

    >>> from erlif.models.mechanism import SliderCrank
    >>> from erlif.joint.models.reaction import SliderCrankBodies
    >>> from erlif.joint.models.slider_wear import WearingJoint
    >>> bodies = SliderCrankBodies(0.8175, 5500e-6, 5.5487, 525.4, 60.0, pin_radius=9.525e-3)
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
    import xarray as xr

    require_single(**vars(bodies))
    require_known(**vars(bodies))
    require_positive(pin_radius=bodies.pin_radius)

    def cycle_of(clearance: float, worn: dict[str, Array]) -> _Cycle:
        if contact is not None:
            known = worn if coupled else {name: 0 * depth for name, depth in worn.items()}
            turns = simulate_slider_crank(
                linkage,
                bodies=bodies,
                crank_speed=crank_speed,
                duration=(1 + settling) * 2 * np.pi / crank_speed,
                contact=contact,
                worn=xr.Dataset(
                    {name: ("angle", depth) for name, depth in known.items()},
                    {"angle": wall.angle},
                ),
                tolerance=_TOLERANCE,
                samples=(1 + settling) * steps_per_cycle + 1,
            )
            # the turn after those in which the joint settles
            return _simulated_cycle(turns.isel(time=slice(settling * steps_per_cycle, None)))
        longer = replace(linkage, clearance=clearance if coupled else linkage.clearance)
        return _reaction_cycle(longer, crank_speed, bodies, steps_per_cycle)

    wall = Wall(
        linkage.clearance,
        cells=cells,
        area=bodies.pin_radius * joint.width * 2 * np.pi / cells,
        stiffness=joint.modulus / joint.thickness,
    )
    return _wear(wall, joint, cycle_of, cycles, extrapolation)


class _Cycle(NamedTuple):
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
    reaction = joint_reaction(linkage, crank_angle=angle, crank_speed=crank_speed, bodies=bodies)
    rate = linkage.joint_speed(angle, crank_speed=crank_speed)

    # friction turns the force away from the normal
    phi = linkage.coupler_angle(angle)
    direction = np.arctan2(-reaction.force_y, -reaction.force_x) - phi
    direction -= np.sign(rate) * np.arctan(bodies.friction)
    sliding = bodies.pin_radius * np.abs(rate) * 2 * np.pi / crank_speed / steps
    return _Cycle(reaction.normal, direction, linkage.joint_angle(angle), sliding)


def _simulated_cycle(turn: xr.Dataset) -> _Cycle:
    """Cycle of a simulation; steps lie around its samples, half a step at both ends."""
    step = np.diff(turn.time.values)
    share = (np.concatenate([[0.0], step]) + np.concatenate([step, [0.0]])) / 2
    sliding = share * np.abs(turn.slip_speed.values)
    normal = turn.normal.values

    # the friction path of the motion is kept
    path, sampled = float(np.ptp(turn.rubbing.values)), float(sliding @ normal)
    if abs(sampled - path) > _COARSE * path:
        raise ModelError(
            "samples of a turn must resolve its impacts: force over sliding distance is "
            f"{sampled:.3g} N m by the samples and {path:.3g} N m by integration. Increase "
            "steps_per_cycle."
        )
    sliding = sliding * (path / sampled if sampled else 1.0)
    turned = (turn.crank_angle - turn.rod_angle).values
    return _Cycle(normal, turn.contact_angle.values, turned, sliding)


def _wear(
    wall: Wall,
    joint: WearingJoint,
    cycle_of: Callable[[float, dict[str, Array]], _Cycle],
    cycles: int,
    extrapolation: int,
) -> xr.Dataset:
    depth, pin_depth = np.zeros(wall.cells), np.zeros(wall.cells)
    clearance, at = wall.clearance, 0
    places: Array | None = None
    rows: list[dict[str, Values]] = []
    while True:
        cycle = cycle_of(clearance, {"depth": depth, "pin_depth": pin_depth})
        loaded = cycle.normal > _UNLOADED * np.max(cycle.normal, initial=0.0)
        if not np.any(loaded):
            raise ModelError("The joint carries no force in any step of the cycle.")
        normal, direction, turned, sliding = (part[loaded] for part in cycle)
        force = normal[:, None] * np.stack([np.cos(direction), np.sin(direction)], axis=1)
        if places is None:
            places = np.full((loaded.size, 2), np.nan)

        # the search starts at the places of the last cycle, or on the bushing under the force
        sunk = wall.clearance + normal * wall.cell / (wall.stiffness * wall.area)
        start = np.where(np.isnan(places[loaded]), force * (sunk / normal)[:, None], places[loaded])

        # wear to come softens the wall; at the last cycle there is none
        step = min(extrapolation, cycles - at)
        pin = PinCells(wall, turned)
        reach = step * float(np.sum(sliding))
        softened = 1 + wall.stiffness * reach * (joint.specific_wear + joint.pin_specific_wear)
        worn = depth + pin.gather(pin_depth)
        places[loaded], pressure = wall.balance(worn, force, softened, start)
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


def _describe(wall: Wall, rows: list[dict[str, Values]]) -> xr.Dataset:
    columns = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    depth, pin_depth = columns["depth"], columns["pin_depth"]
    both, along = ("cycle", "angle"), ("cycle",)
    measured = ("clearance", "greatest_force", "rubbing", "torque_ratio")
    return describe_by(
        read_table("erlif.joint.models", "variables.toml")["slider_wear"],
        {
            "worn_volume": (along, wall.area * depth.sum(axis=1)),
            "pin_volume": (along, wall.area * pin_depth.sum(axis=1)),
            "greatest_depth": (along, depth.max(axis=1)),
            "pin_greatest_depth": (along, pin_depth.max(axis=1)),
            **{name: (along, columns[name]) for name in measured},
            "depth": (both, depth),
            "pin_depth": (both, pin_depth),
        },
        {"cycle": ("cycle", columns["cycle"]), "angle": ("angle", wall.angle)},
    )


def bound_extrapolation(
    extrapolation: int, *, wear: Callable[[int], xr.Dataset], halvings: int = 2
) -> xr.Dataset:
    """Bound the error that an extrapolation factor makes, by halving it. Roache (1994, 2011).

    The error of a first-order step falls with the step, so that the last change by halving
    estimates what is left. The bound is 1.25 times this where the changes fall with the first
    order within 5 %, 3 times where they do not (Roache 2011). These factors are of experience.

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
    errors: dict[str, Values] = {}
    for name, unit in (("worn_volume", "m3"), ("greatest_depth", "m")):
        values = np.array([float(end[name]) for end in ends])
        earlier, last = values[-3] - values[-2], values[-2] - values[-1]
        order = float(np.log2(earlier / last)) if earlier * last > 0 else float("nan")
        as_expected = _EXPECTED_ORDER[0] <= order <= _EXPECTED_ORDER[1]

        # by the first order the last change is what is left
        limit = values[-1] - last
        bound = (_SAFETY if as_expected else _CAUTION) * np.maximum(abs(values - limit), abs(last))
        errors[name] = ("extrapolation", values, {"units": unit})
        errors[f"{name}_limit"] = ((), limit, {"units": unit})
        errors[f"{name}_order"] = ((), order, {"units": "1"})
        errors[f"{name}_bound"] = ("extrapolation", bound, {"units": unit})
    return xr.Dataset(errors, {"extrapolation": ("extrapolation", factors, {"units": "1"})})
