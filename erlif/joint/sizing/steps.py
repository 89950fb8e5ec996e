"""A step of the guide: what is compared, how much is left, where it holds, what else could be done.

Steps are products: pressures in MPa, lengths in mm, plays in um, temperatures in degC.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

ROUNDING = 1e-9
"""Margin below which a limit is exceeded; a dimension that is just enough has a margin of 0."""

Kind = Literal["limit", "recommendation", "comparison", "result"]


@dataclass(frozen=True)
class Step:
    """One step of the guide for one joint.

    Attributes
    ----------
    key : str
        Name for programs, ``"pin_shear"``.
    title : str
        What is checked.
    equation : str
        Equation or section of Strand (2005), chapter 2.
    kind : str
        ``"limit"`` of strength, temperature or wear; ``"recommendation"`` of experience;
        ``"comparison"`` with another equation for the same quantity; ``"result"`` without a limit.
    quantity : str
        What is compared.
    unit : str
        Its unit.
    present : float
        Its value in this joint; NaN where it cannot be computed.
    allowed : tuple[float, float]
        Lowest and highest value allowed; infinite where there is no such end.
    margin : float
        Allowed over present value less 1, at the nearer end of a range: 0 where the limit is just
        met, negative where it is exceeded, NaN without a limit.
    valid : bool
        Whether the equation holds for this joint.
    validity : str
        Where the equation holds.
    reason : str
        Why the step is made.
    alternatives : tuple[str, ...]
        What raises the margin.
    missing : str
        What has to be given for this step; empty where it is computed.
    numbers : tuple[tuple[str, float, str], ...]
        Further results: name, value and unit.
    basis : str
        What the margin refers to where that is not the value beside it: ``"rise over the
        outside"``; empty where it is.
    """

    key: str
    title: str
    equation: str
    kind: Kind
    quantity: str
    unit: str
    present: float
    allowed: tuple[float, float]
    margin: float
    valid: bool
    validity: str
    reason: str
    alternatives: tuple[str, ...] = ()
    missing: str = ""
    numbers: tuple[tuple[str, float, str], ...] = ()
    basis: str = ""

    @property
    def holds(self) -> bool:
        """Whether the value lies within what is allowed, or has no limit."""
        return not self.margin < -ROUNDING

    @property
    def governs(self) -> bool:
        """Whether the step is a limit with a margin."""
        return self.kind == "limit" and not self.missing and not math.isnan(self.margin)

    @property
    def state(self) -> str:
        """The outcome in one or two words."""
        if self.missing:
            return "not computed"
        if math.isnan(self.margin):
            return "result"
        if self.kind == "comparison" and not self.valid:
            return "not valid here"
        outcome = ("holds", "fails") if self.kind != "recommendation" else ("inside", "outside")
        return outcome[not self.holds] + ("" if self.valid else ", not valid")

    def number(self, name: str) -> float:
        """One of the further results.

        Examples
        --------
        >>> step = make_step("a", "b", "c", "result", "d", "e", 1.0, numbers=(("f", 2.0, "mm"),))
        >>> step.number("f")
        2.0
        """
        return next(value for key, value, _ in self.numbers if key == name)


def margin_below(present: float, allowed: float) -> float:
    """Margin of a value that must not exceed a limit.

    Parameters
    ----------
    present, allowed : float
        Value and limit, in one unit.

    Returns
    -------
    float
        Allowed over present value less 1; infinite where nothing is demanded, -1 where nothing is
        allowed.

    Examples
    --------
    >>> margin_below(200.0, 300.0), margin_below(0.0, 300.0), margin_below(1.0, 0.0)
    (0.5, inf, -1.0)
    """
    if present <= 0:
        return math.inf if allowed >= present else -1.0
    return -1.0 if math.isinf(present) else max(allowed, 0.0) / present - 1


def margin_between(present: float, allowed: tuple[float, float]) -> float:
    """Margin of a value that lies in a range of positive ends.

    Parameters
    ----------
    present : float
    allowed : tuple of float
        Lowest and highest value.

    Returns
    -------
    float
        That of the nearer end; below -1 for a value of the wrong sign.

    Examples
    --------
    >>> margin_between(1.0, (0.5, 1.5)), margin_between(0.0, (0.3, 5.0))
    (0.5, -1.0)
    """
    low, high = allowed
    lower = math.inf if low <= 0 else present / low - 1
    upper = math.inf if math.isinf(high) else margin_below(present, high)
    return min(lower, upper)


def make_step(
    key: str,
    title: str,
    equation: str,
    kind: Kind,
    quantity: str,
    unit: str,
    present: float,
    *,
    most: float = math.inf,
    least: float = -math.inf,
    margin: float | None = None,
    basis: str = "",
    valid: bool = True,
    validity: str = "",
    reason: str = "",
    alternatives: tuple[str, ...] = (),
    numbers: tuple[tuple[str, float, str], ...] = (),
) -> Step:
    """Make a step with its margin.

    Parameters
    ----------
    key, title, equation, kind, quantity, unit, present
        As in `Step`.
    most, least : float
        Ends of what is allowed.
    margin : float, optional
        Default: that of the value within its ends.
    basis, valid, validity, reason, alternatives, numbers
        As in `Step`.

    Returns
    -------
    Step

    Examples
    --------
    >>> make_step("a", "b", "eq. 1", "limit", "stress", "MPa", 200.0, most=300.0).state
    'holds'
    """
    allowed = (least, most)
    unlimited = math.isinf(least) and math.isinf(most)
    if margin is None:
        margin = math.nan if unlimited else margin_between(present, allowed)
    return Step(
        key,
        title,
        equation,
        kind,
        quantity,
        unit,
        present,
        allowed,
        margin,
        valid,
        validity,
        reason,
        alternatives,
        "",
        numbers,
        basis,
    )


def missing_step(key: str, title: str, equation: str, kind: Kind, missing: str) -> Step:
    """Make a step that cannot be computed, with what has to be given for it.

    Parameters
    ----------
    key, title, equation, kind, missing
        As in `Step`.

    Returns
    -------
    Step

    Examples
    --------
    >>> missing_step("pv", "pv", "section 2.1.13", "limit", "[motion]").state
    'not computed'
    """
    nan = math.nan
    return Step(
        key,
        title,
        equation,
        kind,
        "",
        "",
        nan,
        (-math.inf, math.inf),
        nan,
        True,
        "",
        "",
        (),
        missing,
    )
