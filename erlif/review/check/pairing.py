"""Which file of camera 1 belongs to which of camera 2, and to which row of the log."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from erlif.core.notes import Note, list_some, warn
from erlif.io.ingest import FramePairs, Run
from erlif.io.ingest.numbering import find_missing, frame_numbers


@dataclass(frozen=True)
class PairRow:
    """One row of the pairing table.

    Attributes
    ----------
    pair : int
        Number of the frame pair, counted from 0.
    camera1 : str
        File, with its page where it holds several.
    camera2 : str
        The same for camera 2.
    row : int | None
        Number of the frame in the log; None without a log.
    angle : float | None
        Encoder angle; None where it is not logged. [degree]
    time : float | None
        None where it is not logged. [s]
    """

    pair: int
    camera1: str
    camera2: str
    row: int | None = None
    angle: float | None = None
    time: float | None = None

    def __str__(self) -> str:
        text = f"pair {self.pair}: {self.camera1} with {self.camera2}"
        if self.row is not None:
            text += f", log frame {self.row}"
        if self.angle is not None:
            text += f", {self.angle:.2f} deg"
        if self.time is not None:
            text += f", {self.time:.6g} s"
        return text


_FIRST, _LAST = 2, 1  # pairs at both ends of the table
_LISTED = 20  # rows of the table at most


def tabulate_pairs(pairs: FramePairs, run: Run | None, *, odd: Iterable[int] = ()) -> list[PairRow]:
    """The first, the last and all odd pairs.

    Parameters
    ----------
    pairs : FramePairs
    run : Run, optional
        For its log; None for a fixture.
    odd : iterable of int
        Numbers of further pairs.

    Returns
    -------
    list of PairRow
    """
    # both ends show whether the recording was cut
    count = len(pairs.pages[0])
    ends = [*range(min(_FIRST, count)), *range(max(count - _LAST, 0), count)]
    chosen = sorted({*ends, *sorted(odd)[: _LISTED - len(ends)]})
    return [_pair_row(pairs, run, k) for k in chosen]


def _pair_row(pairs: FramePairs, run: Run | None, k: int) -> PairRow:
    one, two = pairs.pages[0][k].name, pairs.pages[1][k].name
    if run is None:
        return PairRow(k, one, two)
    log = run.log
    if run.settings.encoder is None or run.settings.encoder.file is None:
        return PairRow(k, one, two, time=float(log["time"][k]) if "time" in log else None)
    row = int(log.number[k]) if "number" in log else k
    angle = float(log.angle[k]) if "angle" in log else None
    time = float(log["time"][k]) if "time" in log else None
    return PairRow(k, one, two, row, angle, time)


def note_numbers(pairs: FramePairs) -> Iterator[Note]:
    """Gaps in the numbers of the files."""
    for camera, pages in enumerate(pairs.pages, 1):
        missing = find_missing(frame_numbers(pages))
        if missing:
            numbers, first, last = list_some(missing), pages[0].name, pages[-1].name
            yield warn(
                "pairs",
                f"camera{camera}: no file has the number {numbers}, between {first} and {last}. "
                "If these pulses were not recorded, their rows must be missing in the log too; "
                "otherwise copy the files again",
            )
