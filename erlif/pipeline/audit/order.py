"""Warnings of pairs that stand beside the rows of other pairs in the log.

They do by the energy of the pulses or, where the log has none, by a film that follows the speed.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from erlif.core.arrays import AnyArray
from erlif.core.notes import Note, list_some, warn
from erlif.core.units import count_of
from erlif.pipeline.audit.energies import Order
from erlif.pipeline.audit.evidence import MOST, Evidence
from erlif.pipeline.audit.film_order import compare_film, find_other_films


def note_order(evidence: Evidence) -> Iterator[Note]:
    """Warn of rows that belong to other pairs, by the energy of the pulses, else by the film.

    Parameters
    ----------
    evidence : Evidence

    Yields
    ------
    Note
    """
    numbers, judged = evidence.numbers[:MOST], evidence.order
    found, odd = judged or (None, np.array([], int))
    if found is not None:
        yield _note_other_order(found, numbers, "the light of the pulses follows the energies")
    elif odd.size:
        yield warn(
            "log",
            f"{_subject(numbers[odd])} of another place or of another recording: the light is not "
            "that of the energy in the rows, or the energies are wrong. Compare numbers of frames "
            "and rows",
        )
    else:
        yield from _note_by_film(evidence, numbers, known=judged is not None)


def _note_by_film(evidence: Evidence, numbers: AnyArray, *, known: bool) -> Iterator[Note]:
    """Warn of misplaced rows by the film; if the order is `known`, of single pairs only."""
    speed, levels = evidence.logged("rocker_speed"), evidence.levels[:MOST]
    if speed is None:
        speed = evidence.logged("sliding_speed")
    if speed is None:
        return
    load = evidence.logged("joint_load")
    size = np.abs(speed[:MOST])
    drive = size if load is None else size * np.median(load) / load[:MOST]
    found = None if known else compare_film(drive, levels, size=size)
    if found is not None:
        yield _note_other_order(found, numbers, "the film follows the speed")
        return
    odd = find_other_films(drive, levels)
    odd = odd[odd > 0]  # a camera keeps nothing of a pulse before its first one
    if odd.size:
        yield warn(
            "log",
            f"{_subject(numbers[odd])} of another place or of another recording, or the angles are "
            "wrong: the film does not follow the speed there. Compare numbers of frames and rows",
        )


def _subject(numbers: AnyArray) -> str:
    """Pairs as the subject of a sentence, with its verb."""
    return f"pair {numbers[0]} is" if numbers.size == 1 else f"pairs {list_some(numbers)} are"


def _note_other_order(found: Order, numbers: AnyArray, fact: str) -> Note:
    """Make the warning about an order of the rows, with the remedy."""
    if found.reverse:
        return warn(
            "log",
            f"the frames of both cameras are in reverse order: {fact} in the other one "
            f"({1 - found.left:.0%} of the variance). Number them in the order of the pulses",
        )
    start, cure = "", "Remove the rows or frames that have no partner at the start"
    if found.since:
        start = f"from pair {numbers[found.since]} on "
        cure = (
            "Pulses, frames or rows are missing: find them by the numbers of frames and rows, and "
            "leave out their partners"
        )
    return warn(
        "log",
        f"{start}the rows of the pairs stand {count_of(abs(found.lag), 'row')} "
        f"{'later' if found.lag > 0 else 'earlier'} in the log: {fact} there "
        f"({1 - found.left:.0%} of the variance). {cure}",
    )
