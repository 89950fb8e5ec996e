"""The audits of a run: one list."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

from erlif.core.notes import Level, Note, list_some, warn
from erlif.pipeline.audit.columns import note_columns, without_single
from erlif.pipeline.audit.crank import note_crank
from erlif.pipeline.audit.evidence import Evidence
from erlif.pipeline.audit.log import note_angles, note_conditions, note_speed
from erlif.pipeline.audit.mechanism import note_mechanism
from erlif.pipeline.audit.order import note_order
from erlif.pipeline.audit.strangers import note_strangers
from erlif.pipeline.engines.results import FrameResult


class Audit(NamedTuple):
    """One audit.

    Attributes
    ----------
    name : str
        What it looks at.
    find : Callable[[Evidence], Iterator[Note]]
        Its notes.
    """

    name: str
    find: Callable[[Evidence], Iterator[Note]]


def note_drive(evidence: Evidence) -> Iterator[Note]:
    """Warn of an encoder on another link than stated, else of a crank of another speed."""
    run = evidence.run
    yield from evidence.mounting or note_speed(run.log, evidence.located, run.settings)


def note_copied_cameras(frames: Iterable[FrameResult]) -> Iterator[Note]:
    """Pairs whose two files are the same to the last byte.

    Parameters
    ----------
    frames : iterable of FrameResult
        The files were hashed as they were read.

    Yields
    ------
    Note
    """
    # `refuse_stuck_cameras` refuses a run all of whose pairs are such
    same = [one.frame for one in frames if one.digests[0] and one.digests[0] == one.digests[1]]
    if same:
        yield warn(
            "pairs",
            f"both cameras show the same image in frame pairs {list_some(same)}, whose films mean "
            "nothing. Correct files in [camera1] or [camera2], or export the cameras again",
        )


# In the order of their notes: what makes others follow comes first. A bit that is always set and
# pairs of another recording look like another dark, which bends the ratio in many ways. All of them
# together take less than 0.3 s for a run of a few hundred pairs, of any size.
AUDITS = (
    Audit("files of both cameras", lambda one: note_copied_cameras(one.frames)),
    Audit("bits and noise of the counts", lambda one: iter(one.faults)),
    Audit("pairs of other recordings", note_strangers),
    Audit("order of pairs and rows", note_order),
    Audit("dark levels", lambda one: iter(one.darks)),
    Audit("place of the encoder, and speed of the crank", note_drive),
    Audit("readings of the encoder", note_crank),
    Audit("single values of the log", note_columns),
    Audit(
        "conditions",
        lambda one: note_conditions(without_single(one.run.log), one.run.settings),
    ),
    Audit("mechanism, and zero of its angle", note_mechanism),
    Audit("steps of the angle", lambda one: note_angles(one.run.log)),
)


def audit_run(evidence: Evidence) -> list[Note]:
    """Warnings of all audits, the likeliest cause first.

    Parameters
    ----------
    evidence : Evidence

    Returns
    -------
    list of Note
        Each text once.
    """
    notes = [note for audit in AUDITS for note in _try(audit, evidence)]
    return list(dict.fromkeys(note for note in notes if note.level is not Level.NOTE))


def _try(audit: Audit, evidence: Evidence) -> list[Note]:
    """Notes of an audit; a failure becomes one, because a film is worth more than its audit."""
    try:
        return list(audit.find(evidence))
    except (ArithmeticError, ValueError, IndexError) as error:
        text = (
            f"{audit.name} could not be audited: {error}. The film is not affected; look at these "
            "by eye, and report the failure"
        )
        return [warn("audit", text)]
