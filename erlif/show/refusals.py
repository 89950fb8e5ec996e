"""Refusals of figures, pages and viewer, from one table of texts."""

from __future__ import annotations

from typing import Any

from erlif.core import errors
from erlif.core.tables import read_table


def refusal(name: str, /, **values: Any) -> errors.ErlifError:
    """Make the error of a refusal, to be raised.

    Parameters
    ----------
    name : str
        Key of ``refusals.toml``.
    **values
        What its text names.

    Returns
    -------
    ErlifError
        Of the class that the table gives.

    Examples
    --------
    >>> refusal("few_positions", positions=1)
    OutputError('Expected a movie of 2 positions at least; got 1. Choose more of them.')
    """
    entry = read_table("erlif.show", "refusals.toml")[name]
    error: errors.ErlifError = getattr(errors, entry["error"])(entry["text"].format(**values))
    return error
