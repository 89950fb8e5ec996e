"""Write the pages about files and the JSON schemas: ``python docs/make_files.py``.

The pages are docs/settings.md, docs/film_nc.md and docs/other_files.md. Settings come from the
tables of `erlif.io.settings`, variables from `erlif.core.variables`. Attributes stand below; a test
holds all of them to the files that erlif writes.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
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
from erlif.joint.settings import DesignSettings, EnduranceSettings
from erlif.joint.settings.design import PartOfJoint

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
    Attribute("erlif_sources", "Digest of its code and tables, by which checkouts differ."),
    Attribute(
        "format_version", "Version of the file format, 1. An earlier erlif refuses a later one."
    ),
    Attribute("settings", "All settings, defaults included, as TOML."),
    Attribute(
        "settings_version",
        "Number of keys of run.toml, which rises with every new one. An erlif that knows fewer "
        "names it where it cannot read the settings.",
    ),
    Attribute("settings_stated", "Keys that run.toml states, with commas; others are defaults."),
    Attribute("input_hashes", "SHA-256 of every input by its relative name, as JSON."),
    Attribute("recorded", "Day on which the first frame was written."),
    Attribute(
        "camera_serials",
        "Serial numbers of cameras 1 and 2, of the frames, else of run.toml; empty: unknown.",
    ),
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
    Attribute(
        "contact", "The smooth gap whose minimum film_min is: plane, line, journal, point, plateau."
    ),
    Attribute(
        "smoothing", "Resolution of the smoothed ratio behind the maps. [px]", "smoothing is set"
    ),
    Attribute("smoothing_comment", "What was smoothed and what was not.", "smoothing is set"),
)

PREDICTION_ATTRIBUTES = (
    *FILM_ATTRIBUTES[:8],
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
    *FILM_ATTRIBUTES[:6],
    *(one for one in FILM_ATTRIBUTES if one.name.startswith("settings")),
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
    *(
        Attribute(name, f"Of film_over_...: {text}", "the film has theory")
        for name, text in (
            ("factor", "median of the ratio."),
            ("factor_std_random", "random part of its standard deviation."),
            ("factor_std_shared", "part that all triggers share."),
            ("low", "smallest ratio."),
            ("high", "largest ratio."),
            ("outward", "median of the outward stroke."),
            ("back", "median of the return stroke."),
            ("viscosity", "viscosity that makes the factor 1 [Pa s]."),
            ("viscosity_std", "its standard deviation, of the film alone [Pa s]."),
            ("viscosity_std_formula", "its standard deviation by formula_error alone [Pa s]."),
            ("viscosity_given", "viscosity of [oil] at the same triggers [Pa s]."),
        )
    ),
    Attribute(
        "clearance",
        "Of displacement and tilt: radial clearance of the joint, the least along its axis [um].",
    ),
    Attribute(
        "load_line", "Of displacement and tilt: load line along sliding [mm]; also of the attitude."
    ),
    Attribute(
        "load_line_std",
        "Of displacement and tilt: standard deviation of the load line [mm].",
        "it is known",
    ),
    Attribute(
        "radius",
        "Of displacement and tilt: radius over which places along sliding are angles [mm].",
        "the standard deviation of the load line is known",
    ),
    Attribute(
        "load_line_source",
        'Of displacement and tilt: "given", "fitted" to the orbit, middle of the "swing", or '
        '"middle" of the image.',
    ),
    Attribute("axial_origin", "Of displacement and tilt: origin of positions along the axis [mm]."),
    Attribute(
        "regime",
        "Of film_theory and film_predicted_min: the name of the prediction, or the lubrication "
        "regime of most triggers.",
    ),
    Attribute("formula", "Of film_hamrock_dowson: the formula, whose name is its long_name."),
    Attribute("source", "Of film_hamrock_dowson: where the formula was published."),
    Attribute(
        "formula_error",
        "Of film_hamrock_dowson, film_theory and the ratios to them: relative standard deviation "
        "of the formula itself in the regime of most triggers [1]; infinite outside its regime, "
        "and over a bore that is not straight, where formula_of names whose formula it is.",
    ),
    Attribute("formula_error_source", "Of film_hamrock_dowson and film_theory: where it is from."),
    Attribute("reason", "Of film_theory and film_predicted_min: why this one was selected."),
    Attribute(
        "notes",
        "Of film_theory and film_predicted_min: assumptions and how far they hold, one a line.",
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
    Attribute(
        "geometric",
        "Of the exponent of the mean: that of the moving place of the minimum alone.",
        "it excludes an exponent",
    ),
    Attribute("fitted", "Of the same: the exponent that was fitted.", "it is excluded"),
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
    Attribute("registration_passes", "Gauss-Newton passes at full resolution."),
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
        "Excess of the mean logarithm of the ratio by unequal texture. [1]",
    ),
    Attribute("ratio_excess_std", "Its standard deviation. [1]"),
    Attribute("camera_gain", "Gain of both cameras in use. [electron/DN]"),
    Attribute("camera_read_noise", "Read noise of both cameras in use. [electron]"),
    Attribute("camera_response_spread", "Spread of the response of their pixels. [1]"),
)

CALIBRATION_ATTRIBUTES = (
    Attribute("Conventions", "CF-1.11."),
    Attribute("title", "ERLIF calibration."),
    Attribute("history", "Version of erlif and the step that wrote the file."),
    Attribute("erlif_version", "Version of erlif."),
    Attribute("erlif_sources", "Digest of its code and tables, by which checkouts differ."),
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
    Attribute("pixel_pitch_mm", "Pixel pitch of the fixture. [mm]"),
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

PROFILE_TEXT = """\
At least eight points of the fixture, with these columns or with names and units of their own, such
as Position [mm] and Gap [um]. The file has any form of a [log](logs.md#files)."""

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
        meaning = tables[0].meaning if titles else "Keys above the first table."
        if titles and not all(table.required for table in tables):
            meaning += " Optional."
        if issubclass(inner, PartOfJoint):
            meaning += " The keys of the [material](#material-of-a-part) and:"
            keys = [key for key in keys if key not in MATERIAL]
        yield f"### {titles or f'Top of {name}'}{f', {choice[0]}' if choice else ''}"
        yield from ("", meaning, "")
        yield from keys_list(keys)


MATERIAL = list(keys_of(PartOfJoint))
"""Keys that all parts of a joint share."""


def keys_list(keys: Iterable[Key]) -> Iterator[str]:
    """Keys with their form, each with its meaning below."""
    for key in keys:
        meaning, _, absent = key.meaning.partition(" Default: ")
        if meaning.startswith("Default: "):  # the meaning is that of the table
            meaning, absent = "", meaning.removeprefix("Default: ")
        if key.default not in (None, "", {}):
            absent = f"`{toml_value(key.default)}`."
        meaning += f" Default: {absent}" if absent not in ("", "none.") and not key.required else ""
        name = f"**`{key.name}`**" if key.required else f"`{key.name}`"
        yield from (f"{name} {form_of(key)}", f": {meaning.strip()}", "")


def form_of(key: Key) -> str:
    """Kind of value of a key, with its bounds and, where no default shows it, an example."""
    if key.choices:
        one_of = "one of " if len(key.choices) > 1 else ""
        return one_of + ", ".join(f'`"{choice}"`' for choice in key.choices)
    form = key.form
    between = re.fullmatch(r"from (\S+) up to (\S+)", key.bounds)
    if between and not key.unit:
        form += f", {between[1]} to {between[2]}"
    elif key.bounds and not between:
        bounds = key.bounds
        for words, sign in (("above", ">"), ("from", "≥"), (" below", ", <"), (" up to", ", ≤")):
            bounds = bounds.replace(words, sign)
        form += f" {bounds}"
    shown = key.default not in (None, "", {}) and (" or " not in form or form == "true or false")
    return form if shown else f"{form}: `{toml_value(key.example)}`"


def variables_lists(
    variables: Mapping[str, Variable], known: Mapping[str, Variable] | None = None
) -> Iterator[str]:
    """Lists of the variables of a group, those of one condition together.

    With `known`, the variables of film.nc, those that it has as well are listed by name, and no
    condition stands.
    """
    meanings = {name: one.meaning for name, one in (known or {}).items()}
    same = [name for name, one in variables.items() if one.meaning == meanings.get(name)]
    rows = {name: one for name, one in variables.items() if name not in same}
    if same:
        yield f"As in [film.nc](film_nc.md): {', '.join(f'`{name}`' for name in same)}."
        yield ""
    if not rows:
        return
    usual = Counter((one.dims, one.dtype) for one in rows.values()).most_common(1)[0][0]
    dims = f"on `{', '.join(usual[0])}`" if usual[0] else "scalar"
    yield f"Form: {usual[1]} {dims}, unless another is stated."
    yield ""

    # at least three items of one condition have a list of their own
    groups: dict[str, list[str]] = {"": []}
    for when, members in groupby(rows.values(), key=lambda one: one.when if known is None else ""):
        lines = variable_items(list(members), usual)
        if when and len(lines) >= 3:
            groups.setdefault(when, []).extend(lines)
        else:
            groups[""] += [f"{line} Only where {when}." if when else line for line in lines]
    for when, lines in groups.items():
        if when:
            yield from (f"Only where {when}:", "")
        for line in lines:
            yield from (line, "")


def variable_items(variables: Sequence[Variable], usual: tuple[tuple[str, ...], str]) -> list[str]:
    """Items about variables; one for a variable and its standard deviation."""
    names = {one.name for one in variables}
    lines = []
    for one in variables:
        if is_deviation(one) and one.name.removesuffix("_std") in names:
            continue
        std = next((x for x in variables if x.name == f"{one.name}_std" and is_deviation(x)), None)
        form = [one.units] if one.units not in ("", "1") else []
        if one.dtype != usual[1]:
            form.append(one.dtype)
        if one.dims != usual[0]:
            form.append(f"on {', '.join(one.dims)}" if one.dims else "scalar")
        name = f"`{one.name}`, `_std`" if std else f"`{one.name}`"
        lines.append(f"{name} {', '.join(form)}".rstrip() + f"\n: {one.meaning}")
    return lines


def is_deviation(one: Variable) -> bool:
    """Whether a variable is the standard deviation of the one of its name without _std."""
    return one.name.endswith("_std") and one.meaning.startswith("Its standard deviation")


def attributes_list(
    attributes: Sequence[Attribute], known: Sequence[Attribute] = ()
) -> Iterator[str]:
    """Attributes; those that film.nc has as well, `known`, are listed by name."""
    if same := [one.name for one in attributes if one in known]:
        yield f"As in [film.nc](film_nc.md): {', '.join(f'`{name}`' for name in same)}."
        yield ""
    new = [attribute for attribute in attributes if attribute not in known]
    for owner, members in groupby(new, key=owner_of):
        if owner:
            yield from (f"Of {owner}:", "")
        for attribute in members:
            meaning = attribute.meaning.removeprefix(f"Of {owner}: ")
            when = f" Only where {attribute.when}." if attribute.when else ""
            yield from (f"`{attribute.name}`", f": {meaning[0].upper()}{meaning[1:]}{when}", "")


def owner_of(attribute: Attribute) -> str:
    """What the meaning of an attribute names first, as in "Of an exponent: ..."."""
    owner, colon, _ = attribute.meaning.partition(": ")
    return owner.removeprefix("Of ") if colon and owner.startswith("Of ") else ""


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
        Flag.FILM_STEP: "Beside a step of the film, as at the edge of a pocket: the lenses blur "
        "the films of both sides into each other.",
        Flag.MASKED: "Excluded by `exclude` in `[thickness]`, as a scratch or a bolt.",
    }
    yield "| bit | name | meaning |"
    yield "|---|---|---|"
    for flag in Flag:
        yield f"| {flag.value} | `{str(flag.name).lower()}` | {meanings[flag]} |"
    yield ""


MADE = "<!-- made by docs/make_files.py; a test holds it to what erlif reads and writes -->"

SETTINGS_TEXT = """\
# Settings

erlif reads its settings from TOML files: `run.toml` of a run, `fixture.toml` of a calibration
fixture, `plan.toml`, `joint.toml` and `endurance.toml` for the commands of these names. `erlif
init` writes the first two, with a gap, `"??"`, for every required value that the files do not show.

A quantity is text with a unit, `"50 lbf"` or `"114 rpm"`, in any unit of its kind. A bare number in
its place is refused, and so is an unknown key. A key in **bold** is required; the value is an
example where no default shows one.

Editors with JSON schema (Taplo, Even Better TOML) complete and check the files; the schemas are in
`docs/schema`, and `erlif init` writes one beside the settings.
"""

FILM_TEXT = """\
# Variables of film.nc

`erlif process` writes `film.nc`, netCDF-4, or `film.zarr`, by the suffix. xarray reads both:
`erlif.open_film("film.nc")`. `x`, `_std` stands for `x` and for `x_std`, its standard
deviation, random and shared parts together. A unit that is not stated is 1.
"""

OTHER_TEXT = """\
# Other files

What erlif reads beside its [settings](settings.md), and writes beside [film.nc](film_nc.md).
"""

FRAMES_TEXT = """\
## Frames

Frames, darks and flats are grey images of 8 or 16-bit unsigned counts, at least 64 x 64 pixels, all
of one size and type in a run, in one of the [formats](formats.md). Frame k of camera 1 and frame k
of camera 2 show the same laser pulse, and row k of the encoder log belongs to them. Single-page
files are taken in natural order (frame_2 before frame_10).
"""

STORAGE_TEXT = """\
## Storage

A chunk of `thickness`, its deviations or `flags` is the map of one trigger, shuffled and deflated.
The thickness of a pixel is rounded by at most a tenth of its standard deviation; `thickness_std`
keeps 5 bits of mantissa (1.6 % at most), `thickness_std_shared` 4 bits (3 %). Text has a further
dimension for its characters, which xarray removes.

In `film.zarr` (format 3) a chunk is blosc (lz4, bitshuffle) in a file such as `thickness/c.12.0.0`.
While a film is made, `film.nc.partial` or `film.zarr.partial` holds what is finished; the next
start resumes from it."""

COORDINATES_TEXT = """\
Further columns of the encoder log are variables of their own name on `trigger`. `encoder_angle`,
`crank_angle`, `position`, `stroke` and `time` are coordinates of `trigger`, as in
`film.film_min.plot(x="crank_angle")`; in the group frames, `trigger`, `cycle` and `time` are
coordinates of `frame`."""

SHARED_TABLES_TEXT = """\
\\[camera1\\], \\[camera2\\], \\[optics\\], \\[registration\\] and \\[thickness\\] are those of
run.toml."""

ENCODER_TEXT = """\
One header row, then one row for each frame pair; decimal points, commas between columns. Columns of
other names and units are read as [Logs](logs.md) describes."""

FURTHER_COLUMNS_TEXT = """\
Further columns travel into film.nc, numbers as the mean over the frames of a trigger. Their names
must differ from the variables of film.nc."""

REGISTRATION_TEXT = """\
Group `registration`: the camera map of the fixture, as in
[film.nc](film_nc.md#group-registration) without `blur_difference`, `ratio_excess` and the
noise of the cameras."""

PREDICTION_TEXT = """\
netCDF-4, written by `erlif predict`: the film that theory predicts for a joint that oscillates. One
chunk of `film_predicted` is the map of one trigger, with 14 bits of mantissa (0.003 % at most).
Maps of single frames follow from their eccentricity and attitude ([Prediction](prediction.md))."""

PRESSURE_TEXT = """\
netCDF-4, written by `erlif pressure`: the pressure in the film of a joint that oscillates, from the
measured positions of its pin and their rate ([theory](theory/pressure.md))."""

PLAN_TEXT = """\
What a rig is to be, for `erlif plan` ([Planning](planning.md)). Spectra are CSV files with the
columns `wavelength_nm,value`; lines that begin with # are remarks."""

ENDURANCE_TEXT = """\
Columns, machine and designs of endurance tests, for `erlif endurance` ([Endurance
tests](endurance.md))."""

JOINT_TEXT = """\
What a pin joint is to be, for `erlif design` ([Design](design.md)).

### Material of a part

Keys that every part of the joint has. A value that is stated replaces that of the table of
materials."""


def render_settings() -> str:
    """docs/settings.md: every key of every settings file."""
    shared = ("camera1", "camera2", "optics", "registration", "thickness", "thickness.roi")
    lines = [MADE, "", SETTINGS_TEXT, "## run.toml", ""]
    lines += settings_section(RunSettings, "run.toml")
    lines += ["## fixture.toml", "", SHARED_TABLES_TEXT, ""]
    lines += settings_section(FixtureSettings, "fixture.toml", leave_out=shared)
    lines += ["## plan.toml", "", PLAN_TEXT, ""]
    lines += settings_section(PlanSettings, "plan.toml")
    lines += ["## joint.toml", "", JOINT_TEXT, "", *keys_list(MATERIAL)]
    lines += settings_section(DesignSettings, "joint.toml")
    lines += ["## endurance.toml", "", ENDURANCE_TEXT, ""]
    lines += settings_section(EnduranceSettings, "endurance.toml")
    return finish(lines)


def render_film() -> str:
    """docs/film_nc.md: variables, flags and attributes of a film."""
    lines = [MADE, "", FILM_TEXT]
    lines += variables_lists(FILM)
    lines += [COORDINATES_TEXT, ""]
    lines += ["## Bits of flags", "", "A valid pixel has none.", "", *flags_table()]
    lines += ["## Group frames", "", "What belongs to single frame pairs.", ""]
    lines += variables_lists(FRAMES)
    lines += attributes_list(FRAMES_ATTRIBUTES)
    lines += ["## Group registration", ""]
    lines += ["The camera map: where camera 2 sees the pixels of camera 1.", ""]
    lines += variables_lists(REGISTRATION)
    lines += attributes_list([*REGISTRATION_ATTRIBUTES, *BLUR_ATTRIBUTES])
    lines += ["## Attributes", "", "Of the file:", "", *attributes_list(FILM_ATTRIBUTES)]
    lines += ["Of variables:", "", *attributes_list(VARIABLE_ATTRIBUTES), STORAGE_TEXT]
    return finish(lines)


def render_others() -> str:
    """docs/other_files.md: frames, logs, profiles, calibrations, predictions and pressures."""
    lines = [MADE, "", OTHER_TEXT, FRAMES_TEXT, "## encoder.csv", "", ENCODER_TEXT, ""]
    lines += columns_table(ENCODER)
    lines += [FURTHER_COLUMNS_TEXT, "", "## profile.csv", ""]
    lines += [PROFILE_TEXT, ""]
    lines += columns_table(PROFILE)

    lines += ["## calibration.nc", "", "netCDF-4, written by `erlif calibrate`.", ""]
    lines += variables_lists(CALIBRATION)
    lines += attributes_list(CALIBRATION_ATTRIBUTES, FILM_ATTRIBUTES)
    lines += [REGISTRATION_TEXT, ""]

    lines += ["## prediction.nc", "", PREDICTION_TEXT, ""]
    lines += variables_lists(PREDICTION, FILM)
    lines += attributes_list(PREDICTION_ATTRIBUTES, FILM_ATTRIBUTES)
    lines += ["Group `frames`:", ""]
    lines += variables_lists(PREDICTION_FRAMES, FRAMES)

    lines += ["## pressure.nc", "", PRESSURE_TEXT, ""]
    lines += variables_lists(PRESSURE, FILM)
    lines += attributes_list(PRESSURE_ATTRIBUTES, FILM_ATTRIBUTES)
    return finish(lines)


def finish(lines: Sequence[str]) -> str:
    """Text of a page, which ends with one line break."""
    return "\n".join(lines).rstrip("\n") + "\n"


PAGES = {
    "settings.md": render_settings,
    "film_nc.md": render_film,
    "other_files.md": render_others,
}
"""Pages by their file names."""


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
    """Write the pages and the schemas."""
    for name, render in PAGES.items():
        (DOCS / name).write_text(render(), encoding="utf-8")
    (DOCS / "schema").mkdir(exist_ok=True)
    for name, text in schemas().items():
        (DOCS / "schema" / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
