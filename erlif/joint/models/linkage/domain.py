"""The crank-rockers that given lengths allow, as a unit interval or square to search.

A linkage is a crank-rocker if and only if coupler, rocker and ground make a triangle in which each
side is shorter than the other two by more than the crank: Grashof's condition with the crank
shortest. For given lengths this bounds the unknown ones.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.models.arguments import Values
from erlif.models.four_bar.measures import Links, grashof_margin

# Distance of the search from linkages that fold flat, of the width of the interval.
EDGE = 1e-9


@dataclass(frozen=True)
class Domain:
    """Crank-rockers with some lengths given and others unknown.

    Attributes
    ----------
    given : dict of str to float
        Known lengths by their names. [m]
    unknown : tuple of str
        At most two names; the range of the last one depends on the other.
    longest : float
        Longest link that is considered. [m]
    """

    given: dict[str, float]
    unknown: tuple[str, ...]
    longest: float

    def links(self, place: Sequence[Values] | Array) -> Links:
        """Lengths at a place of the unit interval or square, one coordinate for each unknown."""
        lengths: dict[str, Values] = dict(self.given)
        if len(self.unknown) == 2:
            low, high = _outer_range(self.given, self.unknown, self.longest)
            from_crank = low > 0 and "crank" in self.given  # from it to the longest link
            outer = low * (high / low) ** place[0] if from_crank else low + (high - low) * place[0]
            lengths[self.unknown[0]] = outer
        for name in self.unknown[-1:]:
            low, high = _range_of(name, lengths, self.longest)
            lengths[name] = low + (high - low) * place[-1]
        return Links(*np.broadcast_arrays(*(lengths[name] for name in Links._fields)))


def find_domain(given: dict[str, float], longest: float | None) -> Domain:
    """Find the range of the unknown lengths.

    Parameters
    ----------
    given : dict of str to float
        Known lengths by their names, two at least. [m]
    longest : float or None
        Longest link that is considered; None for ten times the longest given. [m]

    Returns
    -------
    Domain
        Where the crank-rockers are.

    Raises
    ------
    ModelError
        If no crank-rocker has the given lengths.
    """
    # the range of the crank follows from all others, so it is the last
    unknown = tuple(name for name in (*Links._fields[1:], "crank") if name not in given)
    limit = 10 * max(given.values()) if longest is None else longest
    lengths: dict[str, Values] = dict(given)
    if len(unknown) == 2:
        low, high = _outer_range(given, unknown, limit)
        lengths[unknown[0]] = (low + high) / 2
    if unknown:
        low, high = _range_of(unknown[-1], lengths, limit)
    if unknown and not low < high:
        known = ", ".join(f"{name} {value:g} m" for name, value in given.items())
        raise ModelError(
            f"no crank-rocker has {known} and links up to {limit:g} m: the crank must be the "
            "shortest link, and coupler, rocker and ground must close a triangle with it."
        )
    return Domain(given, unknown, limit)


def _outer_range(
    given: dict[str, float], unknown: tuple[str, ...], longest: float
) -> tuple[float, float]:
    """Range of the first of two unknown links over all values of the second."""
    if "crank" in unknown:
        one, two = (given[name] for name in given)
        return abs(one - two), min(one + two, longest)
    return given["crank"], longest


def _range_of(name: str, lengths: dict[str, Values], longest: float) -> tuple[Values, Values]:
    """Range of one link with the other three known."""
    if name == "crank":
        others = [lengths[other] for other in Links._fields[1:]]
        return 0.0 * others[0], grashof_margin(Links(0.0, *others))
    crank = lengths["crank"]
    one, two = (lengths[other] for other in Links._fields[1:] if other != name)
    return np.abs(one - two) + crank, np.minimum(one + two - crank, longest)
