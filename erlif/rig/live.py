"""A simulated run written in real time, as the cameras and the logger of a rig write it."""

from __future__ import annotations

import re
import shutil
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import numpy as np
import tifffile

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.core.progress import Progress, silent

Kind = Literal["camera1-stops", "camera2-stops", "camera1-loses", "camera2-loses", "laser-fades"]

# Form of a fault in text.
_FORM = re.compile(rf"({'|'.join(get_args(Kind))})@(\d{{1,6}})")

# Share of the light that each pulse of a fading laser has of the one before. [1]
_FADING = 0.97

# Time by which camera 2 writes later than camera 1, at most. [s]
_LATER = 0.005

# Column of the energy meter in the log.
_METER = "laser_mJ"

# Names of the folders of both cameras.
_CAMERAS = ("camera1", "camera2")


@dataclass(frozen=True)
class Fault:
    """A fault of the rig while it records.

    Attributes
    ----------
    kind : str
        A camera writes nothing from a frame on ("camera2-stops"), or not that frame
        ("camera1-loses"); the laser loses 3 % of its light with every pulse ("laser-fades").
    frame : int
        Frame, counted from 0, at which it begins.
    """

    kind: Kind
    frame: int

    @classmethod
    def read(cls, text: str) -> Fault:
        """Read a fault such as ``camera2-stops@40``.

        Raises ModelError for any other text.

        Examples
        --------
        >>> Fault.read("laser-fades@60")
        Fault(kind='laser-fades', frame=60)
        """
        found = _FORM.fullmatch(text)
        if not found:
            raise ModelError(
                "Expected a fault and its frame, such as camera2-stops@40, of the kinds "
                f"{', '.join(get_args(Kind))}; got {text!r}. Write it in this form."
            )
        return cls(found[1], int(found[2]))  # type: ignore[arg-type]

    def silences(self, camera: str, frame: int) -> bool:
        """Whether a camera does not write a frame."""
        if not self.kind.startswith(camera):
            return False
        return frame == self.frame if self.kind.endswith("loses") else frame >= self.frame


def write_live(
    run: Path,
    *,
    rate: float,
    gain: float,
    read_noise: float,
    faults: Sequence[Fault] = (),
    delay: float = 0.0,
    progress: Progress = silent,
) -> None:
    """Take the frames and the log of a simulated run away, and write them again in real time.

    Parameters
    ----------
    run : Path
        The directory ``run`` of a simulation, with frames of one image each.
    rate : float
        Pairs per second. [Hz]
    gain : float
        Of both cameras. [electron/DN]
    read_noise : float
        [electron]
    faults : sequence of Fault
    delay : float
        Time before the first pair. [s]
    progress : callable
        Called after each pair.
    """
    with tempfile.TemporaryDirectory(prefix=".simulate-", dir=run.parent) as folder:
        kept = Path(folder)
        for camera in _CAMERAS:
            shutil.move(run / camera, kept / camera)
            (run / camera).mkdir()
        log = run / "encoder.csv"
        head, *rows = log.read_text(encoding="utf-8").splitlines() if log.exists() else [""]
        if head:
            log.write_text(head + "\n", encoding="utf-8")

        names = sorted(path.name for path in (kept / _CAMERAS[0]).iterdir())
        dark = [_dark_level(run / f"{camera}_dark.tif") for camera in _CAMERAS]
        rng = np.random.default_rng(0)
        begun = time.monotonic() + delay
        for frame, name in enumerate(names):
            time.sleep(max(0.0, begun + frame / rate - time.monotonic()))
            energy = _energy(faults, frame)
            for n, camera in enumerate(_CAMERAS):
                if n:
                    time.sleep(min(_LATER, 0.1 / rate))
                if any(fault.silences(camera, frame) for fault in faults):
                    continue
                source, target = kept / camera / name, run / camera / name
                if energy == 1.0:
                    target.write_bytes(source.read_bytes())
                else:
                    light = tifffile.imread(source) - dark[n]
                    dimmed = dark[n] + dim_light(light, energy, gain, read_noise, rng)
                    tifffile.imwrite(target, np.rint(np.clip(dimmed, 0, None)).astype(np.uint16))
            if frame < len(rows):
                with log.open("a", encoding="utf-8") as file:
                    file.write(_with_energy(head, rows[frame], energy) + "\n")
            progress("live", frame + 1, len(names))


def _energy(faults: Sequence[Fault], frame: int) -> float:
    """Light of a pulse over that without faults. [1]"""
    passed = [frame - one.frame for one in faults if one.kind == "laser-fades"]
    return float(_FADING ** max([0, *passed]))


def _with_energy(head: str, row: str, energy: float) -> str:
    """A row of the log with what the energy meter shows of a weaker pulse."""
    names, values = head.split(","), row.split(",")
    if _METER not in names or energy == 1.0:
        return row
    place = names.index(_METER)
    values[place] = f"{energy * float(values[place]):.3f}"
    return ",".join(values)


def _dark_level(path: Path) -> float:
    """Mean count of the darks of a camera; 0 without any. [DN]"""
    return float(tifffile.imread(path).mean()) if path.exists() else 0.0


def dim_light(
    light: Array, energy: float, gain: float, read_noise: float, rng: np.random.Generator
) -> Array:
    """Light [DN] of a weaker pulse, a share `energy` of it, with the noise of as many electrons."""
    # counts that are multiplied have energy**2 of their variance
    shot = (energy - energy**2) * np.clip(light, 0, None) / gain
    read = (1 - energy**2) * (read_noise / gain) ** 2
    return np.asarray(energy * light + np.sqrt(shot + read) * rng.normal(size=light.shape))
