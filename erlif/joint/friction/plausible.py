"""Whether a friction coefficient can be one: a slip of units or of the arm shows in its size."""

from __future__ import annotations

LOWEST, HIGHEST = 0.005, 1.5
"""Friction coefficients of metal in a bushing, from well lubricated to dry and galled. [1]

No limits of a source: a value beyond them is far more often a slip of units than a bearing.
"""


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
    ['warning: the arm of 0.3 m is no longer than the radius of 0.4 m; check both and their units']
    """
    doubts = []
    if not LOWEST <= friction <= HIGHEST:
        where = "" if radius is None else f" of {radius:g} m"
        force = "torque" if arm is None else f"arm force, the arm of {arm:g} m"
        doubts.append(
            f"warning: a friction coefficient of {friction:.2g} is implausible ({LOWEST:g} to "
            f"{HIGHEST:g} expected). Check the radius{where}, the unit of the {force}, and the "
            "unit of the load"
        )
    if radius is not None and arm is not None and arm <= radius:
        doubts.append(
            f"warning: the arm of {arm:g} m is no longer than the radius of {radius:g} m; check "
            "both and their units"
        )
    return doubts
