"""Crank-rockers for a wanted swing, speed and time ratio, within limits. Farzaneh (2002), app. A.2.

The source finds its links "through successive iterations" of eq. A.1. Here the unknown lengths are
searched over all crank-rockers that the given ones allow, and every solution is refined by root
finding or least squares to rounding.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from operator import attrgetter
from typing import Any, TypeAlias

import numpy as np
import scipy

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.joint.models.linkage.design import LinkageDesign, measure_linkage
from erlif.joint.models.linkage.domain import EDGE, Domain, find_domain
from erlif.models.arguments import Values, formula
from erlif.models.four_bar import measures
from erlif.models.four_bar.measures import Links, least_transmission, space
from erlif.models.mechanism import CrankRocker

# Places of the search along one unknown length, and along each of two.
LINE, SQUARE = 257, 49

# Places of the search along the length of a second link, where one is given.
SCALES = 33

# Relative deviation of a target that counts as none.
ATTAINED = 1e-9

# Relative difference of lengths below which two solutions are one.
SAME = 1e-6

# Step at which least squares end; as they converge, the error is then far below.
STEP = 1e-11

# Deviation in the place of an infinite one.
LARGE = 1e6

# Steps of a search from a minimum of the deviation at first, and of any search.
CALLS, MOST_CALLS = 15, 60

# Distance on the square up to which two points of neighbouring rows lie on one curve.
NEIGHBOURS = 0.25

# Minima of the deviation on the square from which a search starts beside the crossings.
STARTS = 3


@dataclass(frozen=True)
class Synthesis:
    """Crank-rockers that meet the targets, or the nearest one.

    Attributes
    ----------
    designs : tuple of LinkageDesign
        All that meet the targets: those within the limits first, then by transmission angle.
    nearest : LinkageDesign or None
        Without a design, the one with the least sum of squared relative deviations.
    statement : str
        The result in one sentence.
    """

    designs: tuple[LinkageDesign, ...]
    nearest: LinkageDesign | None
    statement: str


@dataclass(frozen=True)
class _Target:
    """A measure and the value that it must take."""

    name: str
    measure: Callable[[Links], Values]
    wanted: float

    def deviation(self, links: Links) -> Values:
        """Relative deviation from the wanted value; large where a linkage folds flat."""
        deviation = self.measure(links) / self.wanted - 1
        if isinstance(deviation, float):  # numpy takes ten times as long for one number
            return LARGE if deviation != deviation else max(-LARGE, min(float(deviation), LARGE))
        return np.clip(np.nan_to_num(deviation, nan=LARGE), -LARGE, LARGE)


# Place where the first target is met, and the deviation of the second.
_Point: TypeAlias = tuple[Array, float]


@dataclass(frozen=True)
class _Limits:
    """Limits that a design must satisfy besides its targets."""

    transmission: float
    size: tuple[float, float]
    width: float

    def score(self, links: Links) -> Values:
        """Minimum transmission angle, or minus the excess over the limits if one is violated."""
        angle = least_transmission(links)
        sides = zip(space(links, self.width), self.size, strict=True)
        excess = sum(np.maximum(side / limit - 1, 0.0) for side, limit in sides)
        excess = excess + np.maximum(self.transmission - angle, 0.0)
        return np.where(excess > ATTAINED, -excess, angle)


@formula(crank_speed="number")
def synthesise_crank_rocker(
    *,
    swing: float | None = None,
    speed_ratio: float | None = None,
    time_ratio: float | None = None,
    crank_speed: float | None = None,
    rocker_speed: float | None = None,
    least_transmission_angle: float = 0.0,
    largest_size: tuple[float, float] = (np.inf, np.inf),
    link_width: float = 0.0,
    crank: float | None = None,
    coupler: float | None = None,
    rocker: float | None = None,
    ground: float | None = None,
    longest_link: float | None = None,
) -> Synthesis:
    """Find the crank-rockers that meet targets with two or more links given, or one for its scale.

    As many targets as unknown links: all solutions. Fewer: the one of a family with the largest
    least transmission angle within the limits, or nearest to them where none keeps them. More, or
    targets out of reach: the nearest linkage by least squares of the relative deviations. Both
    senses of a time ratio are searched, and both strokes for the speed. Mirrored assemblies have
    the same measures and are not listed twice. With one link and two targets the others follow from
    the largest least transmission angle of the family.

    Parameters
    ----------
    swing : float, optional
        Wanted largest less smallest rocker angle. [rad]
    speed_ratio : float, optional
        Wanted greatest rocker speed over crank speed. [1]
    time_ratio : float, optional
        Wanted duration of the slower stroke over that of the quicker one, at least 1. [1]
    crank_speed, rocker_speed : float, optional
        Speed of the crank and wanted greatest rocker speed. Both make a speed ratio; the rocker
        speed alone gives the crank speed of each design. [rad/s]
    least_transmission_angle : float
        Smallest acute angle between coupler and rocker that is accepted. [rad]
    largest_size : (float, float)
        Largest space that the links sweep, along and across the ground link. [m]
    link_width : float
        Width of the links, with round ends about their joints; 0 for the space of the joint
        centres. [m]
    crank, coupler, rocker, ground : float, optional
        Given lengths, two at least; one with two targets. [m]
    longest_link : float, optional
        Longest link that is considered; default: ten times the longest given one. [m]

    Returns
    -------
    Synthesis
        All designs with their measures, or the nearest one, and a sentence.

    Raises
    ------
    ModelError
        Fewer than two lengths, but for one with two targets, two unknown lengths without a target,
        a value out of its range, speeds that contradict the speed ratio, or lengths that no
        crank-rocker has.

    Examples
    --------
    The crank that swings the rocker of Farzaneh (2002) by 26 degrees, and its speed for 24 rpm:

    >>> found = synthesise_crank_rocker(
    ...     swing=np.radians(26),
    ...     rocker_speed=24 * np.pi / 30,
    ...     coupler=0.44,
    ...     rocker=0.26,
    ...     ground=0.51,
    ... )
    >>> print(found.statement)
    1 crank-rocker meets the targets.
    >>> (design,) = found.designs
    >>> print(f"{100 * design.linkage.crank:.4f} cm, {design.crank_speed * 30 / np.pi:.2f} rpm")
    5.8484 cm, 105.42 rpm
    """
    lengths = {"crank": crank, "coupler": coupler, "rocker": rocker, "ground": ground}
    given = {name: value for name, value in lengths.items() if value is not None}
    wanted = {"swing": swing, "speed_ratio": speed_ratio, "time_ratio": time_ratio}
    targets = {name: value for name, value in wanted.items() if value is not None}
    _refuse_impossible(targets, largest_size)
    if crank_speed is not None and rocker_speed is not None:
        if speed_ratio is not None:
            raise ModelError("crank_speed and rocker_speed fix speed_ratio; give two of the three.")
        targets["speed_ratio"] = rocker_speed / crank_speed
        rocker_speed = None
    if len(given) == 1 and len(targets) == 2:
        return _best_scale(
            given,
            longest_link=longest_link,
            swing=swing,
            speed_ratio=targets.get("speed_ratio"),
            time_ratio=time_ratio,
            crank_speed=crank_speed,
            rocker_speed=rocker_speed,
            least_transmission_angle=least_transmission_angle,
            largest_size=largest_size,
            link_width=link_width,
        )
    if len(given) < 2:
        raise ModelError(
            "two of crank, coupler, rocker and ground at least must be given, or one with two of "
            f"swing, speed ratio and time ratio; got {', '.join(given) or 'none'}: with less, the "
            "linkages are too many to search for the best."
        )
    if len(given) == 2 and not targets:
        raise ModelError("two unknown lengths need a target: swing, speed_ratio or time_ratio.")

    # every branch is a set of smooth equations: one stroke for the speed, one sense of time
    domain = find_domain(given, longest_link)
    limits = _Limits(least_transmission_angle, largest_size, link_width)
    places: list[Array] = []
    for branch in _branches(targets):
        places += _solve(domain, branch, limits)

    designs: list[LinkageDesign] = []
    for place in places:
        lengths_there = np.array([float(length) for length in domain.links(place)])
        try:
            linkage = CrankRocker(*lengths_there.tolist())
        except ModelError:  # rounding makes it fold flat
            if domain.unknown:
                continue
            raise
        found = measure_linkage(
            linkage, crank_speed=crank_speed, rocker_speed=rocker_speed, link_width=link_width
        )
        found = replace(found, departures=_departures(found, targets, limits))
        others = [np.array(design.linkage.links) for design in designs]
        if not any(np.all(np.abs(lengths_there - one) <= SAME * one) for one in others):
            designs.append(found)
    return _conclude(designs, targets, domain)


def _best_scale(given: dict[str, float], *, longest_link: float | None, **wanted: Any) -> Synthesis:
    """Search the free length for the best transmission angle, given one length and two targets."""
    ((name, length),) = given.items()
    free = "rocker" if name == "ground" else "ground"
    longest = 10 * length if longest_link is None else longest_link

    def solve(log_length: float) -> Synthesis | None:
        lengths: dict[str, Any] = {name: length, free: float(np.exp(log_length))}
        try:
            return synthesise_crank_rocker(**lengths, longest_link=longest, **wanted)
        except ModelError:  # no crank-rocker has these lengths
            return None

    def score(found: Synthesis | None) -> float:
        if found is None or not found.designs:
            return -np.pi
        best = found.designs[0]
        return best.least_transmission - (np.pi / 2 if best.departures else 0.0)

    axis = np.linspace(np.log(0.1 * length), np.log(longest), SCALES)
    scores = [score(solve(place)) for place in axis.tolist()]
    k = int(np.argmax(scores))
    found = solve(_lowest(lambda place: -score(solve(place)), axis, k))
    found = max((found, solve(float(axis[k]))), key=score)
    if found is None or not found.designs:
        raise ModelError(
            f"with {name} alone no crank-rocker meets both targets at any {free}; give two links "
            "for the nearest one."
        )
    statement = "1 crank-rocker meets the targets; of a family, the one with the best transmission"
    return replace(found, designs=found.designs[:1], statement=f"{statement} angle.")


def _refuse_impossible(targets: dict[str, float], size: tuple[float, float]) -> None:
    """Refuse targets that no linkage of any size has."""
    if not targets.get("swing", 0.0) < np.pi:
        degrees = np.degrees(targets["swing"])
        raise ModelError(f"swing must be below half a turn, got {degrees:g} degrees.")
    if not targets.get("time_ratio", 1.0) >= 1:
        raise ModelError(f"time_ratio must be at least 1, got {targets['time_ratio']:g}.")
    for side in size:
        if not side > 0:
            raise ModelError(f"largest_size must be positive, got {side:g} m.")


def _branches(targets: dict[str, float]) -> Iterator[list[_Target]]:
    """Yield the combinations of smooth equations that together cover the targets."""
    choices: list[list[_Target]] = []
    if "swing" in targets:
        choices.append([_Target("swing", measures.swing, targets["swing"])])
    if "speed_ratio" in targets:
        strokes = [partial(measures.speed_ratio, rising=rising) for rising in (True, False)]
        choices.append([_Target("speed_ratio", of, targets["speed_ratio"]) for of in strokes])
    if "time_ratio" in targets:
        ratios = {targets["time_ratio"], 1 / targets["time_ratio"]}
        choices.append(
            [_Target("time_ratio", measures.time_ratio, ratio) for ratio in sorted(ratios)]
        )
    return (list(branch) for branch in product(*choices))


def _solve(domain: Domain, branch: list[_Target], limits: _Limits) -> list[Array]:
    """Find where one branch of equations is solved or nearly so; for a family, the best place."""
    unknown = len(domain.unknown)
    if not unknown:
        return [np.empty(0)]
    if not branch:
        return [_best_on_line(domain, limits)]
    if len(branch) == 1 and unknown == 1:
        return _roots_on_line(lambda u: branch[0].deviation(domain.links([u])))
    if len(branch) == 1:
        return _best_of_family(domain, branch[0], limits)

    def deviations(place: Array) -> Array:
        return np.stack([target.deviation(domain.links(place)) for target in branch])

    return _least_squares(domain, branch, deviations)


def _axis(count: int) -> Array:
    """Places from edge to edge, denser towards both, where measures change as square roots."""
    return EDGE + (1 - 2 * EDGE) * (1 - np.cos(np.linspace(0, np.pi, count))) / 2


def _roots_on_line(deviation: Callable[[Values], Values]) -> list[Array]:
    """All zeros of a function of one unknown; without one, where it is nearest to zero."""
    axis = _axis(LINE)
    values = deviation(axis)
    roots = _zeros(deviation, axis, values)
    if not roots:
        k = int(np.argmin(np.abs(values)))
        inside = _lowest(lambda u: abs(float(deviation(u))), axis, k)
        roots = [min((inside, axis[k]), key=lambda u: abs(float(deviation(u))))]
    return [np.array([root]) for root in roots]


def _zeros(deviation: Callable[[Values], Values], axis: Array, values: Array) -> list[float]:
    """All zeros of a function along an axis, from its values there."""

    def dip(k: int) -> float:
        return _lowest(lambda u: signs[k] * float(deviation(u)), axis, k)

    # a dip between two places hides two zeros; that of a parabola is shallower than its step
    signs, sizes = np.sign(values), np.abs(values)
    steps = np.abs(np.diff(values))
    hidden = 1 + np.flatnonzero(
        (signs[:-2] == signs[1:-1])
        & (signs[2:] == signs[1:-1])
        & (sizes[1:-1] <= np.minimum(sizes[:-2], sizes[2:]))
        & (sizes[1:-1] <= np.maximum(steps[:-1], steps[1:]))
    )
    extra = [dip(k) for k in hidden.tolist()]
    axis = np.append(axis, extra)
    values = np.append(values, [float(deviation(u)) for u in extra])
    order = np.argsort(axis)
    axis, values = axis[order], values[order]

    changes = np.flatnonzero(np.sign(values[:-1]) * np.sign(values[1:]) < 0)
    roots = [scipy.optimize.brentq(deviation, axis[k], axis[k + 1], xtol=1e-16) for k in changes]
    return [float(root) for root in (*roots, *axis[np.abs(values) < ATTAINED / 10])]


def _lowest(function: Callable[[float], Values], axis: Array, k: int) -> float:
    """Place of the minimum of a function between the neighbours of a place of an axis."""
    ends = axis[max(k - 1, 0)], axis[min(k + 1, axis.size - 1)]
    minimum = scipy.optimize.minimize_scalar(
        function, bounds=ends, method="bounded", options={"xatol": 1e-12}
    )
    return float(minimum.x)


def _best_on_line(domain: Domain, limits: _Limits) -> Array:
    """Place of the best transmission angle over one unknown length."""
    axis = _axis(LINE)
    k = int(np.argmax(limits.score(domain.links([axis]))))
    return np.array([_lowest(lambda u: -limits.score(domain.links([u])), axis, k)])


def _zeros_on_row(domain: Domain, target: _Target, row: float, values: Array) -> list[Array]:
    """All places of one row of the square where a target is met, from its deviations there."""

    def deviation(v: Values) -> Values:
        return target.deviation(domain.links([row, v]))

    return [np.array([row, root]) for root in _zeros(deviation, _axis(SQUARE), values)]


def _best_of_family(domain: Domain, target: _Target, limits: _Limits) -> list[Array]:
    """Best place on the curve along which one target is met by two unknown lengths."""
    axis = _axis(SQUARE)
    square = np.stack(np.meshgrid(axis, axis, indexing="ij"))
    values = target.deviation(domain.links(square))

    def across(u: float) -> list[Array]:
        along = target.deviation(domain.links([u + 0 * axis, axis]))
        return _zeros_on_row(domain, target, u, along)

    def score(u: float) -> float:
        return max((float(limits.score(domain.links(p))) for p in across(u)), default=-np.inf)

    rows = [row for row in range(SQUARE) if _zeros_on_row(domain, target, axis[row], values[row])]
    if not rows:
        place = np.clip(np.unravel_index(np.argmin(np.abs(values)), values.shape), 1, SQUARE - 2)
        return [_fit(lambda p: target.deviation(domain.links(p)), axis[place], MOST_CALLS).x]

    # the best row first, then between its neighbours
    row = max(rows, key=lambda row: score(float(axis[row])))
    best = max((_lowest(lambda u: -score(u), axis, row), float(axis[row])), key=score)
    return [max(across(best), key=lambda place: float(limits.score(domain.links(place))))]


def _least_squares(
    domain: Domain, branch: list[_Target], deviations: Callable[[Array], Array]
) -> list[Array]:
    """All zeros of several functions, or the least sum of their squares."""
    crossings, minima = _starts(domain, branch, deviations)
    fits = [_fit(deviations, start, MOST_CALLS) for start in crossings]
    fits += [_fit(deviations, start, CALLS) for start in minima]
    # a minimum far from zero is refined only where nothing else is found
    if not any(_is_solved(fit) for fit in fits):
        nearest = np.clip(min(fits, key=attrgetter("cost")).x, 2 * EDGE, 1 - 2 * EDGE)
        fits.append(_fit(deviations, nearest, MOST_CALLS))
    return [fit.x for fit in fits if _is_solved(fit)] or [min(fits, key=attrgetter("cost")).x]


def _fit(deviations: Callable[[Array], Values], start: Array, calls: int) -> Any:
    """Least squares from a start within the square."""
    return scipy.optimize.least_squares(
        deviations,
        start,
        bounds=(EDGE, 1 - EDGE),
        xtol=STEP,
        ftol=1e-15,
        gtol=1e-15,
        max_nfev=calls,
    )


def _is_solved(fit: Any) -> bool:
    return bool(np.abs(fit.fun).max() < ATTAINED)


def _starts(
    domain: Domain, branch: list[_Target], deviations: Callable[[Array], Array]
) -> tuple[list[Array], list[Array]]:
    """Starting points: sign changes of the second target where the first is met, and minima."""
    if len(domain.unknown) == 1:
        axis = _axis(LINE)
        sums = (deviations(axis[None]) ** 2).sum(axis=0)
        inner = np.flatnonzero(sums == scipy.ndimage.minimum_filter(sums, size=3, mode="nearest"))
        return [], [np.array([axis[np.clip(k, 1, LINE - 2)]]) for k in inner]

    axis = _axis(SQUARE)
    square = np.stack(np.meshgrid(axis, axis, indexing="ij"))
    values = np.stack([target.deviation(domain.links(square)) for target in branch])
    sums = (values**2).sum(axis=0)
    lowest = sums == scipy.ndimage.minimum_filter(sums, size=3, mode="nearest")
    order = np.argwhere(lowest)[np.argsort(sums[lowest])][:STARTS]
    minima = [axis[np.clip(place, 1, SQUARE - 2)] for place in order]

    # the curve of the first target, row by row; nearly parallel curves cross at flat angles
    curves: dict[int, list[_Point]] = {}
    for row, u in enumerate(axis):
        for place in _zeros_on_row(domain, branch[0], u, values[0, row]):
            curves.setdefault(row, []).append((place, float(deviations(place)[1])))
    crossings = [
        one + (two - one) * before / (before - after)
        for row, points in curves.items()
        for (one, before), (two, after) in _neighbours(points, curves.get(row + 1, []))
        if before * after < 0 and abs(one[1] - two[1]) < NEIGHBOURS
    ]
    return crossings, minima


def _neighbours(points: list[_Point], following: list[_Point]) -> list[tuple[_Point, _Point]]:
    """Pairs of points of two rows that may lie on one curve; curves of one row keep their order."""
    if len(points) == len(following):
        in_order = [
            sorted(row, key=lambda point: float(point[0][1])) for row in (points, following)
        ]
        return list(zip(*in_order, strict=True))
    return list(product(points, following))


def _departures(
    design: LinkageDesign, targets: dict[str, float], limits: _Limits
) -> tuple[str, ...]:
    """Describe the targets and limits that a design misses."""
    departures = []
    for name, wanted in targets.items():
        got = getattr(design, name)
        if abs(got / wanted - 1) > ATTAINED:
            departures.append(
                f"{name.replace('_', ' ')} {_text(name, got)}, not {_text(name, wanted)}"
            )
    angle = design.least_transmission
    if angle < limits.transmission - ATTAINED:
        least = np.degrees(limits.transmission)
        departures.append(f"transmission angle {np.degrees(angle):.2f} degrees, below {least:g}")
    for side, limit, way in zip(design.space, limits.size, ("along", "across"), strict=True):
        if side > limit * (1 + ATTAINED):
            departures.append(f"{1e3 * side:.1f} mm {way} the ground link, above {1e3 * limit:g}")
    if design.folds_flat:
        departures.append("all links fold onto one line")
    return tuple(departures)


def _text(name: str, value: float) -> str:
    """Text of a target."""
    return f"{np.degrees(value):.4f} degrees" if name == "swing" else f"{value:.6g}"


def _conclude(designs: list[LinkageDesign], targets: dict[str, float], domain: Domain) -> Synthesis:
    """Sort the designs and state the result."""

    def miss(design: LinkageDesign) -> float:
        deviations = [getattr(design, name) / wanted - 1 for name, wanted in targets.items()]
        return float(np.sum(np.square(deviations)))

    def order(design: LinkageDesign) -> tuple[bool, float]:
        return bool(design.departures), -design.least_transmission

    met = [design for design in designs if miss(design) < len(targets) * ATTAINED**2]
    if not met and not targets:
        met = designs
    if not designs:
        raise ModelError("the given lengths leave crank-rockers of one position only.")
    if not met:
        nearest = min(designs, key=miss)
        reason = "; ".join(nearest.departures)
        return Synthesis((), nearest, f"No crank-rocker meets the targets; nearest: {reason}.")
    kept = sum(not design.departures for design in met)
    statement = "1 crank-rocker meets" if len(met) == 1 else f"{len(met)} crank-rockers meet"
    statement += " the targets"
    if kept < len(met):
        statement += f", {kept or 'none'} within the limits"
    if len(domain.unknown) > len(targets):
        chosen = "with the best transmission angle" if kept else "nearest to the limits"
        statement += f"; of a family, the one {chosen}"
    return Synthesis(tuple(sorted(met, key=order)), None, statement + ".")
