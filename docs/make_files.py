"""Write docs/files.md and the JSON schemas in docs/schema: ``python docs/make_files.py``.

Settings come from the tables of `erlif.io.settings`, variables from `erlif.core.variables`.
Attributes stand below; a test holds all of them to the files that erlif writes.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from erlif.core.flags import Flag
from erlif.core.variables import (
    CALIBRATION,
    FILM,
    FRAMES,
    PREDICTION,
    PRESSURE,
    REGISTRATION,
    Variable,
)
from erlif.io.settings import (
    DesignSettings,
    EnduranceSettings,
    FixtureSettings,
    Key,
    PlanSettings,
    RunSettings,
    Settings,
    Table,
    json_schema,
    keys_of,
    tables_of,
)
from erlif.io.settings.toml import toml_value

DOCS = Path(__file__).parent


@dataclass(frozen=True)
class Attribute:
    """An attribute of a file, a group or a variable."""

    name: str
    meaning: str
    when: str = ""


PREDICTED = FILM["film_predicted_min"].when

PREDICTION_FRAMES = {
    name: one
    for name, one in FRAMES.items()
    if name in ("frame", "trigger", "cycle") or one.when == PREDICTED
}
"""Variables of the group frames of prediction.nc."""

FILM_ATTRIBUTES = (
    Attribute("Conventions", "CF-1.11."),
    Attribute("title", "Title with the name of the run."),
    Attribute("history", "Version of erlif and the step that wrote the file."),
    Attribute("erlif_version", "Version of erlif."),
    Attribute(
        "format_version", "Version of the file format, 1. An earlier erlif refuses a later one."
    ),
    Attribute("settings", "All settings, defaults included, as TOML."),
    Attribute("settings_stated", "Keys that run.toml states, with commas; others are defaults."),
    Attribute("input_hashes", "SHA-256 of every input by its relative name, as JSON."),
    Attribute(
        "identity",
        "SHA-256 of inputs, settings, calibration and version together; `erlif process --resume` "
        "keeps a film of the same identity.",
    ),
    Attribute("calibration", "Parameters, covariance and origin of the calibration, as JSON."),
    Attribute("notes", "Findings about inputs and results, one a line, warnings first."),
    Attribute(
        "physics",
        "Which physics carries the film, and how sure that is, in one line.",
        "the film of an oscillating joint is predicted and positions of its pin are measured",
    ),
    Attribute("largest_error", "The largest error of the mean film, and what would lower it."),
    Attribute("contact", "The smooth gap whose minimum film_min is: plane, line or point."),
    Attribute(
        "smoothing", "Resolution of the smoothed ratio behind the maps. [px]", "smoothing is set"
    ),
    Attribute("smoothing_comment", "What was smoothed and what was not.", "smoothing is set"),
)

PREDICTION_ATTRIBUTES = (
    *(one for one in FILM_ATTRIBUTES[:6]),
    Attribute(
        "input_hashes",
        "SHA-256 of settings and log, and the identity of the film, by their names, as JSON.",
    ),
    Attribute("model", "The equation, and how the pin is held."),
    Attribute("cells", "Cells round the joint and along half of its length."),
    Attribute("start_film", "Minimum film at the first frame. [um]"),
    Attribute("start_film_fitted", "1 where it was fitted to the measured minima."),
)

PRESSURE_ATTRIBUTES = (
    *(
        one
        for one in FILM_ATTRIBUTES
        if one.name in ("title", "history", "erlif_version", "settings", "settings_stated")
    ),
    Attribute("film_identity", "Identity of the film."),
    Attribute("statement", "What the pressure is good for, and what would make it better."),
    Attribute("balance", "The load that it makes, beside the logged one."),
    Attribute("given", "The errors of viscosity and clearance, or that none is stated."),
)

VARIABLE_ATTRIBUTES = (
    Attribute("units", "Unit, in the notation of UDUNITS."),
    Attribute("long_name", "Short description."),
    Attribute("comment", "Further remark."),
    Attribute("ancillary_variables", "Names of the standard deviations and flags of a variable."),
    Attribute(
        "coordinates",
        "Names of the coordinates of the triggers or frames beside their number.",
        "angle or time is known",
    ),
    Attribute("flag_masks", "Of flags: the bits."),
    Attribute("flag_meanings", "Of flags: the names of the bits."),
    Attribute("clearance", "Of displacement and tilt: radial clearance of the joint [um]."),
    Attribute("load_line", "Of displacement, tilt and attitude: load line along sliding [mm]."),
    Attribute("axial_origin", "Of displacement and tilt: origin of positions along the axis [mm]."),
    Attribute(
        "regime",
        "Of film_theory: the name of the prediction; of film_regime_map: the "
        "lubrication regime of most triggers.",
    ),
    Attribute("reason", "Of film_theory and film_regime_map: why this one was selected."),
    Attribute(
        "notes",
        "Of film_theory and film_regime_map: assumptions and how far they hold, one a line.",
    ),
    Attribute(
        "start_film", "Of film_predicted_min: minimum film at the first frame [um].", PREDICTED
    ),
    Attribute(
        "start_film_fitted",
        "Of film_predicted_min: 1 where the start film was fitted to the measured minima.",
        PREDICTED,
    ),
    Attribute(
        "mounted_on",
        "Of the encoder angle: link that carries the encoder.",
        "the motion is that of a linkage",
    ),
    Attribute(
        "direction",
        "Of the encoder angle: whether it rises or falls while the angle of that link rises.",
        "the motion is that of a linkage",
    ),
    Attribute(
        "direction_found",
        "Of the encoder angle: 1 where the log showed that the reading falls.",
        "that is so",
    ),
    Attribute(
        "zero",
        "Of the encoder angle: angle of that link at reading 0 [degree].",
        "the motion is that of a linkage",
    ),
    Attribute(
        "zero_std",
        "Of the encoder angle: standard deviation of the zero [degree].",
        "the zero was fitted",
    ),
    Attribute(
        "start",
        "Of the time of the frames: time of the first frame on the clock of the log [s].",
        "start was fitted",
    ),
    Attribute("start_std", "Its standard deviation [s].", "start was fitted"),
    Attribute("log_scale", "Of an exponent: logarithm of the factor of the fitted power law."),
    Attribute("triggers_used", "Of an exponent: number of triggers in the fit."),
    Attribute("speed", "Of an exponent: variable whose power the film follows."),
    Attribute(
        "source",
        "Of sliding_speed: log where it stands in place of that of the linkage.",
        "the log of a linkage has the speed",
    ),
)

FRAMES_ATTRIBUTES = (
    Attribute(
        "skipped_frames",
        "Frame pairs that were left out, with the reason.",
        "--skip-bad-frames left out a pair",
    ),
)

REGISTRATION_ATTRIBUTES = (
    Attribute("registration_quality", "Correlation of the cameras after registration, 0 to 1."),
    Attribute("registration_model", "Form of the camera map, in words."),
    Attribute("registration_model_asked", "Form that the settings asked for."),
    Attribute("registration_orientation", "Orientation of camera 2 against camera 1."),
    Attribute("registration_window", "Side of the interrogation window. [px]"),
    Attribute("registration_step", "Distance between window centres. [px]"),
    Attribute("registration_passes", "Number of Gauss-Newton passes at full resolution."),
    Attribute("registration_whiten", "1 where spatial frequencies are weighted by coherence."),
    Attribute("registration_search", "Largest offset searched for, as a part of the frame."),
    Attribute("registration_frames_for_map", "Largest number of frame pairs behind the map."),
    Attribute("registration_threads", "Threads used; the result does not depend on it."),
)

BLUR_ATTRIBUTES = (
    Attribute(
        "blur_difference",
        "Half the blur variance of camera 2 less that of camera 1, along x and y. [px2]",
    ),
    Attribute("blur_difference_std", "Its standard deviation. [px2]"),
    Attribute("blur_difference_comment", "The definition of blur_difference."),
    Attribute(
        "ratio_excess",
        "Excess of the mean logarithm of the ratio by unequal texture, taken out where it exceeds "
        "three standard deviations. [1]",
    ),
    Attribute("ratio_excess_std", "Its standard deviation. [1]"),
)

CALIBRATION_ATTRIBUTES = (
    Attribute("Conventions", "CF-1.11."),
    Attribute("title", "ERLIF calibration."),
    Attribute("erlif_version", "Version of erlif."),
    Attribute(
        "format_version", "Version of the file format, 1. An earlier erlif refuses a later one."
    ),
    Attribute("band_camera1_nm", "Centre wavelength of camera 1. [nm]"),
    Attribute("band_camera2_nm", "Centre wavelength of camera 2. [nm]"),
    Attribute("ratio_direction", "camera2/camera1."),
    Attribute("fixture", "Name of the fixture."),
    Attribute("date", "Day the first frame was written, year-month-day."),
    Attribute(
        "temperature_degC",
        "Temperature of the oil of the fixture. [degree_Celsius]",
        "fixture.toml states it",
    ),
    Attribute("input_hashes", "SHA-256 of every input by its relative name, as JSON."),
    Attribute("notes", "Findings about inputs and fit, one a line, warnings first."),
    Attribute("note_records", "The same with level and subject, as JSON."),
    Attribute("profile_file", "Name of the profile among input_hashes."),
    Attribute(
        "pose",
        "Origin, direction and scale of the profile as refined, with covariance, as JSON.",
        "align = true",
    ),
    Attribute(
        "systematics",
        "Errors of the fixture that its frames do not show, and their covariance, as JSON.",
        "[systematics] of fixture.toml has a width above 0",
    ),
)

ENCODER = (
    ("frame", "", "required", "Number of the frame pair: whole numbers that rise by one."),
    ("angle_deg", "degree", "for a linkage", "Encoder angle at the trigger."),
    ("time_s", "s", "optional", "Time of the trigger."),
    (
        "load_N",
        "N",
        "optional",
        "Load on the joint, above 0. Absent: load of [joint] or [mechanism] is used.",
    ),
    (
        "speed_m_s",
        "m s-1",
        "optional",
        "Sliding speed; in place of the speed that [mechanism] gives, or where there is none.",
    ),
    ("temperature_C", "degree Celsius", "optional", "Temperature of the oil, for a Vogel law."),
)

PROFILE = (
    ("x_mm", "mm", "required", "Position along the profile."),
    ("y_mm", "mm", "optional", "Position across the profile, where a surface was measured."),
    ("thickness_um", "um", "required", "Film thickness at this position."),
    ("uncertainty_um", "um", "optional", "Standard deviation of the thickness, above 0."),
)


def settings_section(
    kind: type[Settings], name: str, leave_out: Sequence[str] = ()
) -> Iterator[str]:
    """The tables of a settings file, each with its keys; tables of one form share a section."""
    by_kind: dict[type[Settings], list[Table]] = {}
    for table in tables_of(kind):
        if table.title not in leave_out:
            by_kind.setdefault(table.kind, []).append(table)
    for inner, tables in by_kind.items():
        keys = list(keys_of(inner))
        if not keys:
            continue
        titles = " and ".join(f"\\[{table.title}\\]" for table in tables if table.path)
        choice = keys[0].choices if keys[0].name == "kind" else ()
        heading = titles or f"Top of {name}"
        yield f"### {heading}{f', {choice[0]}' if choice else ''}"
        yield ""
        yield tables[0].meaning if titles else "Keys above the first table."
        if titles and not all(table.required for table in tables):
            yield "The table is optional."
        yield ""
        yield "| key | value | default | meaning |"
        yield "|---|---|---|---|"
        yield from (key_row(key) for key in keys)
        yield ""


def key_row(key: Key) -> str:
    """One row about a key."""
    value = key.form
    if key.choices:
        value = ", ".join(f'`"{choice}"`' for choice in key.choices)
    elif key.bounds:
        value = f"{value}, {key.bounds}"
    if not key.choices:
        value = f"{value}: `{toml_value(key.example)}`"
    meaning, _, absent = key.meaning.partition(" Default: ")
    default = "**required**" if key.required else absent.rstrip(".") or "none"
    if key.default not in (None, ""):
        default = f"`{toml_value(key.default)}`"
    return f"| `{key.name}` | {value} | {default} | {meaning} |"


def variables_table(variables: Mapping[str, Variable], *, always: bool = False) -> Iterator[str]:
    """Rows about the variables of a group."""
    yield "| variable | dims | type | unit | meaning |"
    yield "|---|---|---|---|---|"
    for variable in variables.values():
        when = f" Only where {variable.when}." if variable.when and not always else ""
        dims = ", ".join(variable.dims) or "scalar"
        unit = variable.units or "-"
        meaning = f"{variable.meaning}{when}"
        yield f"| `{variable.name}` | {dims} | {variable.dtype} | {unit} | {meaning} |"
    yield ""


def attributes_table(attributes: Sequence[Attribute]) -> Iterator[str]:
    """Rows about attributes."""
    yield "| attribute | meaning |"
    yield "|---|---|"
    for attribute in attributes:
        when = f" Only where {attribute.when}." if attribute.when else ""
        yield f"| `{attribute.name}` | {attribute.meaning}{when} |"
    yield ""


def columns_table(columns: Sequence[tuple[str, str, str, str]]) -> Iterator[str]:
    """Rows about the columns of a CSV file."""
    yield "| column | unit | | meaning |"
    yield "|---|---|---|---|"
    for name, unit, need, meaning in columns:
        yield f"| `{name}` | {unit or '-'} | {need} | {meaning} |"
    yield ""


def flags_table() -> Iterator[str]:
    """Rows about the bits of flags."""
    meanings = {
        Flag.SATURATED: "A camera reads full scale.",
        Flag.DIM: "A camera has too little light above its dark level for a ratio.",
        Flag.BAD_PIXEL: "Hot, dead or noisy pixel of a camera.",
        Flag.OUTSIDE_OVERLAP: "Seen by one camera only.",
        Flag.BELOW_RANGE: "Film thinner than the calibrated or the measurable range.",
        Flag.ABOVE_RANGE: "Film thicker than the calibrated or the measurable range.",
        Flag.POOR_REGISTRATION: "The registration is not good enough for a ratio.",
        Flag.NO_FILM: "Bubble or bare wall: the fluorescence of both bands is missing.",
    }
    yield "| bit | name | meaning |"
    yield "|---|---|---|"
    for flag in Flag:
        yield f"| {flag.value} | `{str(flag.name).lower()}` | {meanings[flag]} |"
    yield ""


INTRODUCTION = """\
<!-- made by docs/make_files.py; a test holds it to what erlif reads and writes -->

# Files

erlif reads `run.toml`, `fixture.toml`, `encoder.csv`, `profile.csv` and frames; it writes
`calibration.nc`, `film.nc`, `prediction.nc` and `pressure.nc`. This page is generated from the
program.

In settings files a quantity is text with a unit, `"50 lbf"` or `"114 rpm"`, in any unit of its
kind. A bare number in place of a quantity is refused, and so is an unknown key; the message names
the nearest known key. `erlif init` writes a first `run.toml` or `fixture.toml`, in which a gap,
`"??"`, stands for every required value that the files do not show.

Editors with JSON schema complete and check these files. `erlif init` writes the schema beside the
settings, and their first line, `#:schema ./run.schema.json`, points to it for Taplo and Even Better
TOML. The schemas are also in the repository: `docs/schema/run.schema.json` and
`docs/schema/fixture.schema.json`.
"""

FRAMES_TEXT = """\
## Frames

Frames, darks and flats are grey images of 8 or 16-bit unsigned counts, at least 64 x 64 pixels, all
of one size and type in a run, in a format that `erlif.io.readers` recognises. Frame k of
camera 1 and frame k of camera 2 show the same laser pulse, and row k of the encoder log belongs to
them. Single-page files are taken in natural order (frame_2 before frame_10); a multi-page file
holds its frames in order.
"""

STORAGE_TEXT = """\
One chunk of `thickness`, its deviations or `flags` is the map of one trigger, float32 or uint8,
shuffled and deflated. The thickness of a pixel is rounded by at most a tenth of its standard
deviation; `thickness_std` keeps 5 bits of mantissa (1.6 % at most), `thickness_std_shared` 4 bits
(3 %). Text is UTF-8 of a fixed length; a variable of text has a further dimension for its
characters, which xarray removes. Settings in the file stand as the user wrote them.

In `film.zarr` (format 3) the chunks are blosc (lz4, bitshuffle), each a file such as
`thickness/c.12.0.0`. While a film is made, a directory `film.nc.partial` or `film.zarr.partial`
beside it holds what is finished; the next start resumes from it, and a complete film has none."""

SHARED_TABLES_TEXT = """\
The tables \\[camera1\\], \\[camera2\\], \\[optics\\], \\[registration\\] and \\[thickness\\] are
those of run.toml."""

ENCODER_TEXT = """\
One row for each frame pair, below one header row; decimal points, commas between columns."""

FURTHER_COLUMNS_TEXT = """\
Further columns keep their names and travel into film.nc, numbers as the mean over the frames of a
trigger. Their names must differ from the variables of film.nc."""

CAMERA_MAP_TEXT = """\
Group `registration`: the camera map of the fixture, with the variables and attributes of the
[same group in film.nc](#group-registration), without `blur_difference`."""


PREDICTION_TEXT = """\
netCDF-4, written by `erlif predict`: the film that theory predicts for a joint that oscillates. One
chunk of `film_predicted` is the map of one trigger, with 14 bits of mantissa (0.003 % at most).
Maps of single frames follow from their eccentricity and attitude, as docs/prediction.md shows."""


PRESSURE_TEXT = """\
netCDF-4, written by `erlif pressure`: the pressure in the film of a joint that oscillates, from the
measured positions of its pin and their rate."""


PLAN_TEXT = """\
What a rig is to be, for `erlif plan` ([Planning](planning.md)). Spectra are CSV files with the
columns `wavelength_nm,value`; lines that begin with # are remarks."""


ENDURANCE_TEXT = """\
Columns, machine and designs of endurance tests, for `erlif endurance` ([Endurance
tests](endurance.md))."""


JOINT_TEXT = """\
What a pin joint is to be, for `erlif design` ([Design](design.md)). Keys of a part that state a
value of its material replace that of the table."""


def render() -> str:
    """The page as Markdown."""
    shared = ("camera1", "camera2", "optics", "registration", "thickness", "thickness.roi")
    lines = [INTRODUCTION, "## run.toml", ""]
    lines += settings_section(RunSettings, "run.toml")
    lines += ["## fixture.toml", ""]
    lines += [SHARED_TABLES_TEXT, ""]
    lines += settings_section(FixtureSettings, "fixture.toml", leave_out=shared)
    lines += [FRAMES_TEXT]

    lines += ["## encoder.csv", "", ENCODER_TEXT, ""]
    lines += columns_table(ENCODER)
    lines += [FURTHER_COLUMNS_TEXT, "", "## profile.csv", ""]
    lines += ["At least eight points of the fixture, in the order of these columns.", ""]
    lines += columns_table(PROFILE)

    lines += ["## calibration.nc", "", "netCDF-4, written by `erlif calibrate`.", ""]
    lines += variables_table(CALIBRATION)
    lines += ["Attributes of the file:", ""]
    lines += attributes_table(CALIBRATION_ATTRIBUTES)
    lines += [
        "Group `registration`: the camera map of the fixture, with variables and attributes as in "
    ]
    lines[-1] += "[film.nc](#group-registration), the attributes `blur_difference...` excepted."
    lines += [""]

    lines += [
        "## film.nc",
        "",
        "netCDF-4 (or zarr, by the suffix), written by `erlif process`.",
        "",
        STORAGE_TEXT,
        "",
    ]
    lines += variables_table(FILM)
    lines += [
        "Further columns of the encoder log are variables of their own name on `trigger`.",
        "`encoder_angle`, `crank_angle`, `position`, `stroke` and `time` are coordinates of "
        "`trigger`: each variable on it names them in its attribute `coordinates`, after CF, and "
        'xarray gives `film.film_min.plot(x="crank_angle")`. In the group frames, `trigger`, '
        "`cycle` and `time` are coordinates of `frame`.",
        "",
    ]
    lines += ["Bits of `flags`; a valid pixel has none:", ""]
    lines += flags_table()
    lines += ["Attributes of the file:", ""]
    lines += attributes_table(FILM_ATTRIBUTES)
    lines += ["Attributes of variables:", ""]
    lines += attributes_table(VARIABLE_ATTRIBUTES)
    lines += ["### Group frames", "", "What belongs to single frame pairs.", ""]
    lines += variables_table(FRAMES)
    lines += attributes_table(FRAMES_ATTRIBUTES)
    lines += [
        "### Group registration",
        "",
        "The camera map: where camera 2 sees the pixels of camera 1.",
        "",
    ]
    lines += variables_table(REGISTRATION)
    lines += attributes_table([*REGISTRATION_ATTRIBUTES, *BLUR_ATTRIBUTES])

    lines += ["## plan.toml", "", PLAN_TEXT, ""]
    lines += settings_section(PlanSettings, "plan.toml")
    lines += ["## joint.toml", "", JOINT_TEXT, ""]
    lines += settings_section(DesignSettings, "joint.toml")
    lines += ["## endurance.toml", "", ENDURANCE_TEXT, ""]
    lines += settings_section(EnduranceSettings, "endurance.toml")
    lines += ["## prediction.nc", "", PREDICTION_TEXT, ""]
    lines += variables_table(PREDICTION)
    lines += ["Attributes of the file:", ""]
    lines += attributes_table(PREDICTION_ATTRIBUTES)
    lines += ["Group `frames`, what belongs to single frame pairs:", ""]
    lines += variables_table(PREDICTION_FRAMES, always=True)
    lines += ["## pressure.nc", "", PRESSURE_TEXT, ""]
    lines += variables_table(PRESSURE, always=True)
    lines += ["Attributes of the file:", ""]
    lines += attributes_table(PRESSURE_ATTRIBUTES)
    return "\n".join(lines).rstrip("\n") + "\n"


def schemas() -> dict[str, str]:
    """The JSON schemas by their file names."""
    kinds = {
        "run.schema.json": RunSettings,
        "fixture.schema.json": FixtureSettings,
        "plan.schema.json": PlanSettings,
        "joint.schema.json": DesignSettings,
        "endurance.schema.json": EnduranceSettings,
    }
    return {
        name: json.dumps(json_schema(kind), indent=2, ensure_ascii=False) + "\n"
        for name, kind in kinds.items()
    }


def main() -> None:
    """Write the page and the schemas."""
    (DOCS / "files.md").write_text(render(), encoding="utf-8")
    (DOCS / "schema").mkdir(exist_ok=True)
    for name, text in schemas().items():
        (DOCS / "schema" / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
