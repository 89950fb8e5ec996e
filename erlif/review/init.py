"""A first run.toml or fixture.toml from the files in a directory."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from erlif.calibration import open_calibration, read_profile
from erlif.core.arrays import Array
from erlif.core.errors import ConfigError, ErlifError, FrameError, OutputError
from erlif.core.notes import Note, list_some, remark, warn
from erlif.core.products import EncoderLog
from erlif.core.units import count_of
from erlif.io.files import takes, write_file
from erlif.io.ingest import read_encoder_log
from erlif.io.ingest.depth import CountsSample
from erlif.io.ingest.logs.checks import is_nearly_by_frame
from erlif.io.ingest.logs.columns import CONTRACT, ColumnChoice, find_columns
from erlif.io.ingest.logs.proposal import LogProposal, propose_log
from erlif.io.ingest.logs.text import read_log_table
from erlif.io.ingest.survey import CameraSurvey, Survey, TextTable, survey_directory
from erlif.io.readers.registry import why_unread
from erlif.io.settings import (
    GAP,
    FixtureSettings,
    RunSettings,
    Settings,
    json_schema,
    read_fixture_settings,
    write_template,
)
from erlif.io.settings.toml import toml_value
from erlif.pipeline.audit.log import signed_steps
from erlif.pipeline.recording.log_cycle import WHOLE_TURN, Cycle, find_cycle
from erlif.pipeline.recording.pulses import ENERGY_COLUMNS
from erlif.review.earlier import EarlierSettings, read_earlier

# Calibrations beside a run that are listed.
MOST_CALIBRATIONS = 5

_LISTED = 3  # files that a note names

_REPEATS = 0.1  # of the step from frame to frame by which angles of one trigger may differ


# Tribometers for which run.toml is written; a static film has no mechanism.
KINDS = ("crank-rocker", "slider-crank", "rotation", "sinusoidal", "static")

_LINKAGES = KINDS[:2]  # those that have a joint, and an encoder that they cannot do without


@dataclass
class _Draft:
    """A settings file in the making: values, remarks on them, and notes for the user."""

    values: dict[str, Any] = field(default_factory=dict)
    remarks: dict[str, str] = field(default_factory=dict)
    notes: list[Note] = field(default_factory=list)
    leave_out: list[str] = field(default_factory=list)

    def set(self, key: str, value: Any, remark: str = "") -> None:
        """Set a key to a value or to `GAP`; the remark names the source of the value."""
        self.values[key] = value
        if remark:
            self.remarks[key] = remark

    def note(self, subject: str, text: str) -> None:
        """Add what was found."""
        self.notes.append(remark(subject, text))

    def warn(self, subject: str, text: str) -> None:
        """Add what the user has to look at."""
        self.notes.append(warn(subject, text))


@takes(directory="directory")
def init(
    directory: str | Path,
    *,
    fixture: bool = False,
    kind: str = "crank-rocker",
    overwrite: bool = False,
    full: bool = False,
    like: str | Path | None = None,
) -> list[Note]:
    """Write a commented settings file for the frames and logs in a directory.

    What the files determine is filled in: names, patterns, bit depth, triggers per cycle. Every
    other required value is a gap, ``"??"``, with its unit and its meaning; `erlif.check` lists the
    gaps that are left. A JSON schema for editors is written beside the file.

    Parameters
    ----------
    directory : path
        Folder with the files of both cameras and the encoder log or the profile.
    fixture : bool
        Write ``fixture.toml`` for a calibration fixture; default: ``run.toml`` for a run.
    kind : str
        Tribometer of the run: "crank-rocker", "slider-crank", "rotation" (pin on disc),
        "sinusoidal" (slider), or "static". Gaps are written for what it needs alone.
    overwrite : bool
        Replace an existing settings file.
    full : bool
        Write every optional key with its meaning, as a comment.
    like : path, optional
        Directory of an earlier run, or fixture, of the rig. What the rig keeps is taken from its
        settings, the kind of tribometer too; what belongs to a run is left to be stated anew.

    Returns
    -------
    list of Note
        What was found, and what the user has to look at.

    Raises
    ------
    ConfigError
        If there is no such kind, or the settings of `like` cannot be read.
    FrameError
        If there is no such directory, or no image in it.
    OutputError
        If the settings file exists and `overwrite` is not set, or cannot be written.

    Examples
    --------
    >>> import tempfile, tifffile, numpy as np
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     for name in ("C1_0001.tif", "C1_0002.tif", "C2_0001.tif", "C2_0002.tif"):
    ...         tifffile.imwrite(Path(folder, name), np.full((64, 80), 900, np.uint16))
    ...     notes = init(folder)
    ...     print(notes[0])
    camera1: 2 frames of 80 x 64 uint16, C1_*.tif
    """
    if kind not in KINDS:
        raise ConfigError(f"Expected a tribometer of {', '.join(KINDS)}; got {kind!r}. Choose one.")
    directory = Path(directory)
    settings: type[Settings] = FixtureSettings if fixture else RunSettings
    name = "fixture.toml" if fixture else "run.toml"
    output = directory / name
    if output.exists() and not overwrite:
        raise OutputError(f"{output} exists already; use --overwrite to replace it.")

    earlier = None if like is None else read_earlier(Path(like), fixture=fixture)
    if earlier is not None:
        kind = earlier.kind

    survey = survey_directory(directory, fixture=fixture)
    if not survey.cameras:
        _refuse_empty(survey)

    draft = _Draft()
    _draft_cameras(draft, survey)
    draft.set("optics.x_axis", "sliding", "Check the direction: the files do not show it.")
    if fixture:
        _draft_profile(draft, survey)
    else:
        _note_fixtures(draft, survey)
        _draft_motion(draft, survey, kind)
        _draft_calibration(draft, survey)

    # erlif simulate and many laboratories name the folder of a recording run or fixture
    place = directory.resolve()
    called = place.parent if place.name in ("run", "fixture") else place
    title = " ".join(called.name.replace("_", " ").split())
    draft.values["fixture.name" if fixture else "run.name"] = title
    if earlier is not None:
        _take_over(draft, earlier, str(like))

    # gaps are written for what this tribometer needs alone
    text = write_template(
        settings,
        draft.values,
        draft.remarks,
        forms={"mechanism": kind},
        leave_out=draft.leave_out,
        full=full,
    )
    write_file(output, text)
    schema = output.with_suffix(".schema.json")
    write_file(schema, json.dumps(json_schema(settings), indent=2, ensure_ascii=False) + "\n")
    return draft.notes


def _note_fixtures(draft: _Draft, survey: Survey) -> None:
    """Name recordings and folders of fixtures, which are no frames of the run."""
    directory = survey.directory
    recordings = [one for camera in survey.cameras[:2] for one in camera.recordings]
    of_fixture = [one.pattern for one in recordings if one.of_fixture]
    found = [(", ".join(map(str, of_fixture)), directory)] if of_fixture else []
    found += [(folder.relative_to(directory).as_posix(), folder) for folder in survey.left_out]
    for names, folder in found:
        draft.note(
            "fixture",
            f"{names} holds a fixture and has no camera of the run"
            if folder != directory and (folder / "fixture.toml").is_file()
            else f"{names} is of a fixture: erlif init --fixture {folder} writes fixture.toml, "
            "erlif calibrate its calibration",
        )


def _refuse_empty(survey: Survey) -> None:
    """Refuse a directory without frames; formats that are known and not read are named."""
    if survey.unread:
        first, count = survey.unread[0], count_of(len(survey.unread), "image")
        reason = why_unread(first.suffix)
        raise FrameError(
            f"Expected frames of two cameras in {survey.directory}; the {count} in it cannot be "
            f"read. {first.name}: {reason}"
        )
    raise FrameError(
        f"Expected frames of two cameras in {survey.directory}; there is no image file in it. Put "
        "the frames there, for example as camera1/*.tif and camera2/*.tif."
    )


# an earlier run of the rig


def _take_over(draft: _Draft, earlier: EarlierSettings, source: str) -> None:
    """Take what the rig keeps; `source` is the directory of the earlier run."""
    for place, value in earlier.of_run.items():
        draft.set(place, GAP, f"{toml_value(value)} in {source}.")
    for place, value in earlier.kept.items():
        draft.set(place, value)
        draft.remarks.pop(place, None)

    if "oil.vogel" in earlier.kept:
        draft.values.pop("oil.viscosity", None)  # one of the two is given
    if "oil" in earlier.tables:
        draft.remarks["oil"] = f"That of {source}; of another oil all values differ."
    draft.leave_out = [name for name in draft.leave_out if name not in earlier.tables]
    taken = count_of(len(earlier.kept), "value")
    draft.note(source, f"{taken} taken; correct what has changed on the rig since")


# cameras


def _draft_cameras(draft: _Draft, survey: Survey) -> None:
    """Files, band, depth, darks and flats of both cameras, and whether the two fit together."""
    cameras = survey.cameras
    for number, camera in enumerate(cameras[:2], 1):
        _draft_camera(draft, survey, number, camera)

    if len(cameras) == 1:
        draft.set("camera2.offset", GAP)
        draft.warn(
            "camera2",
            f"frames of one camera only were found ({cameras[0].label}); camera 2 is a gap. Where "
            "the files hold both cameras, give both tables the same files and their part",
        )
    elif len(cameras) > 2:
        labels = ", ".join(camera.label for camera in cameras)
        draft.warn(
            "cameras",
            f"{len(cameras)} groups of frames were found ({labels}); the first two were taken as "
            "camera 1 and camera 2: correct files in both tables",
        )
    else:
        _compare_cameras(draft, *cameras)

    if survey.unassigned:
        names = [os.path.relpath(path, survey.directory) for path in survey.unassigned]
        draft.warn(
            "files",
            f"these images belong to no camera by their names: {list_some(names, most=_LISTED)}",
        )
    if survey.masks:
        names = [path.relative_to(survey.directory).as_posix() for path in survey.masks]
        draft.set("thickness.exclude", names, "Masks by their names: white is excluded.")
        draft.note("masks", f"{list_some(names, most=_LISTED)}: what is white there is excluded")


def _draft_camera(draft: _Draft, survey: Survey, number: int, camera: CameraSurvey) -> None:
    """Table of one camera."""
    table, frames = f"camera{number}", camera.frames
    kind = _first(frames.kinds)
    pattern = frames.pattern or camera.label
    if camera.chosen:
        draft.set(f"{table}.files", frames.pattern, f"{frames.pages} frames of {kind}.")
        draft.note(table, f"{frames.pages} frames of {kind}, {pattern}")
    if camera.recordings:
        _draft_recordings(draft, table, camera)
    if frames.pattern is None:
        draft.warn(
            table,
            "no single pattern matches these frames and no other file; put them into one folder",
        )
    if len(frames.kinds) > 1:
        draft.warn(table, f"the frames differ in size or type: {', '.join(frames.kinds)}")
    for fault in frames.faults[:1]:
        more = f" ({len(frames.faults) - 1} more)" if len(frames.faults) > 1 else ""
        draft.warn(table, f"{fault}{more}; --skip-bad-frames leaves out unreadable frame pairs")

    _draft_share(draft, table, number, camera)
    if camera.wavelength is not None:
        draft.set(f"{table}.band", f"{camera.wavelength} nm", "From the names of the files.")
    if camera.counts is not None:
        _draft_depth(draft, table, camera.counts)
    others = ("dark", camera.darks), ("flat", camera.flats), ("background", camera.backgrounds)
    for key, images in others:
        if images is None:
            continue
        count = count_of(images.pages, f"{key} image")
        draft.set(f"{table}.{key}", images.pattern, f"{count}.")
        draft.note(table, f"{count}, {images.pattern}")
        if f"{key}s" in survey.in_order:
            draft.warn(
                table,
                f"the {key} files name no camera and are taken in the order of their names: check "
                "them",
            )
        if images.pattern is None:
            draft.warn(table, f"no single pattern matches the {key} files; put them into one file")
    if camera.darks is None:
        _ask_for_darks(draft, survey, table)


def _draft_recordings(draft: _Draft, table: str, camera: CameraSurvey) -> None:
    """Draft the choice among several recordings of a camera, or a gap that lists them."""
    names = list_some(f"{one.pattern} ({one.pages})" for one in camera.recordings)
    count = f"{len(camera.recordings)} recordings"
    if camera.chosen:
        draft.note(table, f"{camera.frames.pattern} of {count} was taken by its name: {names}")
    else:
        draft.set(f"{table}.files", GAP, f"One of {names}.")
        draft.warn(table, f"{count} look like frames: {names}; choose one as files")


def _ask_for_darks(draft: _Draft, survey: Survey, table: str) -> None:
    """Leave a gap for the dark level, and name darks that belong to neither camera."""
    lone = list_some(
        [os.path.relpath(path, survey.directory) for path in survey.lone_darks], most=_LISTED
    )
    if lone:
        draft.set(f"{table}.offset", GAP, f'Write dark = "..." in place of this line: {lone}.')
        draft.warn(
            table,
            f"no dark frames were found by the name of the camera; there are {lone}: in "
            f'[{table}], write dark = "..." in place of offset',
        )
        return
    draft.set(f"{table}.offset", GAP, 'No dark frames were found; dark = "file.tif" is better.')
    draft.warn(table, "no dark frames were found: give offset, or photograph darks")


def _draft_share(draft: _Draft, table: str, number: int, camera: CameraSurvey) -> None:
    """Draft the part or the datasets of a camera in a file of both cameras."""
    shared = camera.shared
    if shared is None:
        return
    value = shared.values[number - 1]
    draft.set(f"{table}.{shared.key}", value, f"Check it: {shared.reason}.")
    draft.note(table, f'{shared.key} = "{value}": {shared.reason}')
    for key, names in (("dark_dataset", shared.darks), ("flat_dataset", shared.flats)):
        if names is not None:
            draft.set(f"{table}.{key}", names[number - 1])


def _draft_depth(draft: _Draft, table: str, counts: CountsSample) -> None:
    """Bit depth from the largest counts; counts that are stored left-aligned are reported."""
    seen = f"largest count {counts.highest} in {counts.pages} images"
    factor = 1 << counts.unused_bits

    # counts that fill 16 bits from above; others may lie anywhere in them
    depth = counts.bit_depth
    if counts.unused_bits and depth + counts.unused_bits >= 16:
        depth, remark = 16 - counts.unused_bits, f"{seen}, all multiples of {factor}"
        draft.set(f"{table}.alignment", "left", f"{remark[0].upper()}{remark[1:]}.")
        remark = f"{remark}: left-aligned."
    elif counts.unused_bits:
        draft.warn(
            table,
            f"{seen}, all multiples of {factor}: {depth}-bit counts, left-aligned. Divide the "
            f"counts by {factor} and save the images again",
        )
        remark = f"{seen}, left-aligned by {factor}."
    elif counts.stated:
        remark = f"After the headers; {seen}."
    elif counts.full_scale_seen:
        remark = f"Full scale is reached: {seen}."
    else:
        remark = f"{seen[0].upper()}{seen[1:]}; the smallest usual depth that holds it."
    draft.set(f"{table}.bit_depth", depth, remark)


def _compare_cameras(draft: _Draft, one: CameraSurvey, two: CameraSurvey) -> None:
    """Report what keeps the frames of the two cameras from being paired."""
    if one.frames.pages != two.frames.pages:
        draft.warn(
            "cameras",
            f"camera1 has {one.frames.pages} frames, camera2 has {two.frames.pages}: frame k of "
            "both must show the same laser pulse",
        )
    if one.frames.kinds[:1] != two.frames.kinds[:1]:
        draft.warn(
            "cameras",
            f"camera1 has frames of {_first(one.frames.kinds)}, camera2 of "
            f"{_first(two.frames.kinds)}: set the same region of interest for both",
        )
    if one.wavelength is None:
        draft.warn(
            "cameras",
            f"taken as camera1: {_describe(one)}, as camera2: {_describe(two)}. Camera 1 must be "
            "the one with the shorter wavelength",
        )


def _describe(camera: CameraSurvey) -> str:
    return camera.label if camera.shared else camera.frames.pattern or camera.label


def _first(kinds: tuple[str, ...]) -> str:
    return kinds[0] if kinds else "unreadable images"


# encoder log


def _draft_motion(draft: _Draft, survey: Survey, kind: str) -> None:
    """Draft log and mechanism, and for a linkage joint and oil."""
    draft.remarks["mechanism"] = (
        f"Other tribometers: erlif init --overwrite --kind {', '.join(KINDS[1:-1])} or static. "
        "The film theory of a ball, barrel or roller needs [contact] and [oil]."
    )
    draft.leave_out.append("contact")
    if kind in _LINKAGES:
        _draft_log(draft, survey, kind)
        draft.set("oil.viscosity", GAP, "Remove this line where a vogel law is given below.")
        return

    # a pin in a bushing is no part of another tribometer
    draft.leave_out += ["joint", "oil", "prediction"]
    if kind == "static":
        draft.leave_out.append("mechanism")
    logged = _draft_log(draft, survey, kind)
    if kind == "rotation" and not {"angle", "time"} <= logged and "speed" not in logged:
        draft.set("mechanism.speed", GAP, "No log has columns of angle and time.")
    if kind == "sinusoidal" and "angle" not in logged:
        reason = "No log has a column of the angle; the position follows from time and zero."
        draft.set("encoder.zero", GAP, reason)
    if kind != "static" and "load" not in logged:
        draft.remarks["mechanism.load"] = "No log has a column of the load."


def _draft_log(draft: _Draft, survey: Survey, kind: str) -> set[str]:
    """Draft the log, its columns, and the cycle its angles show; return the quantities it holds."""
    linkage = kind in _LINKAGES
    needed = ("frame", "angle_deg") if linkage else ("frame",)
    table = _find_table(survey, needed)
    values, in_time = xr.Dataset(), False
    if table is not None:
        log = _read_own_log(draft, survey, table, needs_angle=linkage)
        values = values if log is None else log
        names = set(map(str, values))
        # a speed of sliding and one of rotation serve alike
        names |= {"speed"} if {"sliding_speed", "rotation_speed"} & names else set()
        lacking = "" if "load_N" in table.header else "load_N"
    else:
        frames = survey.cameras[0].frames.pages
        proposal = propose_log(survey.logs, frames, unnamed=kind != "static")
        if proposal is None:
            _report_missing_table(draft, survey, "encoder log", ", ".join(needed), needed=linkage)
            if linkage:
                draft.set("encoder.file", GAP)
            else:
                draft.leave_out.append("encoder")
            return set()
        _draft_proposal(draft, survey, proposal)
        if kind != "static":
            _ask_for_columns(draft, proposal)
        values, in_time = proposal.values, proposal.in_time
        names = {*proposal.columns, *map(str, values)}
        lacking = "" if "load" in proposal.columns else "of the load"

    if not linkage:
        if not in_time:
            _draft_repeats(draft, values)
        return names
    if lacking:
        draft.set("joint.load", GAP, f"The encoder log has no column {lacking}.")
    if "angle" in values:
        angle = np.asarray(values["angle"].values)
        if in_time:
            _draft_mount(draft, float(np.ptp(np.unwrap(angle, period=360.0))) > WHOLE_TURN)
        else:
            time = values["time"].values if "time" in values else None
            _draft_cycle(draft, find_cycle(angle), time)
    return names


def _read_own_log(
    draft: _Draft, survey: Survey, table: TextTable, *, needs_angle: bool
) -> EncoderLog | None:
    """Read a log with the column names of erlif, and compare its rows with the frames."""
    draft.set("encoder.file", os.path.relpath(table.path, survey.directory))
    draft.note("encoder log", f"{table.path.name}, {table.rows} rows: {', '.join(table.header)}")
    pages = {camera.frames.pages for camera in survey.cameras[:2]}
    if pages != {table.rows}:
        counts = " and ".join(str(count) for count in sorted(pages))
        draft.warn("encoder log", f"{table.rows} rows for {counts} frames: one row per frame pair")
    try:
        log = read_encoder_log(table.path, needs_angle=needs_angle)
        read = read_log_table(table.path, ())
        _note_unused(
            draft, read.names, [one.name for one in find_columns(read, ColumnChoice())[0].values()]
        )
        return log
    except ErlifError as error:
        draft.warn("encoder log", f"{error}")
        return None


def _draft_proposal(draft: _Draft, survey: Survey, proposal: LogProposal) -> None:
    """Columns of the log by their names, and how its frames lie in time."""
    frames = survey.cameras[0].frames.pages
    rows, names = len(proposal.table.rows), [name for name in proposal.table.names if name]
    listed = "; ".join(proposal.table.remarks)
    draft.set("encoder.file", os.path.relpath(proposal.path, survey.directory), listed)
    draft.note("encoder log", f"{proposal.path.name}, {rows} rows: {', '.join(names)}")
    for quantity, name in proposal.columns.items():
        mark = "unit" if quantity in proposal.by_unit else "name"
        draft.set(f"encoder.{quantity}", name, f"By its {mark}; check that it is this quantity.")
    if proposal.by_unit:
        chosen = (f"{one} from {proposal.columns[one]!r}" for one in proposal.by_unit)
        draft.warn(
            "encoder log",
            f"chosen by the unit alone: {', '.join(chosen)}. Check that these columns hold these "
            "quantities",
        )
    for quantity in proposal.without_unit:
        draft.warn(
            "encoder log",
            f"column {proposal.columns[quantity]!r} has no unit that is known: add it under units "
            f'in [encoder], units = {{ {quantity} = "..." }}',
        )
    used = [*proposal.columns.values(), *CONTRACT, *([proposal.pulse] if proposal.pulse else [])]
    if "angle" in proposal.known:  # else the columns are listed to choose from
        _note_unused(draft, names, used)
    if not proposal.in_time:
        return
    if proposal.pulse is not None:
        draft.set("encoder.pulse", proposal.pulse, "By its name: it must rise at each frame.")
    elif is_nearly_by_frame(rows, frames):
        draft.warn("encoder log", f"{rows} rows for {frames} frames: one row per frame pair")
    else:
        draft.warn(
            "encoder log",
            f"{rows} rows for {frames} frames, a log in time: give the times of the frames as "
            'pulse, or as frame_rate and start ("fit" finds it) in [encoder]',
        )


def _note_unused(draft: _Draft, names: Iterable[str], used: Iterable[str]) -> None:
    """Name the columns of the log that serve nothing."""
    known = {"", *used, *ENERGY_COLUMNS}
    unused = [name for name in names if name not in known]
    if unused:
        draft.note("encoder log", f"not used: {', '.join(repr(name) for name in unused)}")


def _ask_for_columns(draft: _Draft, proposal: LogProposal) -> None:
    """Leave gaps for needed columns that no name in the log identifies."""
    needed = ["angle", "time"] if proposal.in_time else ["angle"]
    missing = [quantity for quantity in needed if quantity not in proposal.known]
    if not missing:
        return
    names = ", ".join(repr(name) for name in proposal.table.names if name)
    for quantity in missing:
        draft.set(f"encoder.{quantity}", GAP, f"One of the columns {names}.")
    unknown = " or ".join(missing)
    draft.warn(
        "encoder log",
        f"no column of {proposal.path.name} is known by its name as {unknown}: choose from {names}",
    )


def _draft_cycle(draft: _Draft, cycle: Cycle, time: Array | None) -> None:
    """Draft the mounting of the encoder, triggers per cycle, and the crank speed."""
    _draft_mount(draft, cycle.on_crank)
    if cycle.triggers is None:
        draft.warn("encoder log", "the angles do not show a complete cycle")
        return
    _draft_triggers(draft, cycle.triggers, cycle.count)

    # the time of a cycle is known where the log holds the beginning of the next one
    if time is not None and time.size > cycle.triggers:
        periods = time[cycle.triggers :] - time[: -cycle.triggers]
        period = float(np.median(periods))
        if math.isfinite(period) and period > 0:
            draft.remarks["mechanism.crank_speed"] = (
                f"The times of the log give {60 / period:.4g} rpm."
            )


def _draft_repeats(draft: _Draft, log: xr.Dataset) -> None:
    """Draft the triggers per cycle of a motion without linkage, if the angles repeat."""
    angle = np.asarray(log["angle"].values) if "angle" in log else np.empty(0)
    if angle.size < 2:
        return
    triggers = find_cycle(angle).triggers
    if triggers is None or triggers >= angle.size:
        return
    apart = np.abs((angle[triggers:] - angle[:-triggers] + 180.0) % 360.0 - 180.0)
    if apart.max() < _REPEATS * np.median(np.abs(signed_steps(angle))):
        _draft_triggers(draft, triggers, angle.size / triggers)


def _draft_triggers(draft: _Draft, triggers: int, count: float) -> None:
    """Triggers per cycle, as the angles of the log show them."""
    cycles = "1 cycle" if count == 1 else f"{count:.4g} cycles"
    draft.note("encoder log", f"{triggers} triggers per cycle, {cycles}")
    remark = f"From the angles of the log: {draft.notes[-1].text}."
    draft.set("encoder.triggers_per_cycle", triggers, remark)


def _draft_mount(draft: _Draft, on_crank: bool) -> None:
    link, motion = ("crank", "go round") if on_crank else ("rocker", "go to and fro")
    draft.set("encoder.mounted_on", link, f"The angles of the log {motion}.")


# profile


def _draft_profile(draft: _Draft, survey: Survey) -> None:
    """The profile of the fixture."""
    # the default, pixel (0, 0), is hardly ever right, and no file shows the pixel that is
    draft.set("fixture.origin", GAP, "Find this pixel in a frame; align = true refines it.")

    table = _find_table(survey, ("x_mm", "thickness_um"))
    if table is None:
        _report_missing_table(draft, survey, "profile", "x_mm, thickness_um")
        return
    draft.set("fixture.profile", os.path.relpath(table.path, survey.directory))
    try:
        profile = read_profile(table.path)
    except ErlifError as error:
        draft.warn("profile", f"{error}")
        return
    low, high = float(profile.thickness.min()), float(profile.thickness.max())
    draft.note("profile", f"{table.path.name}, {table.rows} points from {low:.2f} to {high:.2f} um")


def _find_table(survey: Survey, columns: tuple[str, ...]) -> TextTable | None:
    """The first table that has these columns."""
    fitting = (table for table in survey.tables if set(columns) <= set(table.header))
    return next(fitting, None)


def _report_missing_table(
    draft: _Draft, survey: Survey, what: str, columns: str, *, needed: bool = True
) -> None:
    others = [f"{table.path.name} ({', '.join(table.header)})" for table in survey.tables]
    if not needed and not others:
        draft.note(what, "none was found; each frame is a trigger")
    elif others:
        draft.warn(
            what, f"no CSV file has the columns {columns}; found {list_some(others, most=_LISTED)}"
        )
    else:
        draft.warn(what, f"no CSV file was found; {what} needs the columns {columns}")


# calibration


def _draft_calibration(draft: _Draft, survey: Survey) -> None:
    """Draft the nearest calibration or fixture, and the values that it states."""
    calibrations = list(_calibrations_near(survey.directory.resolve()))[:MOST_CALIBRATIONS]
    if not calibrations:
        draft.warn("calibration", "no calibration.nc or fixture.toml lies near; name it later")
        return
    names = [os.path.relpath(path, survey.directory.resolve()) for path in calibrations]
    name = Path(names[0]).as_posix()
    made = "exists" if calibrations[0].exists() else "is made from its fixture by erlif process"
    remark = f"This file {made}."
    if len(names) > 1:
        listed = [
            name if path.exists() else f"{name} (not made yet, from its fixture.toml)"
            for name, path in zip(names, calibrations, strict=True)
        ]
        remark += f" Others near: {', '.join(listed[1:])}."
        draft.warn(
            "calibration",
            f"{len(names)} calibrations or fixtures lie near, the first was taken: "
            f"{', '.join(listed)}",
        )
    draft.set("calibration", name, remark)
    draft.note("calibration", f"{name} {made}")

    # the same optics as a rule, but not for certain: a hint, not a value
    for key, text in _fixture_hints(calibrations[0]).items():
        if key not in draft.values:
            draft.remarks[key] = f"The calibration has {text}; the same, if nothing was changed."


def _calibrations_near(directory: Path) -> Iterator[Path]:
    """calibration.nc of the folders beside a run, whether it is made yet or not."""
    patterns = ("", "*/", "../", "../*/", "../calibration/*/", "../../*/", "../../calibration/*/")
    seen = set()
    for pattern in patterns:
        for name in ("calibration.nc", "fixture.toml"):
            for path in sorted(directory.glob(f"{pattern}{name}")):
                folder = path.parent.resolve()
                if folder not in seen:
                    seen.add(folder)
                    yield folder / "calibration.nc"


def _fixture_hints(calibration: Path) -> dict[str, str]:
    """Bands and pixel pitch of the fixture, where they can be read."""
    hints = {}
    try:
        settings = read_fixture_settings(calibration.parent)
        bands = settings.camera1.band, settings.camera2.band
        hints["optics.pixel_pitch"] = f"{settings.optics.pixel_pitch * 1e6:g} um"
    except ErlifError:
        try:
            bands = open_calibration(calibration).bands
        except ErlifError:
            return hints
    return hints | {"camera1.band": f"{bands[0]:g} nm", "camera2.band": f"{bands[1]:g} nm"}
