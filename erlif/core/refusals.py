"""Errors whose texts stand in a table of the package that raises them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from erlif.core import errors
from erlif.core.tables import read_table


def refusal_writer(package: str) -> Callable[..., errors.ErlifError]:
    """Maker of the errors whose texts stand in ``refusals.toml`` of a package.

    Parameters
    ----------
    package : str

    Returns
    -------
    callable
        Key of the table, the class of the error where the table gives none, and by keyword what the
        text names; returns the error, to be raised.

    Examples
    --------
    >>> refusal_writer("erlif.joint")("few_positions", positions=1)
    OutputError('Expected a movie of 2 positions at least; got 1. Choose more of them.')
    """

    def write(
        name: str, error: type[errors.ErlifError] | None = None, /, **values: Any
    ) -> errors.ErlifError:
        entry = read_table(package, "refusals.toml")[name]
        kind: type[errors.ErlifError] = error or getattr(errors, entry["error"])
        return kind(entry["text"].format(**values))

    return write


refusal = refusal_writer("erlif.core")
