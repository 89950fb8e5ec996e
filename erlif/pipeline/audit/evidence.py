"""Input of the audits: data of a run that are known once its frames are measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray, Array
from erlif.core.notes import Note
from erlif.io.ingest import Run
from erlif.pipeline.audit.energies import Order, compare_energies
from erlif.pipeline.audit.log import note_mounting
from erlif.pipeline.engines.results import FrameResult
from erlif.pipeline.recording.pulses import read_energies

MOST = 3000  # frames whose order is judged; more would only take time


@dataclass(frozen=True)
class Evidence:
    """A run whose frames are measured.

    Attributes
    ----------
    run : Run
    located : xarray.Dataset
        As `erlif.pipeline.physics.joint.locate_run` returns it.
    frames : Sequence[FrameResult]
        Frame pairs that were measured, in their order.
    faults : Sequence[Note]
        Of the counts of both cameras, known before.
    darks : Sequence[Note]
        About dark levels that are off, by pixels that no light reaches.
    """

    run: Run
    located: xr.Dataset
    frames: Sequence[FrameResult]
    faults: Sequence[Note] = ()
    darks: Sequence[Note] = ()

    @property
    def numbers(self) -> Array:
        """Numbers of the frame pairs, (frame,)."""
        return np.array([one.frame for one in self.frames], int)

    @cached_property
    def mounting(self) -> tuple[Note, ...]:
        """Warning that the encoder is on another link than stated; empty if it is not."""
        return tuple(note_mounting(self.run.log, self.run.settings))

    @cached_property
    def ratios(self) -> Array:
        """Logarithm of the ratio at places of each frame, (frame, place); NaN without film."""
        return np.array([one.pulse.log_ratio for one in self.frames], float)

    @cached_property
    def levels(self) -> Array:
        """Median of the log ratio over the places that most frames have, (frame,). [1]"""
        return median_by_frame(self.ratios)

    @cached_property
    def light(self) -> Array:
        """Pulse energy by the light of each frame, over the median, (frame,); NaN where unknown."""
        energy = np.array([one.pulse_energy for one in self.frames])
        return np.asarray(energy / np.nanmedian(energy)) if np.isfinite(energy).any() else energy

    @property
    def energies(self) -> Array | None:
        """Pulse energy of each of the frames in the log, (frame,); None where it has none."""
        energies = read_energies(self.run.log)
        return None if energies is None else energies[self.numbers]

    @cached_property
    def order(self) -> tuple[Order | None, AnyArray] | None:
        """Order of the rows and odd pairs, as `compare_energies`; None also without energies."""
        if self.energies is None:
            return None
        return compare_energies(self.energies[:MOST], self.light[:MOST], self.levels[:MOST])

    def logged(self, name: str) -> Array | None:
        """A column of the log or of the motion, of these frames, (frame,); None without it."""
        for source in (self.run.log, self.located):
            if name in source:
                return np.asarray(source[name].values[self.numbers], float)
        return None


def median_by_frame(values: Array) -> Array:
    """Median of each row over the columns that most rows have; NaN without any.

    Parameters
    ----------
    values : array, (frame, place)

    Returns
    -------
    array, (frame,)

    Examples
    --------
    >>> median_by_frame(np.array([[1.0, 2.0, np.nan], [3.0, 4.0, np.nan]]))
    array([1.5, 3.5])
    """
    known = np.isfinite(values)
    share = known.mean(axis=0)
    common = share > 0.9 * share.max(initial=0.0)
    found = np.full(len(values), np.nan)
    some = known[:, common].any(axis=1)
    found[some] = np.nanmedian(values[some][:, common], axis=1)
    return found
