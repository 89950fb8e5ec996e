"""How the measures of a crank-rocker follow from the lengths of its links, and their tolerances."""

from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array
from erlif.models.arguments import Values, require_not_negative
from erlif.models.linkage import measures
from erlif.models.mechanism import CrankRocker

# Change of a length for its derivative, of the crank; the error is of the order of the square.
STEP = 1e-5


@dataclass(frozen=True)
class Sensitivity:
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


def link_sensitivity(linkage: CrankRocker) -> Sensitivity:
    """Differentiate the measures of a crank-rocker by the lengths of its links.

    Parameters
    ----------
    linkage : CrankRocker
        The four lengths. [m]

    Returns
    -------
    Sensitivity
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

    def slope(index: int) -> list[float]:
        sides = []
        for sign in (1, -1):
            changed = lengths.copy()
            changed[index] += sign * step
            sides.append(_measures(measures.Links(*(float(length) for length in changed))))
        return [(high - low) / (2 * step) for high, low in zip(*sides, strict=True)]

    return Sensitivity(*np.array([slope(index) for index in range(4)]).T)


def _measures(links: measures.Links) -> list[float]:
    """Values in the order of `Sensitivity`."""
    fastest = max(measures.speed_ratio(links, rising=rising) for rising in (True, False))
    others = (measures.time_ratio(links), measures.least_transmission(links))
    return [float(value) for value in (measures.swing(links), fastest, *others)]
