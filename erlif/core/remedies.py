"""What a laboratory can do about the errors that frames do not show, and what each leaves.

`remedies.toml` is the list, with the meaning of its fields. The keys of a plan, the shortest list
of remedies for a target and its texts are made from it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from erlif.core.tables import read_table


@dataclass(frozen=True)
class Remedy:
    """One thing to photograph, to log or to measure.

    Attributes
    ----------
    what : str
        Name in lists.
    why : str
        How it is stated, and where the width comes from that it leaves.
    effort : str
        Photographs, a log or a measurement.
    leaves : mapping of str to (float or str)
        Of a term, the standard deviation that remains [%]; or, as text, its share of the term at
        the end of the run: a number, or the width of a source of error.
    to_patch : bool
        Whether a patch of known film shows the errors of all films.
    without_gap : bool
        Whether the gap of the joint takes no errors out beside it.
    """

    what: str
    why: str
    effort: str
    leaves: Mapping[str, float | str] = field(default_factory=dict)
    to_patch: bool = False
    without_gap: bool = False


REMEDIES = {
    key: Remedy(effort=effort, **row)
    for effort, rows in read_table("erlif.core", "remedies.toml").items()
    for key, row in rows.items()
}
