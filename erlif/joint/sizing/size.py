"""The dimensions that are not given: the least that satisfy the steps, or the next preferred ones.

Pin diameter and bushing width depend on each other: a wider bushing bends the pin more, a thicker
pin needs a narrower bushing. The least diameter at which all limits hold, each with its least
width, is found by bisection. With a given width or housing a thicker pin need not be enough, as it
slides faster and leaves less of the eye.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from erlif.core.errors import ConfigError
from erlif.joint.models.bearing import (
    LARGEST_HOLE_RATIO,
    RECOMMENDED_HOUSING,
    RECOMMENDED_PLAY,
    RECOMMENDED_WIDTH,
)
from erlif.joint.sizing import fit, pin, pressure
from erlif.joint.sizing.assessment import EQUATIONS
from erlif.joint.sizing.joint import DIMENSIONS, Joint, known, warn_of_units, without_unit_warnings
from erlif.joint.sizing.lock import size_lock
from erlif.joint.sizing.practice import (
    NARROW_SEAT,
    SMALLEST_MADE,
    Series,
    round_up,
    tolerance_grade_7,
)
from erlif.joint.sizing.state import JointState

# Wall of a bushing over the pin diameter where it is not given; no step of the guide. [1]
WALL = 0.1

# Width over diameter where no width is enough: that of the least leakage, section 2.1.4. [1]
WIDTH = 1.3

_SMALLEST, _LARGEST = 1e-4, 10.0  # m: pins that are looked for
_HALVINGS = 44  # of the logarithm of the diameter: to 1e-12 of it
_LADDER = 120  # pins that are tried where the thickest is not enough, 10 % apart
_CANDIDATES = 40  # preferred diameters that are tried, two decades of R20
_ROUNDS = 8  # in which the play settles; it only grows, and two are usual
_WIDEST = 14.0  # logarithm of the widest bushing over the one that edges and pv need


def size_joint(joint: Joint, *, series: Series = "none") -> Joint:
    """Choose the dimensions of a joint that are not given.

    Parameters
    ----------
    joint : Joint
    series : str
        Series of preferred numbers, ISO 3, to which lengths are rounded up: ``"R10"``, ``"R20"``,
        ``"R40"`` or ``"none"``. The play is rounded up to whole micrometres in a series.

    Returns
    -------
    Joint
        With all dimensions. Where no dimension is enough, a usual one is taken and its step fails.

    Raises
    ------
    ConfigError
        If the yield stress of the pin is not known and its diameter is to be chosen.

    Warns
    -----
    UnitWarning
        If a number of the joint is off by orders of magnitude.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from erlif.joint.sizing.design import example_joint
    >>> joint = replace(example_joint(), pin_diameter=None, bushing_width=None)
    >>> sized = size_joint(joint, series="R20")
    >>> print(f"{sized.pin_diameter * 1e3:g} mm, {sized.bushing_width * 1e3:g} mm")
    25 mm, 25 mm
    """
    if joint.pin_diameter is None and joint.pin.yield_stress is None:
        raise ConfigError(
            "Expected the yield stress of the pin, from which its diameter is chosen; got none. "
            "Give yield_stress or diameter in [pin]."
        )

    warn_of_units(joint)
    with without_unit_warnings():
        sized = _size(joint, series)
        if sized.lock is not None:
            sized = replace(sized, lock=size_lock(sized, sized.lock, series=series))
    return sized


def _size(joint: Joint, series: Series) -> Joint:
    """Choose all open dimensions of a joint but those of its lock."""
    # play that growth needs makes a narrower contact, which may need a wider bushing
    relative = RECOMMENDED_PLAY[0] * 1e-3
    for _ in range(_ROUNDS):
        sized = _Choice(joint, series, relative).sized()
        if joint.play is not None:
            break
        state = JointState(sized)
        d = state.size.pin
        # play of a series is no smaller than the tolerances by which it is made
        least = 0.0 if series == "none" else tolerance_grade_7(d)
        play = np.fmax(state.growth_loss, least)
        if not play > relative * d * (1 + 1e-9):
            play = max(state.least_play, least - state.gain)
            whole = play if series == "none" else math.ceil(play * 1e6 - 1e-6) / 1e6
            return replace(sized, play=whole)
        relative = float(play / d)
    return sized


# Limits whose present value is in proportion to 1 over the width of the bushing.
_BY_WIDTH = (
    "seizure",
    "bushing_edge",
    "pressure_limit",
    "pv",
    "temperature",
    "housing_eye",
    "wear",
)


@dataclass(frozen=True)
class _Choice:
    """Sizes of a joint for one series, an open play being a share `relative` of the diameter."""

    joint: Joint
    series: Series
    relative: float

    def sized(self) -> Joint:
        """The joint with all dimensions."""
        joint, (d, w) = self.joint, self.pin_and_width()
        wall = self.wall(d)
        state = self.trial(d, w, wall=wall)

        # the least sizes of both are NaN where a strength is not known
        seat, housing, bore = joint.seat_width, joint.housing_diameter, state.size.fit
        if seat is None:
            least = 1e-3 * float(pin.seat_edge(state).values["least"])
            practical = 0.0 if self.series == "none" else NARROW_SEAT * d
            enough = w / 2 if math.isnan(least) else least
            seat = round_up(max(enough, SMALLEST_MADE, practical), self.series)
        if housing is None:
            low, high = RECOMMENDED_HOUSING
            eye = 1e-3 * float(fit.eye(state).values["least"])
            least = float(np.fmax(low * bore, eye))
            housing = round_up(least, self.series) if math.isfinite(least) else high * bore
        sizes = (d, w, wall, seat, housing, self.play(d))
        changed: dict[str, Any] = dict(zip(DIMENSIONS, sizes, strict=True))
        return replace(joint, **changed)

    def wall(self, diameter: float) -> float:
        """Wall of the bushing. [m]"""
        return known(self.joint.wall, round_up(WALL * diameter, self.series))

    def play(self, diameter: float) -> float:
        """Play before the bushing is pressed in. [m]"""
        return known(self.joint.play, self.relative * diameter)

    def width(self, diameter: float) -> float:
        """Width of the bushing: given, or the least one, rounded; a usual one if none is enough."""
        if self.joint.bushing_width is not None:
            return self.joint.bushing_width
        low, high = (ratio * diameter for ratio in RECOMMENDED_WIDTH)
        least = max(self.least_width(diameter), low)
        width = round_up(least if math.isfinite(least) else WIDTH * diameter, self.series)
        # rounding does not leave the recommended proportion
        return round(high, 9) if least <= high < width else width

    def pin_and_width(self) -> tuple[float, float]:
        """Diameter of the pin and width of the bushing. [m]"""
        joint, series = self.joint, self.series
        if joint.pin_diameter is not None:
            return joint.pin_diameter, self.width(joint.pin_diameter)

        # the recommended proportion is kept where the limits leave it
        least = self.least_pin(keep_ratio=True) or self.least_pin(keep_ratio=False)
        if least is None:
            # the pin by strength alone
            d = _SMALLEST
            while not self.is_strong(d, joint.bushing_width or WIDTH * d) and d < _LARGEST:
                d *= 1.01
            d = self.round_pin(d)
            return d, known(joint.bushing_width, round_up(WIDTH * d, series))
        if series == "none":
            return least, self.width(least)

        # a rounded width bends the pin more, so the next diameter may be needed
        candidate = self.round_pin(least)
        tried: dict[float, float] = {}
        while len(tried) < _CANDIDATES and candidate not in tried:
            tried[candidate] = self.width(candidate)
            if self.is_enough(candidate, tried[candidate]):
                return candidate, tried[candidate]
            candidate = self.round_pin(candidate * 1.001)
        return next(iter(tried.items()))

    def round_pin(self, diameter: float) -> float:
        """The next preferred diameter, up to the largest one. [m]"""
        largest = known(self.joint.largest_diameter, math.inf)
        return min(round_up(diameter, self.series), largest)

    def least_pin(self, *, keep_ratio: bool) -> float | None:
        """Smallest pin diameter that satisfies all limits; None if there is none. [m]"""
        joint, width = self.joint, self.joint.bushing_width

        def enough(log_diameter: float) -> bool:
            return self.is_enough(math.exp(log_diameter), width, keep_ratio=keep_ratio)

        low, high = math.log(_SMALLEST), math.log(known(joint.largest_diameter, _LARGEST))
        if not enough(high):
            # a given width takes up only so much heat, a given housing only so thick a pin
            if width is None and joint.housing_diameter is None:
                return None
            step = (high - low) / _LADDER
            rung = next((n for n in range(1, _LADDER) if enough(low + n * step)), None)
            if rung is None:
                return None
            low, high = low + (rung - 1) * step, low + rung * step

        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            low, high = (low, middle) if enough(middle) else (middle, high)
        return math.exp(high)

    def is_enough(self, diameter: float, width: float | None, *, keep_ratio: bool = False) -> bool:
        """Whether all limits hold on a pin, with the given or the minimum width."""
        least = self.least_width(diameter)
        low, high = (ratio * diameter for ratio in RECOMMENDED_WIDTH)
        w = max(least, low) if width is None else width
        wide_enough = math.isfinite(w) and least <= w * (1 + 1e-12)
        return wide_enough and not (keep_ratio and w > high) and self.is_strong(diameter, w)

    def is_strong(self, diameter: float, width: float) -> bool:
        """Whether a pin holds in shear and in bending. Eqs. 1, 2 and 4."""
        if self.joint.hole_diameter > LARGEST_HOLE_RATIO * diameter:
            return False
        state = self.trial(diameter, width, wall=0.0)
        return not any(limit(state).share < 0 for limit in (pin.shear, pin.bending))

    def trial(self, diameter: float, width: float, *, wall: float) -> JointState:
        """A joint with a pin and a bushing that are tried, and their assembled play."""
        outer = self.joint.housing_diameter or self.joint.eye_ratio * (diameter + 2 * wall)
        sizes = (diameter, width, wall, width, outer, self.play(diameter))
        changed: dict[str, Any] = dict(zip(DIMENSIONS, sizes, strict=True))
        return JointState(replace(self.joint, **changed, interference=0.0))

    def least_width(self, diameter: float) -> float:
        """Minimum width for the limits of the sliding surface; infinite if none is enough. [m]"""
        trial = partial(self.trial, diameter, wall=self.wall(diameter))
        state, least = trial(diameter), 0.0
        if state.size.housing <= state.size.fit:
            return math.inf
        for key in _BY_WIDTH:
            if key == "temperature" and state.temperature_limit <= self.joint.outside_temperature:
                continue  # no width helps
            result = EQUATIONS[key](state)
            if result is not None and not math.isnan(result.share):
                # the margin is known at one width, and so is the width at which it is 0
                least = max(least, diameter / (1 + result.share) if result.share > -1 else math.inf)

        def margin_of_peak(log_width: float) -> float:
            return pressure.peak(trial(math.exp(log_width))).share

        if not 0 < least < math.inf or not margin_of_peak(math.log(least)) < 0:
            return least
        low, high = math.log(least), math.log(least) + _WIDEST
        if margin_of_peak(high) < 0:
            return math.inf

        from scipy.optimize import brentq  # rarely needed, and slow to load

        return math.exp(brentq(margin_of_peak, low, high, xtol=1e-14, rtol=1e-14))
