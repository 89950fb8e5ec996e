"""Make the six endurance tests of data_samples/endurance: python data_samples/make_endurance.py

The schedule, the friction and the failures of the uncut bearings are like those of Farzaneh (2002),
chapter 4; those of the undercut ones are invented beyond its single run.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from erlif.joint.rig import EnduranceRig, simulate_endurance, write_endurance_log

FOLDER = Path(__file__).parent / "endurance"

LBF = 4.4482216152605

TESTS = {
    "uncut_1": (6, 540.0, 0.15, 0.12),
    "uncut_2": (6, 60.0, 0.15, 0.13),
    "uncut_3": (5, 320.0, 0.15, 0.13),
    "undercut_1": (7, 410.0, 0.10, 0.10),
    "undercut_2": (8, 180.0, 0.10, 0.10),
    "undercut_3": (None, 0.0, 0.10, 0.0),
}
"""Stage of failure, time into it [s], friction before and its rise."""

NAMES = {"arm": "Third cell [N]", "temperature": "Pin temperature [degC]"}


def main() -> None:
    """Write the logs."""
    FOLDER.mkdir(exist_ok=True)
    for number, (name, (stage, time, friction, rise)) in enumerate(TESTS.items()):
        rig = EnduranceRig(
            loads=tuple(1000 * kips * LBF for kips in range(8, 37, 4)),
            interval=6.0,
            galling_stage=stage,
            galling_time=time,
            friction=friction,
            rise=rise,
            noise=0.004,
            stop_after=60.0,
        )
        log, _ = simulate_endurance(rig, rng=np.random.default_rng([number, 4]))
        write_endurance_log(log, FOLDER / f"{name}.csv", names=NAMES)


if __name__ == "__main__":
    main()
