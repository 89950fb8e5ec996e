"""The numbers of a joint: where they stand, how they are called, and which are plausible."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from functools import reduce
from typing import Any, NamedTuple

from erlif.core.tables import read_table
from erlif.models import arguments

_PARTS = {"pin": "pin", "bushing": "bushing", "seat": "seats", "housing": "housing"}


class Number(NamedTuple):
    """A number of a joint.

    Attributes
    ----------
    place : tuple[str, ...]
        Fields from the joint to it.
    value : float
        SI units.
    name : str
        For a reader; empty where it is not varied.
    by : str
        By how much it is varied.
    quantity : str
        What it measures, by which its size is judged; empty where it is not.
    """

    place: tuple[str, ...]
    value: float
    name: str
    by: str
    quantity: str


def numbers_of(joint: Any) -> Iterator[Number]:
    """Go through the numbers of a joint that are given.

    Parameters
    ----------
    joint : Joint

    Yields
    ------
    Number

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_joint
    >>> next(numbers_of(example_joint())).name
    'load'
    """
    places: list[tuple[tuple[str, ...], str, str]] = [((), "joint", "")]
    if joint.lock is not None:
        places += [(("lock",), "lock", ""), (("lock", "plate"), "plate", " of the plate")]
    places += [((part,), "material", f" of the {title}") for part, title in _PARTS.items()]
    for place, group, owner in places:
        table = reduce(getattr, place, joint)
        for field, known in read_table("erlif.joint.sizing", "quantities.toml")[group].items():
            value = getattr(table, field)
            if value is not None:
                name = known["name"] + owner if "name" in known else ""
                by, quantity = known.get("by", "1 %"), known.get("quantity", "")
                yield Number((*place, field), float(value), name, by, quantity)


def warn_of_units(joint: Any, *, dimensions: bool = True) -> None:
    """Warn of numbers of a joint that are so far off that a slip of units is likely.

    Parameters
    ----------
    joint : Joint
    dimensions : bool
        Whether lengths are inputs; False for those that were chosen.

    Warns
    -----
    UnitWarning
        Names the numbers, as ``"housing.yield_stress"``.

    Examples
    --------
    A strength in MPa:

    >>> import warnings
    >>> from dataclasses import replace
    >>> from erlif.joint.sizing.design import example_joint
    >>> joint = example_joint()
    >>> soft = replace(joint, housing=replace(joint.housing, yield_stress=335.0))
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     warn_of_units(soft)
    >>> print(str(caught[0].message).split(" is ")[0])
    housing.yield_stress = 335 Pa
    """
    given: defaultdict[str, dict[str, float]] = defaultdict(dict)
    for number in numbers_of(joint):
        # plays may be as small as rounding, but none is as large as a metre
        if number.quantity != "play":
            given[number.quantity][".".join(number.place)] = number.value
        elif abs(number.value) > 1:
            given["length"][".".join(number.place)] = number.value

    given.pop("", None)
    if not dimensions:
        given.pop("length", None)
    for quantity, values in given.items():
        arguments.warn_of_units(quantity, **values)
