"""The smooth gap of a run: one choice for all of its triggers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from erlif.core.notes import Note, remark, warn
from erlif.pipeline.engines.results import TriggerResult
from erlif.trend import GapShape, choose_contact

_GAPS = {
    GapShape.PLANE: "a plane film with a tilt",
    GapShape.LINE: "a gap that is curved along sliding (line contact)",
    GapShape.JOURNAL: "a gap that is bent along the axis of the pin",
    GapShape.POINT: "a gap that is curved along and across sliding (point contact)",
    GapShape.PLATEAU: "a plateau with a constriction at its edge (elastic contact)",
}


def settle_contact(
    results: Sequence[TriggerResult], contacts: Sequence[GapShape]
) -> tuple[list[TriggerResult], GapShape]:
    """Choose the kind of contact of the run and set the minimum of all triggers by it.

    Parameters
    ----------
    results : sequence of TriggerResult
    contacts : sequence of GapShape
        Gaps that the surfaces may have.

    Returns
    -------
    results : list of TriggerResult
        With one minimum each.
    contact : GapShape
    """
    if len(contacts) == 1:
        return list(results), contacts[0]
    contact = choose_contact([one.minima for one in results])
    return [
        replace(one, statistics=replace(one.statistics, gap=one.minima[contact])) for one in results
    ], contact


def note_contact(results: Sequence[TriggerResult], contact: GapShape) -> list[Note]:
    """Notes on the gap that was chosen, and on triggers whose map no smooth gap describes.

    Parameters
    ----------
    results : sequence of TriggerResult
        With one minimum each.
    contact : GapShape

    Returns
    -------
    list of Note
    """
    notes = []
    bent = any(np.isfinite(gap.bend).all() for one in results for gap in one.minima.values())
    straight = contact is GapShape.LINE and any(GapShape.JOURNAL in one.minima for one in results)
    if bent and not straight:
        text = f"the minimum of {_GAPS[contact]}, chosen by the maps of all triggers"
        notes.append(remark("film_min", text))

    statistics = [one.statistics for one in results]
    gaps = [one.gap for one in statistics]
    count = sum(one.departs and math.isnan(one.gap.minimum.value) for one in statistics)
    if count:
        text = (
            f"NaN at {count} of {len(gaps)} triggers: {_GAPS[contact]} departs from their maps by "
            "more than noise and marks. Its minimum is off by more than 0.1 um and a tenth; maps "
            "and film_mean hold: take quantiles of the maps, or a smaller region of interest about "
            "the thinnest film"
        )
        notes.append(warn("film_min", text))

    # a plateau has a centre also where its minimum is not known
    cut = sum(np.isnan(one.minimum.value) and np.isfinite(one.central.value) for one in gaps)
    if cut:
        text = (
            f"NaN at {cut} of {len(gaps)} triggers: the region of interest does not hold the whole "
            "contact, or its pixels do not resolve the constriction; film_central holds. Widen roi "
            "in [thickness], or photograph the contact larger"
        )
        notes.append(warn("film_min", text))
    return notes
