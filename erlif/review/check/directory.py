"""The audit of a run or fixture directory, part by part."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from erlif.calibration import read_profile
from erlif.core.errors import ConfigError, ErlifError
from erlif.core.notes import Level, Note, list_some, remark, retitle, warn
from erlif.core.progress import ShowProgress, choose_progress
from erlif.core.timing import stage
from erlif.core.version import __version__
from erlif.io.files import takes
from erlif.io.ingest import (
    Fixture,
    FramePairs,
    Run,
    format_notes,
    open_fixture,
    open_run,
    skipped_notes,
)
from erlif.io.ingest.numbering import find_missing, frame_numbers
from erlif.kinematics import encoder_notes
from erlif.pipeline.audit.audits import audit_run
from erlif.pipeline.audit.bits import note_bits
from erlif.pipeline.audit.evidence import Evidence
from erlif.pipeline.audit.log import Steps, note_conditions, note_energy, note_motion
from erlif.pipeline.cycle import describe_triggers, summarise_cycle
from erlif.pipeline.physics.clock import fit_start
from erlif.pipeline.physics.joint import locate_run
from erlif.pipeline.recording.cameras import characterise_cameras
from erlif.pipeline.recording.omissions import note_omissions
from erlif.review.check.calibration import note_calibration
from erlif.review.check.cameras import (
    RatioSurvey,
    note_pulses,
    note_registration,
    note_textures,
    survey_cameras,
)
from erlif.review.check.counts import (
    MOST_SPREAD,
    CountSurvey,
    find_copies,
    note_bad_pixels,
    note_copies,
    note_counts,
    note_light,
    survey_counts,
)

_logger = logging.getLogger(__name__)

# One part of the audit; it raises ErlifError where the input cannot be used.
Step = Callable[[], Iterator[Note]]


@dataclass
class Examination:
    """Findings about the directory of a run or a fixture.

    Attributes
    ----------
    directory : Path
        The run or the fixture.
    name : str
        Its name in the settings; empty where they cannot be read.
    notes : list[Note]
        Findings in the order of the audit. It ends with the first error of a part, because the
        later parts depend on the earlier ones.
    pairs : list[PairRow]
        The first, the last and all odd frame pairs.
    survey : CountSurvey | None
        Counts of the frames that were read; None where none could be read.
    darks : tuple[float, float]
        Dark level of camera 1 and camera 2. [DN]
    cameras : RatioSurvey | None
        Registration and ratio; None where the audit ended before.
    steps : Steps | None
        Angles and times of the log; None for a fixture.
    """

    directory: Path
    name: str = ""
    notes: list[Note] = field(default_factory=list)
    pairs: list[PairRow] = field(default_factory=list)
    survey: CountSurvey | None = None
    darks: tuple[float, float] = (0.0, 0.0)
    cameras: RatioSurvey | None = None
    steps: Steps | None = None

    def count(self, level: Level) -> int:
        """Number of findings of a level."""
        return sum(note.level is level for note in self.notes)

    def to_record(self) -> dict[str, Any]:
        """Findings, pairing table and series as plain values, for JSON."""
        frames = [] if self.survey is None else self.survey.frames
        return {
            "erlif_version": __version__,
            "directory": str(self.directory),
            "name": self.name,
            "errors": self.count(Level.ERROR),
            "warnings": self.count(Level.WARNING),
            "notes": [asdict(note) for note in self.notes],
            "pairs": [asdict(row) for row in self.pairs],
            "frames": [asdict(one) for one in frames],
        }


@takes(directory="directory")
def check(
    directory: str | Path,
    *,
    skip_bad_frames: bool = False,
    allow_outside: bool = False,
    progress: ShowProgress = None,
) -> list[Note]:
    """Check everything in a run or fixture directory that can be checked without computing a film.

    Parameters
    ----------
    directory, skip_bad_frames, allow_outside, progress
        As for `erlif.review.check.examine`.

    Returns
    -------
    list of Note
        Findings in the order of the audit.

    Examples
    --------
    >>> for note in check("an empty folder"):
    ...     print(note.level, note.subject)
    error settings and files
    """
    return examine(
        directory,
        skip_bad_frames=skip_bad_frames,
        allow_outside=allow_outside,
        progress=progress,
    ).notes


@takes(directory="directory")
def examine(
    directory: str | Path,
    *,
    fixture: bool = False,
    skip_bad_frames: bool = False,
    allow_outside: bool = False,
    progress: ShowProgress = None,
) -> Examination:
    """Examine a run or fixture directory before anything is computed.

    At most 24 frame pairs of a long recording are read, evenly spread, and 16 consecutive ones.

    Parameters
    ----------
    directory : path
        With ``run.toml`` or ``fixture.toml``.
    fixture : bool
        Examine the fixture where the directory has both.
    skip_bad_frames : bool
        As for `erlif.process`.
    allow_outside : bool
        Follow links and names of files that leave the directory.
    progress : "bar", bool or callable, optional
        As for `erlif.process`.

    Returns
    -------
    Examination

    Examples
    --------
    >>> examine("an empty folder").count(Level.ERROR)
    1
    """
    progress = choose_progress(progress)
    result = Examination(Path(directory))
    subject = "settings and files"
    try:
        recording = _open_recording(
            result.directory,
            fixture=fixture,
            skip_bad_frames=skip_bad_frames,
            allow_outside=allow_outside,
        )
        result.name = recording.settings.name
        result.notes.append(_note_frames(recording))
        # pairs are listed even where a later part fails
        result.pairs = tabulate_pairs(recording)
        parts = _Parts(recording, result, allow_outside).list()
        for done, (name, step) in enumerate(parts, 1):
            subject = name
            with stage(f"check of {name}", _logger):
                for note in step():
                    result.notes.append(note)
                    if note.level is Level.ERROR:
                        return result
            progress("check", done, len(parts))
    except ErlifError as error:
        result.notes.append(Note(Level.ERROR, subject, str(error)))
    return result


def _open_recording(directory: Path, *, fixture: bool, **options: bool) -> Run | Fixture:
    """The run or the fixture in the directory."""
    has_run, has_fixture = ((directory / f"{name}.toml").is_file() for name in ("run", "fixture"))
    if has_fixture and (fixture or not has_run):
        return open_fixture(directory, **options)
    if has_run:
        return open_run(directory, find_start=fit_start, **options)
    reason = "there is no such directory. Correct the name."
    if directory.is_dir():
        reason = f"it holds neither. Make one from the files in it with: erlif init {directory}"
    raise ConfigError(
        f"Expected a run (run.toml) or a fixture (fixture.toml) in {directory}; {reason}"
    )


def _note_frames(recording: Run | Fixture) -> Note:
    height, width = recording.pairs.shape
    count, name = len(recording.pairs.usable), recording.settings.name
    some = f"; counts of {MOST_SPREAD} of them, evenly spread, are examined"
    examined = some if count > MOST_SPREAD else ""
    return remark("frames", f"{count} pairs of {width} x {height} pixels, {name!r}{examined}")


@dataclass
class _Parts:
    """Parts of an audit in their order; later parts use the results of earlier ones."""

    recording: Run | Fixture
    found: Examination
    allow_outside: bool
    survey: CountSurvey = field(init=False)
    cameras: RatioSurvey = field(init=False)

    def list(self) -> list[tuple[str, Step]]:
        """Subject and function of each part."""
        steps: list[tuple[str, Step]] = [
            ("counts", self.counts),
            ("pairs", self.pairing),
            ("darks and flats", self.references),
            ("registration", self.registration),
            ("pulses", self.pulses),
        ]
        if isinstance(self.recording, Fixture):
            fixture = self.recording
            return [*steps, ("profile", lambda: _note_profile(fixture))]
        run = self.recording
        return [
            *steps,
            ("encoder log", lambda: self.log(run)),
            ("calibration", lambda: self.calibration(run)),
        ]

    def counts(self) -> Iterator[Note]:
        """Formats, highest counts, saturation and bits."""
        pairs = self.recording.pairs
        yield from format_notes(pairs)
        self.found.survey = self.survey = survey_counts(pairs, pairs.spread(MOST_SPREAD))
        yield from note_counts(self.survey, pairs)
        yield from note_bits(self.survey.histograms)

    def pairing(self) -> Iterator[Note]:
        """Report the pairing of the files, and images that are copies."""
        yield from skipped_notes(self.recording.pairs)
        yield from note_numbers(self.recording.pairs)
        odd = {frame for frames in find_copies(self.survey) for frame in frames}
        self.found.pairs = tabulate_pairs(self.recording, odd=odd)
        for row in self.found.pairs:
            yield remark("pairs", f"{row}")
        yield from note_copies(self.survey)

    def references(self) -> Iterator[Note]:
        """Dark level, noise and gain, and the light above the dark level."""
        known = characterise_cameras(self.recording)
        references = known.cameras.references
        yield from retitle("darks and flats", (*known.cameras.notes, *known.faults))
        yield from note_bad_pixels(references)
        one, two = (float(level) for level in references.dark_signal.values)
        self.found.darks = one, two
        yield from note_light(self.survey, self.found.darks)

    def registration(self) -> Iterator[Note]:
        """Map, overlap and drift."""
        self.found.cameras = self.cameras = survey_cameras(self.recording)
        yield from note_registration(self.cameras)
        yield from note_textures(self.cameras)

    def pulses(self) -> Iterator[Note]:
        """Check that both cameras show the same pulses."""
        counted = [one.frame for one in self.survey.frames]
        yield from note_pulses(self.cameras, self.recording.pairs, counted=counted)

    def log(self, run: Run) -> Iterator[Note]:
        """Report triggers, cycles, steps, conditions, order, and omissions from the film."""
        self.found.steps = Steps.of(run.log)
        yield from run.log_notes
        located = locate_run(run)
        yield from encoder_notes(located)
        triggers = describe_triggers(run, located)
        encoder = run.settings.encoder
        logged = encoder is not None and encoder.file is not None
        subject = "encoder log" if logged else "no encoder log"
        yield remark(subject, summarise_cycle(located))
        yield from note_motion(run.log, located, run.settings)
        yield from note_conditions(run.log, run.settings)
        numbers = [one.frame for one in self.cameras.frames]
        yield from note_energy(run.log, numbers, self.cameras.light)
        found = audit_run(Evidence(run, located, self.cameras.frames))
        yield from (note for note in found if note not in self.found.notes)
        yield from note_omissions(run.settings, triggers)

    def calibration(self, run: Run) -> Iterator[Note]:
        """Check that the calibration exists, fits, and is as new as its fixture."""
        yield from note_calibration(run, self.cameras, allow_outside=self.allow_outside)


def _note_profile(fixture: Fixture) -> Iterator[Note]:
    """Number of points and range of the measured profile."""
    profile = read_profile(fixture.directory / fixture.settings.fixture.profile)
    yield from retitle("profile", profile.notes)
    low, high = profile.thickness.min(), profile.thickness.max()
    yield remark("profile", f"{profile.thickness.size} points from {low:.2f} to {high:.2f} um")


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


def tabulate_pairs(recording: Run | Fixture, *, odd: Iterable[int] = ()) -> list[PairRow]:
    """The first, the last and all odd pairs.

    Parameters
    ----------
    recording : Run or Fixture
    odd : iterable of int
        Numbers of further pairs.

    Returns
    -------
    list of PairRow
    """
    # both ends show whether the recording was cut
    count = len(recording.pairs.pages[0])
    ends = [*range(min(_FIRST, count)), *range(max(count - _LAST, 0), count)]
    chosen = sorted({*ends, *sorted(odd)[: _LISTED - len(ends)]})
    return [_pair_row(recording, k) for k in chosen]


def _pair_row(recording: Run | Fixture, k: int) -> PairRow:
    one, two = (pages[k].name for pages in recording.pairs.pages)
    row = PairRow(k, one, two)
    if not isinstance(recording, Run):
        return row
    log, encoder = recording.log, recording.settings.encoder
    row = replace(row, time=float(log["time"][k]) if "time" in log else None)
    if encoder is None or encoder.file is None:
        return row
    angle = float(log.angle[k]) if "angle" in log else None
    return replace(row, row=int(log.number[k]), angle=angle)


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
