"""Measures of a crank-rocker from its four lengths: swing, strokes, speed, transmission, space.

Every function takes `Links`, whose lengths may be arrays that broadcast, so that a search measures
thousands of linkages in one call. The triangles are solved by half angles, which keep all digits
where a linkage is almost stretched. `erlif.models.mechanism.CrankRocker` has the motion of one
linkage in full; angles are counted as there.
"""

from typing import Literal, NamedTuple, TypeAlias

import numpy as np
import scipy

from erlif.core.errors import ModelError
from erlif.models.arguments import Values, formula

# How a four-bar linkage moves, by Grashof's condition.
Kind: TypeAlias = Literal[
    "crank-rocker", "double-crank", "rocker-crank", "double-rocker", "triple-rocker", "change point"
]

# Width to which the crank angle of greatest speed is bracketed, of one linkage and of many.
#
# The speed is flat there, so its error is of the order of the square. [rad]
ROOT_TOLERANCE, SEARCH_TOLERANCE = 1e-10, 1e-5


class Links(NamedTuple):
    """Lengths of a four-bar linkage between joint centres; arrays broadcast.

    Attributes
    ----------
    crank : Values
        Length from crank pivot to crank pin. [m]
    coupler : Values
        Length from crank pin to rocker pin. [m]
    rocker : Values
        Length from rocker pivot to rocker pin. [m]
    ground : Values
        Distance of the two pivots. [m]
    """

    crank: Values
    coupler: Values
    rocker: Values
    ground: Values


@formula(crank="number", coupler="number", rocker="number", ground="number")
def grashof_class(*, crank: float, coupler: float, rocker: float, ground: float) -> Kind:
    """Classify a four-bar linkage by Grashof's condition.

    Shortest plus longest link below the sum of the other two: some link turns fully, and the place
    of the shortest one decides which. Above it: none does. Equal: the linkage can fold flat and
    change its sense there.

    Parameters
    ----------
    crank, coupler, rocker, ground : float
        Lengths; the crank is the driving link, whatever the class. [m]

    Returns
    -------
    str
        "crank-rocker" (the crank is shortest: it turns, the rocker swings), "rocker-crank" (the
        rocker is shortest), "double-crank" (the ground is shortest), "double-rocker" (the coupler
        is shortest), "triple-rocker" or "change point".

    Raises
    ------
    ModelError
        If the longest link is no shorter than the other three together: they cannot be joined.

    Examples
    --------
    >>> grashof_class(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
    'crank-rocker'
    >>> grashof_class(crank=0.3, coupler=0.44, rocker=0.26, ground=0.51)
    'triple-rocker'
    """
    lengths = {"crank": crank, "coupler": coupler, "rocker": rocker, "ground": ground}
    shortest, *middle, longest = sorted(lengths.values())

    if longest >= shortest + sum(middle):
        raise ModelError(
            "Expected links that can be joined, the longest shorter than the other three together; "
            f"got {longest:g} m against {shortest + sum(middle):g} m. Correct the lengths."
        )

    # lengths as typed, 0.1 + 0.5 against 0.2 + 0.4, differ by rounding alone
    surplus = sum(middle) - shortest - longest
    if abs(surplus) <= 4 * np.finfo(float).eps * sum(lengths.values()):
        return "change point"
    if surplus < 0:
        return "triple-rocker"
    kinds: dict[str, Kind] = {
        "crank": "crank-rocker",
        "coupler": "double-rocker",
        "rocker": "rocker-crank",
        "ground": "double-crank",
    }
    return kinds[min(lengths, key=lengths.__getitem__)]


def grashof_margin(links: Links) -> Values:
    """Possible increase of the crank length, the other links unchanged. [m]

    Where it vanishes the linkage folds flat.
    """
    a, b, c, d = links
    return np.minimum(np.minimum(b + c - d, c + d - b), b + d - c) - a


def rocker_limits(links: Links) -> tuple[Values, Values]:
    """Smallest and largest rocker angle, where crank and coupler line up. [rad]"""
    a, b, c, d = links
    return angle_opposite(b - a, c, d), angle_opposite(b + a, c, d)


def swing(links: Links) -> Values:
    """Largest less smallest rocker angle. [rad]"""
    smallest, largest = rocker_limits(links)
    return largest - smallest


def dead_points(links: Links) -> tuple[Values, Values]:
    """Crank angles of the smallest and of the largest rocker angle. [rad]"""
    a, b, c, d = links
    return angle_opposite(c, b - a, d) + np.pi, angle_opposite(c, b + a, d)


def stroke_excess(links: Links) -> Values:
    """Crank angle of the rising stroke less half a turn. [rad]

    Negative where that stroke is the quicker one.
    """
    at_smallest, at_largest = dead_points(links)
    return at_largest - at_smallest + np.pi


def time_ratio(links: Links) -> Values:
    """Duration of the rising stroke over that of the falling one. [1]"""
    excess = stroke_excess(links)
    return (np.pi + excess) / (np.pi - excess)


def transmission_limits(links: Links) -> tuple[Values, Values]:
    """Smallest and largest angle between coupler and rocker, at the crank in line. [rad]"""
    a, b, c, d = links
    return angle_opposite(d - a, b, c), angle_opposite(d + a, b, c)


def least_transmission(links: Links) -> Values:
    """Smallest acute angle between coupler and rocker over a turn. [rad]"""
    smallest, largest = transmission_limits(links)
    return np.minimum(smallest, np.pi - largest)


def swept_box(links: Links, width: Values = 0.0) -> tuple[Values, Values, Values, Values]:
    """Box that all links sweep over a turn: left, right, bottom and top from the crank pivot. [m]

    The circle of the crank pin, the arc of the rocker pin and the rocker pivot fill that of the
    joint centres; coupler and rocker are straight between them. Links of a width with round ends
    about their joints are their centre lines with a disc drawn along them, so that their outline
    reaches half of the width beyond on each side.
    """
    a, _, c, d = links
    smallest, largest = rocker_limits(links)
    left = np.minimum(-a, d - c * np.cos(smallest))
    right = np.maximum(np.maximum(a, d), d - c * np.cos(largest))

    # the rocker pin is highest upright, where its arc contains that place
    upright = np.clip(np.pi / 2, smallest, largest)
    top = np.maximum(a, c * np.sin(upright))
    return left - width / 2, right + width / 2, -a - width / 2, top + width / 2


def space(links: Links, width: Values = 0.0) -> tuple[Values, Values]:
    """Sides of the swept box, along and across the ground link. [m]"""
    left, right, bottom, top = swept_box(links, width)
    return right - left, top - bottom


def rocker_rates(links: Links, crank_angle: Values) -> tuple[Values, Values]:
    """First and second derivative of the rocker angle by the crank angle. [1]

    From the loop in Cartesian coordinates: crank pin P, rocker pin Q, and the coupler Q - P, whose
    length does not change.
    """
    a, b, c, d = links
    px, py = a * np.cos(crank_angle), a * np.sin(crank_angle)

    # Q is where the circles about P and the rocker pivot meet, on the side of the rocker
    ex, ey = d - px, -py
    square = ex * ex + ey * ey
    along = (b * b - c * c + square) / (2 * square)
    area = ((b + c) ** 2 - square) * (square - (b - c) ** 2)
    aside = np.sqrt(np.maximum(area, 0.0)) / (2 * square)
    x, y = along * ex - aside * ey, along * ey + aside * ex
    qx, qy = px + x, py + y

    # the velocities of both pins have one component along the coupler
    vx, vy = -py, px
    tx, ty = qy, d - qx
    driving, turning = x * vx + y * vy, x * tx + y * ty
    rate = driving / turning
    x_rate, y_rate = rate * tx - vx, rate * ty - vy
    driving_rate = x_rate * vx + y_rate * vy - x * px - y * py
    turning_rate = x_rate * tx + y_rate * ty + rate * (x * ty - y * tx)
    return rate, (driving_rate - rate * turning_rate) / turning


def speed_ratio(links: Links, *, rising: bool) -> Values:
    """Greatest rocker speed of one stroke over crank speed, positive. [1]

    The acceleration changes its sign once between the dead points, in either stroke.
    """
    at_smallest, at_largest = dead_points(links)
    # a linkage that folds flat has no finite speed there
    with np.errstate(divide="ignore", invalid="ignore"):
        if rising:
            return _greatest_rate(links, at_smallest, at_largest + 2 * np.pi)
        return -_greatest_rate(links, at_largest, at_smallest)


def _greatest_rate(links: Links, start: Values, end: Values) -> Values:
    """Rate of the rocker where its acceleration vanishes between two dead points. [1]"""
    if np.ndim(start) == 0:
        # at the end of a stroke in which all links lie on one line the acceleration has no sign
        ends = [rocker_rates(links, angle)[1] for angle in (start, end)]
        if not ends[0] * ends[1] < 0:
            inside = start + (end - start) * (1 - np.cos(np.linspace(0, np.pi, 4001)[1:-1])) / 2
            rates = rocker_rates(links, inside)[0]
            return rates[np.nanargmax(np.abs(rates))]
        fastest: Values = scipy.optimize.brentq(
            lambda angle: rocker_rates(links, angle)[1], start, end, xtol=ROOT_TOLERANCE
        )
        return rocker_rates(links, fastest)[0]

    from scipy.optimize import elementwise  # loads a quarter of a second, for searches alone

    fastest = elementwise.find_root(
        lambda angle, *lengths: rocker_rates(Links(*lengths), angle)[1],
        (start, end),
        args=tuple(links),
        tolerances={"xatol": SEARCH_TOLERANCE},
    ).x
    return rocker_rates(links, fastest)[0]


def angle_opposite(side: Values, left: Values, right: Values) -> Values:
    """Angle of a triangle between two sides, opposite to the third. [rad]

    The half-angle form stays exact where the triangle is almost flat, and so is the cosine.
    """
    open_part = np.maximum(side**2 - (left - right) ** 2, 0.0)
    closed_part = np.maximum((left + right) ** 2 - side**2, 0.0)
    return 2 * np.arctan2(np.sqrt(open_part), np.sqrt(closed_part))
