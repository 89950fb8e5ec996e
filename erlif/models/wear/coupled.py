"""Wear of a slider-crank joint that changes its own forces. Mukras et al. (2008)."""

from dataclasses import dataclass, replace

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.models.arguments import Values, formula
from erlif.models.mechanism import SliderCrank
from erlif.models.reaction import JointReaction, SliderCrankBodies, joint_reaction

LARGEST_STEP = 0.1
"""Wear depth over bushing radius that one extrapolation of `coupled_wear` may reach. [1]"""


@dataclass(frozen=True)
class CoupledWear:
    """Wear of a slider-crank joint over its cycles; arrays (n,), from the unworn joint on.

    Attributes
    ----------
    cycles : Values
        Cycles since the joint was new. [1]
    volume : Values
        Worn volume. [m3]
    depth : Values
        Largest worn depth. [m]
    greatest_force : Values
        Largest joint force of the cycle computed with that wear. [N]
    """

    cycles: Values
    volume: Values
    depth: Values
    greatest_force: Values


@formula(crank_speed="number")
def coupled_wear(
    linkage: SliderCrank,
    *,
    crank_speed: float,
    bodies: SliderCrankBodies,
    bushing_radius: float,
    bushing_width: float,
    specific_wear: float,
    cycles: int,
    extrapolation: int = 500,
    coupled: bool = True,
    steps_per_cycle: int = 360,
) -> CoupledWear:
    """Compute the wear of a crank-pin bushing that changes its own forces. Mukras et al. (2008).

    One cycle of `erlif.models.reaction.joint_reaction` gives V = k R2 int N |d(phi1 - phi2)|
    (eq. 20); it stands for the next `extrapolation` cycles (eq. 5). The depth V / (2 R2 w) then
    lengthens the rod as a clearance.

    Parameters
    ----------
    linkage : SliderCrank
        Lengths of the unworn linkage. [m]
    crank_speed : float
        Speed of the crank. [rad/s]
    bodies : SliderCrankBodies
        Masses, spring and friction.
    bushing_radius, bushing_width : float
        R2 and w. [m]
    specific_wear : float
        Specific wear rate k. [1/Pa]
    cycles : int
        Cycles to the end of the test.
    extrapolation : int
        Cycles for which one computed cycle stands, A_E of eq. 5.
    coupled : bool
        False keeps the joint unworn in the dynamics: the source's prediction from initial dynamics.
    steps_per_cycle : int
        Crank angles per computed cycle.

    Returns
    -------
    CoupledWear
        Cycles, worn volume [m3], depth [m] and largest force [N], from the unworn joint on.

    Raises
    ------
    ModelError
        A value not positive or not finite, an array where one number is needed, or an extrapolation
        that wears more than a tenth of the bushing radius in one step.

    Notes
    -----
    The depth takes the worn bushing for a cosine (`steady_bushing_wear`) in place of the source's
    finite elements. The source does not state the width; about 8.4 mm agrees with its worn mass and
    depth. Its speed "0.5 RPM" is 0.5 turns per second by its own cycles and hours.

    Examples
    --------
    The second test of the source, 21,400 cycles, with preload and width fitted to its first test;
    the source computes 0.1589 g of PTFE (2200 kg/m3).

    >>> from erlif.models.mechanism import SliderCrank
    >>> from erlif.models.reaction import SliderCrankBodies
    >>> bodies = SliderCrankBodies(
    ...     rod_mass=0.8175,
    ...     rod_inertia=5500e-6,
    ...     slider_mass=5.5487,
    ...     spring_stiffness=525.4,
    ...     spring_preload=68.354,
    ... )
    >>> worn = coupled_wear(
    ...     SliderCrank(crank=0.0762, coupler=0.2032),
    ...     crank_speed=np.pi,
    ...     bodies=bodies,
    ...     bushing_radius=9.535e-3,
    ...     bushing_width=8.468e-3,
    ...     specific_wear=5.05e-13,
    ...     cycles=21_400,
    ...     extrapolation=21_400,
    ...     coupled=False,
    ... )
    >>> print(f"{worn.volume[-1] * 2200 * 1e3:.3f} g")
    0.156 g
    """
    # the end of a cycle is the start of the next, so it is not sampled twice
    crank_angle = np.linspace(0, 2 * np.pi, steps_per_cycle, endpoint=False)
    at, volume, force = [0], [0.0], []
    while True:
        # the cosine of the worn bushing turns volume into depth, and the depth lengthens the rod
        clearance = linkage.clearance + coupled * volume[-1] / (2 * bushing_radius * bushing_width)
        worn = replace(linkage, clearance=clearance)
        reaction = joint_reaction(
            worn, crank_angle=crank_angle, crank_speed=crank_speed, bodies=bodies
        )
        force.append(float(np.max(reaction.force)))
        if at[-1] == cycles:
            break

        # the forces of this cycle stand for the whole step, so the step must not change the joint
        path = _mean_load_path(worn, reaction, crank_angle, crank_speed)
        per_cycle = specific_wear * bushing_radius * path * 2 * np.pi
        step = min(extrapolation, cycles - at[-1])
        if step * per_cycle / (2 * bushing_radius * bushing_width) > LARGEST_STEP * bushing_radius:
            raise ModelError(
                f"extrapolation must be smaller: {step} cycles wear more than a tenth of the "
                "bushing radius."
            )
        at.append(at[-1] + step)
        volume.append(volume[-1] + step * per_cycle)

    depth = np.array(volume) / (2 * bushing_radius * bushing_width)
    return CoupledWear(np.array(at), np.array(volume), depth, np.array(force))


def _mean_load_path(
    linkage: SliderCrank, reaction: JointReaction, crank_angle: Array, crank_speed: float
) -> float:
    """Mean over a cycle of the normal force times the joint's turning per turn of the crank. [N]

    The mean over equal steps of a periodic function is its integral to the last digit.
    """
    turning = np.abs(linkage.joint_speed(crank_angle, crank_speed=crank_speed)) / crank_speed
    return float(np.mean(reaction.normal * turning))
