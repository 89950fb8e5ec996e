"""Records that are sent to other processes without what can be computed again there."""

from __future__ import annotations

from dataclasses import fields
from typing import Any


class PickledByFields:
    """Base of a dataclass whose cached properties are not pickled.

    Examples
    --------
    >>> import pickle
    >>> from erlif.core.notes import Level, Note
    >>> class Sent(PickledByFields, Note): pass
    >>> sorted(Sent(Level.NOTE, "camera1", "no flat").__getstate__())
    ['level', 'subject', 'text']
    """

    def __getstate__(self) -> dict[str, Any]:
        own = fields(self)  # type: ignore[arg-type]
        return {field.name: getattr(self, field.name) for field in own}
