"""The cycle that an encoder log shows by itself, without the linkage."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array

# Range of an encoder on the crank; one on the rocker swings less than half a turn. [degree]
WHOLE_TURN = 300.0


@dataclass(frozen=True)
class Cycle:
    """Cycle as seen in the angles of an encoder log.

    Attributes
    ----------
    on_crank : bool
        Whether the angles go round, as on the crank; on the rocker they go to and fro.
    triggers : int | None
        Triggers in one cycle; None where the log ends before the first cycle is complete.
    count : float
        Number of cycles in the log.
    """

    on_crank: bool
    triggers: int | None
    count: float


def find_cycle(angle: Array) -> Cycle:
    """Find triggers per cycle and number of cycles from the angles of an encoder log.

    Parameters
    ----------
    angle : array, (frame,)
        Encoder angle. [degree]

    Returns
    -------
    Cycle

    Examples
    --------
    Twelve triggers a turn of the crank, three turns; the rocker swings 40 degrees:

    >>> turn = np.arange(36) * 30.0
    >>> find_cycle(turn % 360)
    Cycle(on_crank=True, triggers=12, count=3.0)
    >>> find_cycle(20 * np.sin(np.radians(turn)))
    Cycle(on_crank=False, triggers=12, count=3.0)
    """
    # an encoder on the crank may read on beyond 360 degrees, or start again at 0
    on_crank = bool(np.ptp(angle) > WHOLE_TURN)
    if on_crank:
        step = np.diff(angle) % 360.0
        turned = float(step.sum() + np.median(step)) if step.size else 0.0
        triggers = round(angle.size * 360.0 / turned) if turned >= 360.0 - 1e-6 else None
        return Cycle(True, triggers, round(turned / 360.0, 2))

    # A repeated cycle shows as the shift at which the log agrees best with itself. Half the
    # spacing of the triggers is the error at which two triggers would be confused.
    spacing = float(np.median(np.abs(np.diff(angle)))) if angle.size > 1 else 0.0
    for shift in range(2, angle.size // 2 + 1):
        if np.abs(angle[shift:] - angle[:-shift]).max() < 0.5 * spacing:
            return Cycle(False, shift, round(angle.size / shift, 2))

    # one cycle: the rocker has turned back, and has come near its first angle again
    turns = np.count_nonzero(np.diff(np.sign(np.diff(angle))))
    complete = turns >= 1 and abs(angle[-1] - angle[0]) <= 2 * np.abs(np.diff(angle)).max()
    return Cycle(False, int(angle.size) if complete else None, 1.0)
