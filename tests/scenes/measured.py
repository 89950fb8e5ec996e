"""The film of a run without its maps, for tests of statistics, notes and theory."""

from pathlib import Path
from typing import Any

import pytest
import xarray as xr

import erlif
from erlif.pipeline.film import with_record


class _MeasuredError(Exception):
    """All but the maps is known."""


def statistics_of(run: Path, *, theory: bool = False, **options: Any) -> xr.Dataset:
    """Statistics, positions, errors and notes of a run, with theory on request; nothing is written.

    Options are those of `process`.

    Writing the maps and reading them back takes most of the time of a small run.
    """
    films: list[xr.Dataset] = []

    def end(*measured):
        films.append(with_record(*measured)[0])
        raise _MeasuredError

    with pytest.MonkeyPatch.context() as patch:
        if not theory:
            patch.setattr("erlif.pipeline.run.with_theory", lambda draft: draft)
        patch.setattr("erlif.pipeline.run.with_record", end)
        with pytest.raises(_MeasuredError):
            erlif.process(run, workers=1, **options)
    return films[0]
