"""The film of a run before theory and maps are added, for tests of its statistics alone."""

from pathlib import Path

import pytest

import erlif
from erlif.pipeline.film import FilmDraft


class _Drafted(Exception):
    """The statistics are known."""


def draft_film(run: Path) -> FilmDraft:
    """Statistics, positions, errors and notes of a run; nothing is written.

    Writing the maps and reading them back would take most of the time of a small run.
    """
    drafts: list[FilmDraft] = []

    def end(draft: FilmDraft) -> FilmDraft:
        drafts.append(draft)
        raise _Drafted

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("erlif.pipeline.run.with_theory", end)
        with pytest.raises(_Drafted):
            erlif.process(run, workers=1)
    return drafts[0]
