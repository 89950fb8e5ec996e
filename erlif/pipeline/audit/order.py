"""Whether the rows of the log belong to the pairs they stand beside."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from erlif.core.arrays import AnyArray
from erlif.core.notes import Note, list_some, warn
from erlif.core.units import count_of
from erlif.pipeline.audit.energy_order import compare_energies
from erlif.pipeline.audit.evidence import Evidence
from erlif.pipeline.audit.film_order import compare_film, find_other_films
from erlif.pipeline.audit.rows import Order

_MOST = 3000  # frames that are compared; more would only take time


def note_order(evidence: Evidence) -> Iterator[Note]:
    """Rows that belong to other pairs, by the energy of the pulses, else by the film.

    Parameters
    ----------
    evidence : Evidence

    Yields
    ------
    Note
    """
    size = slice(0, _MOST)
    numbers, energies, light = evidence.numbers[size], evidence.energies, evidence.light[size]
    if energies is not None:
        energies = energies[size]
        judged = compare_energies(energies, light)
        if judged is not None:
            found, odd = judged
            if found is not None:
                yield _note_other_order(
                    found, numbers, "the light of the pulses follows the energies"
                )
            elif odd.size:
                yield warn(
                    "log",
                    f"{_subject(numbers[odd])} of another place or of another recording: the light "
                    "is not that of the energy in the rows, or the energies are wrong. Compare "
                    "numbers of frames and rows",
                )
            else:
                yield from _note_by_film(evidence, numbers, known=True)
            return
    yield from _note_by_film(evidence, numbers, known=False)


def _note_by_film(evidence: Evidence, numbers: AnyArray, *, known: bool) -> Iterator[Note]:
    """The same by the film; the order is `known` where the energies decide it."""
    speed, levels = evidence.logged("rocker_speed"), evidence.levels[:_MOST]
    if speed is None:
        speed = evidence.logged("sliding_speed")
    if speed is None:
        return
    load = evidence.logged("joint_load")
    drive = np.abs(speed[:_MOST]) / (1.0 if load is None else load[:_MOST] / np.median(load))
    found = None if known else compare_film(drive, levels)
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
    """An order in words, and what to do."""
    if found.reverse:
        return warn(
            "log",
            f"the frames of both cameras are in reverse order: {fact} in the other one "
            f"({1 - found.left:.0%} of the variance). Number them in the order of the pulses",
        )
    rows = count_of(abs(found.lag), "row")
    where = "later" if found.lag > 0 else "earlier"
    if found.since:
        return warn(
            "log",
            f"from pair {numbers[found.since]} on the rows of the pairs stand {rows} {where} in "
            f"the log: {fact} there ({1 - found.left:.0%} of the variance). Pulses, frames or "
            "rows are missing: find them by the numbers of frames and rows, and leave out their "
            "partners",
        )
    return warn(
        "log",
        f"the rows of the pairs stand {rows} {where} in the log: {fact} there "
        f"({1 - found.left:.0%} of the variance). Remove the rows or frames that have no partner "
        "at the start",
    )
