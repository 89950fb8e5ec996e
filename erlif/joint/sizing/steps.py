"""A step of the guide: what is compared, how much is left, where it holds, what else could be done.

Steps are products: pressures in MPa, lengths in mm, plays in um, temperatures in degC.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from string import Formatter
from typing import Literal

from erlif.core.tables import read_table
from erlif.joint.sizing.materials import BRINELL

# Margin below which a limit is exceeded; a dimension that is just enough has a margin of 0.
ROUNDING = 1e-9

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
    numbers : tuple[tuple[str, float, str], ...]
        Further results: name, value and unit.
    basis : str
        What the margin refers to where that is not the value beside it: ``"rise over the
        outside"``; empty where it is.
    missing : str
        What has to be given for this step; empty where it is computed.
    """

    key: str
    title: str
    equation: str
    kind: Kind
    quantity: str = ""
    unit: str = ""
    present: float = math.nan
    allowed: tuple[float, float] = (-math.inf, math.inf)
    margin: float = math.nan
    valid: bool = True
    validity: str = ""
    reason: str = ""
    alternatives: tuple[str, ...] = ()
    numbers: tuple[tuple[str, float, str], ...] = ()
    basis: str = ""
    missing: str = ""

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
        >>> from erlif.joint.sizing import assess_joint
        >>> from erlif.joint.sizing.design import example_joint
        >>> step = assess_joint(example_joint()).step("prong")
        >>> print(f"{step.number('lock force'):.1f} kN")
        50.0 kN
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


@dataclass(frozen=True)
class Result:
    """Result of an equation for a joint, in the units of the table of steps.

    Attributes
    ----------
    present : float
        The value that is compared; NaN where it cannot be computed.
    most : float
        Highest value allowed; NaN where it cannot be computed.
    least : float
        Lowest value allowed.
    margin : float | None
        None: that of the value within its ends.
    valid : bool
        Whether the equation holds for this joint.
    variant : str
        Table whose texts replace those of the step.
    missing : str
        What has to be given, where that is not in the table of steps.
    values : Mapping[str, float | str]
        Numbers and words of the texts, and the further results.
    """

    present: float = math.nan
    most: float = math.inf
    least: float = -math.inf
    margin: float | None = None
    valid: bool = True
    variant: str = ""
    missing: str = ""
    values: Mapping[str, float | str] = field(default_factory=dict)

    @property
    def unknown(self) -> bool:
        """Whether a number is missing with which value or limit would be known."""
        return math.isnan(self.present) or math.isnan(self.most)

    @property
    def unlimited(self) -> bool:
        """Whether there is no limit."""
        return math.isinf(self.least) and math.isinf(self.most)

    @property
    def share(self) -> float:
        """Margin: allowed over present value less 1; NaN without a limit."""
        if self.margin is not None:
            return self.margin
        if self.unknown or self.unlimited:
            return math.nan
        return margin_between(self.present, (self.least, self.most))


def strength_limit(
    enough: float,
    size: float,
    strength: float,
    safety: float,
    *,
    power: int = 1,
    factor: float = 1.0,
    valid: bool = True,
    variant: str = "",
    **values: float | str,
) -> Result:
    """Result of a stress that falls with a power of a size, from the least size of a model.

    Parameters
    ----------
    enough, size : float
        Size at which the stress is just allowed, and that of the joint. [m]
    strength : float
        Strength or hardness of the part. [Pa]
    safety : float
        Safety factor. [1]
    power : int
        That of the size by which the stress falls.
    factor : float
        By which the stress is higher than this law.
    valid, variant
        As in `Result`.
    **values : float or str
        More values of the texts. They have the least size, and the strength that would be enough as
        ``strength`` in MPa and ``hardness`` in HB.

    Returns
    -------
    Result

    Examples
    --------
    >>> strength_limit(0.02, 0.04, 600e6, 2.0, power=2).present
    75.0
    """
    needed = strength * factor * (enough / size) ** power
    least = {"least": enough * 1e3, "strength": needed / 1e6, "hardness": needed / BRINELL}
    present, most = needed / safety / 1e6, strength / safety / 1e6
    return Result(present, most=most, valid=valid, variant=variant, values={**least, **values})


def make_step(key: str, result: Result) -> Step:
    """Put the result of an equation into the words of the table.

    Parameters
    ----------
    key : str
        Name of the step.
    result : Result

    Returns
    -------
    Step

    Examples
    --------
    >>> make_step("pv", Result(0.1, most=1.5)).state, make_step("pv", Result()).missing
    ('holds', '[motion] half_swing and period')
    """
    steps = read_table("erlif.joint.sizing", "steps.toml")
    table = steps.get(steps[key].get("like"), {}) | steps[key]
    text, values = table | table.get(result.variant, {}), result.values
    title, kind = text["title"].format(**values), text.get("kind", "limit")
    if result.unknown and (missing := result.missing or text["missing"]):
        return Step(key, title, text["equation"], kind, missing=missing)

    return Step(
        key,
        title,
        text["equation"],
        "result" if result.unlimited and kind == "limit" else kind,
        quantity=text["quantity"],
        unit=text.get("unit", "MPa"),
        present=result.present,
        allowed=(result.least, result.most),
        margin=result.share,
        valid=result.valid,
        validity=text["validity"].format(**values),
        reason=text["reason"],
        alternatives=tuple(
            one.format(**values) for one in text.get("alternatives", ()) if _is_known(one, values)
        ),
        numbers=tuple(
            (name.format(**values), float(values[number]), unit)
            for name, number, unit in text.get("numbers", ())
            if not math.isnan(float(values[number]))
        ),
        basis=text.get("basis", ""),
    )


def _is_known(text: str, values: Mapping[str, float | str]) -> bool:
    """Whether the numbers of a text are finite."""
    names = [name for _, name, _, _ in Formatter().parse(text) if name]
    numbers = [value for name in names if not isinstance(value := values[name], str)]
    return all(math.isfinite(number) for number in numbers)
