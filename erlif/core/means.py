"""What a laboratory can do about the errors that frames do not show, and what each leaves.

`means.toml` is the list, with the meaning of its fields. The keys of a plan, the shortest list of
means for a target and its texts are made from it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from erlif.core.tables import read_table


@dataclass(frozen=True)
class Mean:
    """One thing to photograph, to log or to measure; fields as in `means.toml`."""

    what: str
    why: str
    effort: str
    leaves: Mapping[str, float | str] = field(default_factory=dict)
    to_patch: bool = False
    without_gap: bool = False


MEANS = {
    key: Mean(effort=effort, **row)
    for effort, rows in read_table("erlif.core", "means.toml").items()
    for key, row in rows.items()
}
