"""Properties of one crank-rocker for its designer, with the tolerances of its links."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from erlif.core.arrays import Array
from erlif.models.arguments import Values, formula, require_not_negative
from erlif.models.four_bar import measures
from erlif.models.mechanism import CrankRocker

# A stroke of the rocker, by its angle while the crank angle grows.
Stroke: TypeAlias = Literal["rising", "falling", "neither"]

# Share of the crank by which it could be longer, below which a linkage folds flat.
FLAT = 1e-6

# Crank angle by which two strokes of equal duration may differ by rounding. [rad]
EQUAL_STROKES = 1e-9

# Change of a length for its derivative, of the crank; the error is of the order of the square.
STEP = 1e-5


@dataclass(frozen=True)
class LinkageDesign:
    """A crank-rocker and its measures.

    Attributes
    ----------
    linkage : CrankRocker
        The four lengths. [m]
    swing : float
        Largest less smallest rocker angle. [rad]
    speed_ratio : float
        Greatest rocker speed, of either sign, over crank speed. [1]
    time_ratio : float
        Duration of the slower stroke over that of the quicker one, at least 1. [1]
    slower_stroke : str
        "rising" where the rocker angle grows during the slower stroke, away from the crank,
        "falling", or "neither".
    transmission : (float, float)
        Smallest and largest angle between coupler and rocker. [rad]
    space : (float, float)
        Sides of the box that all links sweep over a turn, along and across the ground link; of
        their joint centres where `link_width` is 0. [m]
    kind : str
        Class by Grashof's condition.
    crank_speed : float
        Speed of the crank; NaN where no speed is given. [rad/s]
    departures : tuple of str
        Targets and limits that it misses, one sentence each.
    link_width : float
        Width of the links, with round ends about their joints. [m]
    """

    linkage: CrankRocker
    swing: float
    speed_ratio: float
    time_ratio: float
    slower_stroke: Stroke
    transmission: tuple[float, float]
    space: tuple[float, float]
    kind: measures.Kind
    crank_speed: float = np.nan
    departures: tuple[str, ...] = ()
    link_width: float = 0.0

    @property
    def rocker_speed(self) -> float:
        """Greatest rocker speed. [rad/s]"""
        return self.speed_ratio * self.crank_speed

    @property
    def folds_flat(self) -> bool:
        """Whether all links come to lie on one line, from where the motion is not certain."""
        return bool(measures.grashof_margin(self.linkage.links) < FLAT * self.linkage.crank)

    @property
    def least_transmission(self) -> float:
        """Smallest acute angle between coupler and rocker. [rad]"""
        return float(measures.least_transmission(self.linkage.links))


@formula(crank_speed="number")
def measure_linkage(
    linkage: CrankRocker,
    *,
    crank_speed: float | None = None,
    rocker_speed: float | None = None,
    link_width: float = 0.0,
) -> LinkageDesign:
    """Measure a crank-rocker.

    Parameters
    ----------
    linkage : CrankRocker
        Lengths of the linkage between its joints. [m]
    crank_speed : float, optional
        Speed of the crank, positive. [rad/s]
    rocker_speed : float, optional
        Wanted greatest rocker speed, which gives the crank speed. [rad/s]
    link_width : float
        Width of the links, with round ends about their joints, for the space. [m]

    Returns
    -------
    LinkageDesign
        Swing, ratios, transmission angles and space.

    Raises
    ------
    ModelError
        A speed that is not one positive number, or a negative width.

    Examples
    --------
    The rig of Farzaneh (2002): 24 rpm of the rocker need 112.27 rpm of the crank, not 114.

    >>> from erlif.models.mechanism import CrankRocker
    >>> rig = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
    >>> found = measure_linkage(rig, rocker_speed=24 * np.pi / 30)
    >>> print(f"{found.speed_ratio:.5f} {found.crank_speed * 30 / np.pi:.2f} rpm")
    0.21378 112.27 rpm
    >>> print(f"{np.degrees(found.swing):.3f} degrees, {found.time_ratio:.4f}")
    24.426 degrees, 1.0014
    """
    links = linkage.links
    excess = float(measures.stroke_excess(links))
    slower: Stroke = "rising" if excess > 0 else "falling"
    smallest, largest = measures.transmission_limits(links)
    along, across = measures.space(links, link_width)
    speed_ratio = float(max(measures.speed_ratio(links, rising=up) for up in (True, False)))
    if crank_speed is None:
        crank_speed = np.nan if rocker_speed is None else rocker_speed / speed_ratio
    return LinkageDesign(
        linkage=linkage,
        swing=float(measures.swing(links)),
        speed_ratio=speed_ratio,
        time_ratio=linkage.time_ratio(),
        slower_stroke=slower if abs(excess) > EQUAL_STROKES else "neither",
        transmission=(float(smallest), float(largest)),
        space=(float(along), float(across)),
        kind=measures.grashof_class(**links._asdict()),
        crank_speed=float(crank_speed),
        link_width=float(link_width),
    )


@dataclass(frozen=True)
class LinkSensitivity:
    """Derivatives of the measures of a crank-rocker, in the order crank, coupler, rocker, ground.

    Attributes
    ----------
    swing : array, (4,)
        Of the swing. [rad/m]
    speed_ratio : array, (4,)
        Of the greatest rocker speed over crank speed, of the faster stroke. [1/m]
    time_ratio : array, (4,)
        Of the duration of the rising stroke over that of the falling one. [1/m]
    least_transmission : array, (4,)
        Of the smallest acute angle between coupler and rocker. [rad/m]
    """

    swing: Array
    speed_ratio: Array
    time_ratio: Array
    least_transmission: Array

    def worst(self, tolerance: Values) -> dict[str, float]:
        """Greatest change of each measure by tolerances that all act the same way.

        Parameters
        ----------
        tolerance : float or array, (4,)
            Half width of the tolerance of each link. [m]

        Returns
        -------
        dict of str to float
            By the name of the measure, in its unit.
        """
        require_not_negative(tolerance=tolerance)
        return {name: float(np.sum(np.abs(row) * tolerance)) for name, row in vars(self).items()}

    def std(self, tolerance_std: Values) -> dict[str, float]:
        """Standard deviation of each measure by independent errors of the links.

        Parameters
        ----------
        tolerance_std : float or array, (4,)
            Standard deviation of each link. [m]

        Returns
        -------
        dict of str to float
            By the name of the measure, in its unit.
        """
        require_not_negative(tolerance_std=tolerance_std)
        return {
            name: float(np.sqrt(np.sum((row * tolerance_std) ** 2)))
            for name, row in vars(self).items()
        }


def link_sensitivity(linkage: CrankRocker) -> LinkSensitivity:
    """Differentiate the measures of a crank-rocker by the lengths of its links.

    Parameters
    ----------
    linkage : CrankRocker
        The four lengths. [m]

    Returns
    -------
    LinkSensitivity
        Derivatives by crank, coupler, rocker and ground.

    Notes
    -----
    At a centric linkage, whose strokes are equal, the least transmission angle has a kink: its
    derivative is then the mean of both sides.

    Examples
    --------
    On the rig a crank longer by 1 mm adds 0.45 degrees to the swing, a longer coupler hardly any:

    >>> from erlif.models.mechanism import CrankRocker
    >>> rig = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
    >>> for slope in link_sensitivity(rig).swing:
    ...     print(f"{np.degrees(slope) / 1e3:.3f} degrees/mm")
    0.451 degrees/mm
    -0.001 degrees/mm
    -0.096 degrees/mm
    0.001 degrees/mm
    """
    lengths = np.array(linkage.links)
    # a linkage that almost folds flat stays a crank-rocker on both sides
    step = min(STEP * linkage.crank, float(measures.grashof_margin(linkage.links)) / 10)

    moves = step * np.eye(4)
    after, before = (
        np.array([_measures(measures.Links(*changed)) for changed in moved.tolist()])
        for moved in (lengths + moves, lengths - moves)
    )
    return LinkSensitivity(*((after - before) / (2 * step)).T)


def _measures(links: measures.Links) -> list[float]:
    """Values in the order of `LinkSensitivity`."""
    fastest = max(measures.speed_ratio(links, rising=rising) for rising in (True, False))
    others = (measures.time_ratio(links), measures.least_transmission(links))
    return [float(value) for value in (measures.swing(links), fastest, *others)]
