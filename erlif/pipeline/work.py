"""A film to be made: what it is made from, its identity, and the file that it goes to."""

from __future__ import annotations

import json
import logging
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import xarray as xr

from erlif.calibration import RunCurve, record_calibration
from erlif.core.errors import OutputError
from erlif.core.format import identify
from erlif.core.timing import stage
from erlif.io.files import (
    PartialFilm,
    describe_hashes,
    has_identity,
    refuse_existing,
    write_film,
)
from erlif.io.ingest import (
    InputChangedError,
    Run,
    hash_files_beside_frames,
    hash_inputs,
    refuse_changed,
    sign_inputs,
    stamp_inputs,
)
from erlif.io.ingest.hashes import Digests
from erlif.io.settings import to_toml
from erlif.pipeline.engines.results import TriggerResult, frames_in, known_digests
from erlif.pipeline.engines.triggers import MAPS
from erlif.pipeline.plane import ObjectPlane
from erlif.pipeline.recording.pulses import PulseError

_logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class FilmWork:
    """A film to be made of a run with a calibration.

    Attributes
    ----------
    run : Run
    curve : RunCurve
    output : Path
        Where the film goes.
    stamps : Any
        Times of change of the inputs when they were opened.
    digests : Digests
        Hashes of all inputs but the frames.
    """

    run: Run
    curve: RunCurve
    output: Path
    stamps: Any
    digests: Digests

    @classmethod
    def of(cls, run: Run, curve: RunCurve, output: Path) -> FilmWork:
        """The work, with the state of its inputs now."""
        return cls(run, curve, output, stamp_inputs(run), hash_files_beside_frames(run))

    def identify(self, inputs: str) -> str:
        """Identity of the work by its inputs as text, its settings and the version of erlif."""
        skipped = json.dumps(sorted(self.run.pairs.skipped))
        made_with = record_calibration(self.curve)
        return identify(to_toml(self.run.settings), inputs, made_with, skipped)

    def is_done(self, *, overwrite: bool) -> bool:
        """Whether the output is the film that this work would make.

        Raises
        ------
        OutputError
            If it is another film, and is not to be replaced.
        """
        if not self.output.exists():
            return False

        # every frame is hashed: a film of other frames must not be taken for this one
        hashes = hash_inputs(self.run, self.digests)
        if has_identity(self.output, self.identify(describe_hashes(hashes))):
            return True
        if not overwrite:
            raise OutputError(
                f"{self.output} exists already, made from other inputs or settings or by another "
                "version; use --overwrite to make it again, or name another output."
            )

        # even then nothing is replaced that is not a product of erlif
        refuse_existing(self.output, overwrite=overwrite, holds="thickness")
        return False

    @contextmanager
    def unfinished(self, triggers: int) -> Iterator[PartialFilm]:
        """The unfinished film, resumed where the same work was interrupted.

        Nothing of it can be used where its frames are in disorder or change while they are read: it
        is then removed.
        """
        grid = ObjectPlane(self.run.settings, self.run.pairs.shape).grid(triggers)

        # the frames enter by name, size and time of change: hashing them first would read all twice
        key = self.identify(sign_inputs(self.run, self.digests))
        with PartialFilm(self.output, key, grid, MAPS) as unfinished:
            try:
                yield unfinished
            except (PulseError, InputChangedError):
                unfinished.discard()
                raise

    def hash_inputs(self, results: Sequence[TriggerResult]) -> dict[str, str]:
        """Hashes of all inputs, those of the frames as they were read.

        Raises
        ------
        InputChangedError
            If an input has changed since the run was opened.
        """
        # frames were hashed as they were read, so that the hash is that of the counts in the film
        read = known_digests(frames_in(results), self.run.pairs)
        hashes = hash_inputs(self.run, {**self.digests, **read})
        refuse_changed(self.run, self.stamps)
        return hashes

    def write(
        self,
        unfinished: PartialFilm,
        film: xr.Dataset,
        groups: dict[str, xr.Dataset],
        hashes: Mapping[str, str],
    ) -> None:
        """Write the film, and log the result in one line."""
        film.attrs["identity"] = self.identify(describe_hashes(hashes))
        with stage("writing", _logger):
            write_film(unfinished, film, groups)

        trend = "no speed exponent"
        if "speed_exponent" in film:
            power, std = float(film.speed_exponent), float(film.speed_exponent_std)
            trend = f"speed exponent {power:.3f} ± {std:.3f}"
        low, high = float(film.film_min.min()), float(film.film_min.max())
        _logger.info("minimum film thickness %.2f to %.2f um, %s", low, high, trend)
        if self.output.is_file():
            _logger.info("%s written, %.1f MB", self.output, self.output.stat().st_size / 1e6)
