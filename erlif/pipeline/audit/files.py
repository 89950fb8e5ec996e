"""Whether both cameras have the same images."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from erlif.core.notes import Note, list_some, warn
from erlif.pipeline.engines.results import FrameResult


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
