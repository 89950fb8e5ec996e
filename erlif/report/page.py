"""The page itself: what a reader wants to know first stands first."""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from erlif.calibration.storage import calibration_of
from erlif.core.arrays import Array
from erlif.core.flags import Flag
from erlif.core.version import __version__
from erlif.files import open_film, refuse_existing, replacing
from erlif.files.contents import describe_trigger, region_of, settings_of
from erlif.plots.files import DRAWN, FigureSource, find_source, reason_missing
from erlif.plots.maps import common_limits, flag_swatch, flag_title
from erlif.plots.style import FLAG_COLOURS, ONE_COLUMN, colour_map, figure_bytes
from erlif.report.maps import MapCoding, choose_coding, describe_coding, embed_map

_REASONS = {
    Flag.SATURATED: "a camera read full scale",
    Flag.DIM: "too little light above the dark level for a ratio to mean anything",
    Flag.BAD_PIXEL: "hot, dead or noisy pixel of a camera",
    Flag.OUTSIDE_OVERLAP: "seen by one camera only",
    Flag.BELOW_RANGE: "film too thin for the calibration, or for a single pixel in this light",
    Flag.ABOVE_RANGE: "film too thick for the calibration, or for a single pixel in this light",
    Flag.POOR_REGISTRATION: "the cameras are not laid over each other well enough",
    Flag.NO_FILM: "bubble or bare wall: the fluorescence of both bands is missing",
}


@dataclass(frozen=True)
class _Caption:
    title: str
    words: str
    kind: str = "svg"
    dpi: float = 150.0


_CAPTIONS = {
    "speed_against_angle": _Caption(
        "Speed of the joint against encoder angle",
        "The line is the exact kinematics of the linkage, the points are the triggers: filled circles while the angle rises, open "
        "squares while it falls. Right axis: surface speed of the pin.",
    ),
    "fixture_profile": _Caption(
        "Profile of the calibration fixture",
        "Thickness by the coordinate measuring machine (CMM), bars one standard deviation where the profile gives them; shaded: the "
        "range in which the calibration answers.",
    ),
    "processed_images": _Caption(
        "Processed images of one trigger",
        "Both bands after dark, flat and, for camera 2, resampling onto the pixel grid of camera 1. Grey: outside camera 2.",
        "png",
    ),
    "ratio_image": _Caption(
        "Ratio of the two images", "Camera 2 over camera 1, which rises with thickness.", "png"
    ),
    "calibration": _Caption(
        "Calibration",
        "(a) Ratio against thickness with the fitted reabsorption model and its 95 % band; bars are one standard deviation, the "
        "error of the CMM included. (b) What the fit leaves. Shaded: the range in which the calibration answers.",
    ),
    "thickness_map": _Caption(
        "Film thickness at one trigger",
        "(a) Map; pixels that do not answer have the colour of their reason; dashed: region of interest. (b) Profile along sliding, "
        "averaged over the axial extent of the region, with the gap of rigid bodies h = h_min + x²/2R laid through it. (c) The "
        "difference of the two. Bands hold 95 % of the random error, dashed lines that of the error that all pixels share.",
        "png",
    ),
    "film_against_speed": _Caption(
        "Film against speed over load",
        "(a) Mean and least film of each trigger with the fitted powers n; bars one standard deviation, random and shared. Grey "
        "points, where there are any, were too slow for the fit. (b) The least film with theory on scales that hold both.",
    ),
    "map_sheet": _Caption(
        "The maps of a whole cycle", "One colour scale for all. Grey: no answer.", "png"
    ),
    "film_over_cycle": _Caption(
        "Film and speed over the cycle",
        "(a) Mean and least film with 95 % bands, random and shared errors together; (b) speed. Dotted: the motion turns.",
    ),
    "registration": _Caption(
        "Registration of the cameras",
        "(a, b) Displacement of camera 2 against camera 1 less its mean; dashed: edge of what both see. (c) Drift on top of it in "
        "each frame.",
        "png",
    ),
}


def write_report(
    film_path: str | Path,
    out_path: str | Path,
    *,
    run_dir: str | Path | None = None,
    fixture_dir: str | Path | None = None,
    overwrite: bool = False,
) -> Path:
    """Write one self-contained HTML page about a film.

    The page holds a summary, the figures, a viewer of all maps, a table of the triggers, settings and input hashes. It asks for
    nothing from outside and works opened from a file. Where all pixels would make it larger than about 15 MB, every
    second or third along each axis is kept, and the page says so.

    Parameters
    ----------
    film_path : path
        ``film.nc`` or ``film.zarr``.
    out_path : path
        The page.
    run_dir, fixture_dir : path, optional
        As for `erlif.plots.write_figures`.
    overwrite : bool
        Replace an existing page.

    Returns
    -------
    Path
        `out_path`.

    Raises
    ------
    OutputError
        If the page exists or cannot be written, or there is no such film.
    """
    out_path = Path(out_path)
    refuse_existing(out_path, overwrite=overwrite)
    with open_film(film_path) as film:
        source = find_source(Path(film_path), film, None, run_dir, fixture_dir)
        text = _page(source)
    with replacing(out_path) as scratch:
        scratch.write_text(text, encoding="utf-8")
    return out_path


def _page(source: FigureSource) -> str:
    film = source.film
    coding = choose_coding(film, thickest=calibration_of(film).thickness_range[1])
    maps, counts = [], []
    for trigger in range(film.sizes["trigger"]):
        maps.append(embed_map(film, trigger=trigger, coding=coding))
        flags = film.flags.isel(trigger=trigger).values
        counts.append(
            [int((flags == 0).sum())] + [int(((flags & int(flag)) != 0).sum()) for flag in Flag]
        )
    tally = np.array(counts, float) / (film.sizes["y"] * film.sizes["x"])
    name = settings_of(film).name
    sections = [
        ("summary", "Summary", _summary(source, tally)),
        ("viewer", "Film maps", _viewer(film, coding)),
        ("figures", "Figures", _figures(source)),
        ("triggers", "Triggers", _trigger_table(film, tally[:, 0])),
        ("provenance", "Settings and inputs", _provenance(film)),
    ]
    contents = "".join(f'<li><a href="#{key}">{title}</a></li>' for key, title, _ in sections)
    body = "\n".join(
        f'<section id="{key}" aria-labelledby="{key}-title"><h2 id="{key}-title">{title}</h2>\n{content}\n</section>'
        for key, title, content in sections
    )
    embedded = "\n".join(
        f'<script type="text/plain" id="map-{k}">{text}</script>' for k, text in enumerate(maps)
    )
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(name)}: oil-film thickness</title>
<style>
{_resource("page.css")}</style>
</head>
<body>
<header>
<h1>{escape(name)}</h1>
<p class="quiet">Oil-film thickness from two-camera fluorescence, erlif {escape(str(film.attrs.get("erlif_version", __version__)))}</p>
<nav aria-label="Contents"><ul>{contents}</ul></nav>
</header>
<main>
{body}
</main>
<script type="application/json" id="film-data">{_viewer_data(film, coding)}</script>
{embedded}
<script>
{_resource("viewer.js")}</script>
</body>
</html>
"""


def _resource(name: str) -> str:
    return resources.files("erlif.report").joinpath(name).read_text(encoding="utf-8")


def with_error(value: float, std: float, unit: str = "") -> str:
    """A value and its standard deviation, both to the second digit of the latter."""
    if not math.isfinite(value):
        return "not known"
    if not (math.isfinite(std) and std > 0):
        return f"{value:.4g} {unit}".strip()
    digits = max(0, 1 - math.floor(math.log10(std)))
    return f"{value:.{digits}f} ± {std:.{digits}f} {unit}".strip().replace("-", "−")


def _table(
    rows: Iterable[Sequence[str]],
    *,
    head: Sequence[str] = (),
    caption: str = "",
    numbers: Iterable[int] = (),
) -> str:
    """An HTML table; cells are HTML already, the first of each row heads it where there is no `head`."""
    right = set(numbers)
    kind = ['class="n"' if n in right else "" for n in range(64)]
    parts = ["<table>", f"<caption>{caption}</caption>" if caption else ""]
    if head:
        cells = "".join(f'<th scope="col" {kind[n]}>{cell}</th>' for n, cell in enumerate(head))
        parts.append(f"<thead><tr>{cells}</tr></thead>")
    parts.append("<tbody>")
    for row in rows:
        cells = f'<th scope="row" {kind[0]}>{row[0]}</th>'
        cells += "".join(f"<td {kind[n]}>{cell}</td>" for n, cell in enumerate(row[1:], 1))
        parts.append(f"<tr>{cells}</tr>")
    parts.append("</tbody></table>")
    return "".join(parts).replace(" >", ">")


def _summary(source: FigureSource, tally: Array) -> str:
    film = source.film
    return "\n".join(
        [
            '<div class="columns"><div>',
            _results_table(film, tally),
            "</div><div>",
            _calibration_table(source),
            _registration_table(source),
            "</div></div>",
            _flag_table(tally),
            _notes(film),
        ]
    )


def _results_table(film: xr.Dataset, tally: Array) -> str:
    rows = [
        ("Triggers, frames", f"{film.sizes['trigger']}, {int(film.frames_used.sum())}"),
        ("Image", f"{film.sizes['x']} × {film.sizes['y']} pixels"),
        ("Valid pixels", f"{100 * float(tally[:, 0].mean()):.1f} %"),
    ]
    for name, title in (("film_min", "Least film"), ("film_mean", "Mean film")):
        value, std = film[name].values, film[f"{name}_std"].values
        if np.isfinite(value).any():
            low, high = int(np.nanargmin(value)), int(np.nanargmax(value))
            ends = [with_error(float(value[k]), float(std[k])) for k in (low, high)]
            rows.append((f"{title}, over the cycle", f"{ends[0]} to {ends[1]} µm"))
    for name, title in (("speed_exponent", "least film"), ("speed_exponent_mean", "mean film")):
        if name in film:
            used = film[name].attrs.get("triggers_used")
            words = with_error(float(film[name]), float(film[f"{name}_std"]))
            rows.append(
                (
                    f"Power of speed over load, {title}",
                    words + (f" ({int(used)} triggers)" if used is not None else ""),
                )
            )
    theory = film.film_theory
    rows.append(("Theory", escape(str(theory.attrs.get("long_name", "")))))
    rows.append(
        ("Its range", f"{_span(theory.values)} µm; measured least film over it: {_share(film)}")
    )
    rows.append(("Why this theory", escape(str(theory.attrs.get("reason", "")))))
    rows.append(("2.65 line-contact formula", f"{_span(film.film_hamrock_dowson.values)} µm"))
    if "film_parameter" in film:
        rows.append(("Film parameter Λ", _span(film.film_parameter.values)))
    rows.append(("Load", f"{_span(film['load'].values)} N"))
    limits = [escape(line) for line in str(theory.attrs.get("notes", "")).split("\n") if line]
    table = _table(rows, caption="Results (± is one standard deviation, random and shared)")
    return table + (
        f"<p class='quiet'>Limits of the theory: {' '.join(limits)}</p>" if limits else ""
    )


def _span(values: Array) -> str:
    known = values[np.isfinite(values)]
    if known.size == 0:
        return "not known"
    low, high = float(known.min()), float(known.max())
    return f"{low:.4g} to {high:.4g}" if f"{low:.4g}" != f"{high:.4g}" else f"{low:.4g}"


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else "not known"


def _share(film: xr.Dataset) -> str:
    share = film.film_min.values / film.film_theory.values
    known = share[np.isfinite(share)]
    return f"{float(np.median(known)):.2g} (median)" if known.size else "not known"


def _calibration_table(source: FigureSource) -> str:
    calibration = source.calibration
    K, p, q = calibration.parameters.tolist()
    stds = calibration.standard_deviations.tolist()
    low, high = calibration.thickness_range
    rows = [
        (
            "Fixture",
            escape(calibration.fixture)
            + (f", {escape(calibration.date)}" if calibration.date else ""),
        ),
        (
            "Ratio",
            f"{calibration.bands[1]:g} nm over {calibration.bands[0]:g} nm (camera 2 over camera 1)",
        ),
        ("Ratio of a vanishing film, K", with_error(K, stds[0])),
        ("Attenuation of camera 1, p", with_error(p, stds[1], "µm⁻¹")),
        ("Attenuation of camera 2, q", with_error(q, stds[2], "µm⁻¹")),
        ("Answers from", f"{low:.2f} to {high:.2f} µm"),
    ]
    if math.isfinite(calibration.reduced_chi_square):
        rows.append(("Reduced χ²", f"{calibration.reduced_chi_square:.2f}"))
    return _table(rows, caption="Calibration")


def _registration_table(source: FigureSource) -> str:
    registration, frames = source.group("registration"), source.group("frames")
    drift = np.hypot(frames.drift_x.values, frames.drift_y.values)
    rows = [
        (
            "Correlation of the aligned textures",
            f"{float(registration.attrs['registration_quality']):.3f}",
        ),
        ("Model", escape(str(registration.attrs["registration_model"]))),
        (
            "Standard deviation of the map",
            f"{float(np.nanmedian(registration.displacement_std.values)):.3f} px (median)",
        ),
    ]
    if np.isfinite(drift).any():
        rms, most = math.sqrt(float(np.nanmean(drift**2))), float(np.nanmax(drift))
        rows.append(("Drift of camera 2", f"{rms:.2f} px rms, {most:.2f} px at most"))
    if "pulse_energy" in frames and np.isfinite(frames.pulse_energy.values).any():
        rows.append(
            (
                "Pulse energy",
                f"varies by {100 * float(np.nanstd(frames.pulse_energy.values)):.1f} %",
            )
        )
    skipped = int(np.isnan(frames.drift_x.values).sum())
    if skipped:
        rows.append(("Frame pairs left out", f"{skipped}"))
    return _table(rows, caption="Registration")


def _flag_table(tally: Array) -> str:
    rows = [
        (
            f'<span class="swatch" style="background:{flag_swatch(flag)}"></span>{flag_title(flag)}',
            _REASONS[flag],
            f"{100 * float(share):.2f} %",
        )
        for flag, share in zip(Flag, tally[:, 1:].mean(axis=0), strict=True)
        if share > 0
    ]
    if not rows:
        return "<p>Every pixel answers.</p>"
    caption = "Pixels that do not answer (one pixel may have several reasons)"
    return _table(rows, head=("Flag", "Reason", "Share"), caption=caption, numbers=[2])


def _notes(film: xr.Dataset) -> str:
    notes = [line for line in str(film.attrs.get("notes", "")).split("\n") if line]
    unique = dict.fromkeys(notes)
    return (
        "<h3>Notes</h3><ul>" + "".join(f"<li>{escape(note)}</li>" for note in unique) + "</ul>"
        if unique
        else ""
    )


def _figures(source: FigureSource) -> str:
    parts, missing = [], []
    for name, draw in DRAWN.items():
        caption = _CAPTIONS[name]
        reason = reason_missing(name, source)
        if reason is not None:
            missing.append(f"<li>{caption.title}: {escape(reason)}</li>")
            continue
        words = caption.words
        if name in ("processed_images", "ratio_image", "thickness_map"):
            words = f"{describe_trigger(source.film, source.trigger).capitalize()}. {words}"
        figure = draw(source)
        image = figure_bytes(figure, kind=caption.kind, dpi=caption.dpi)
        width = "two" if figure.get_figwidth() > 1.5 * ONE_COLUMN else "one"
        media = {"svg": "image/svg+xml", "png": "image/png"}[caption.kind]
        text = base64.b64encode(image).decode("ascii")
        parts.append(
            f'<figure id="figure-{name}" class="{width}"><img src="data:{media};base64,{text}" alt="{escape(caption.title)}. {escape(words)}">'
            f"<figcaption><strong>{escape(caption.title)}.</strong> {escape(words)}</figcaption></figure>"
        )
    left_out = f"<h3>Left out</h3><ul>{''.join(missing)}</ul>" if missing else ""
    return '<div class="figures">\n' + "\n".join(parts) + "\n</div>" + left_out


def _trigger_table(film: xr.Dataset, valid: Array) -> str:
    head = [
        "Trigger",
        "Stroke",
        "Encoder [°]",
        "Crank [°]",
        "Speed [rad/s]",
        "Sliding [mm/s]",
        "Load [N]",
    ]
    head += ["Oil [°C]"] if "temperature" in film else []
    head += ["Frames", "Mean film [µm]", "Least film [µm]", "Theory [µm]", "2.65 formula [µm]"]
    head += ["Λ"] if "film_parameter" in film else []
    head += ["Valid"]
    rows = []
    for k in range(film.sizes["trigger"]):
        one = {str(name): film[name].values[k] for name in film if film[name].dims == ("trigger",)}
        row = [f"{k}", "outward" if one["stroke"] > 0 else "return"]
        row += [
            f"{one['encoder_angle']:.2f}",
            f"{one['crank_angle']:.2f}",
            f"{one['rocker_speed']:.3f}".replace("-", "−"),
        ]
        row += [f"{1e3 * one['sliding_speed']:.1f}", f"{one['load']:.1f}"]
        row += [f"{one['temperature']:.2f}"] if "temperature" in film else []
        row += [f"{int(one['frames_used'])}"]
        row += [
            with_error(float(one[name]), float(one[f"{name}_std"]))
            for name in ("film_mean", "film_min")
        ]
        row += [_number(one["film_theory"], 1), _number(one["film_hamrock_dowson"], 3)]
        row += [_number(one["film_parameter"], 1)] if "film_parameter" in film else []
        rows.append([*row, f"{100 * valid[k]:.1f} %"])
    table = _table(rows, head=head, numbers=[0, *range(2, len(head))])
    return f'<div class="wide" tabindex="0" role="region" aria-label="Table of the triggers">{table}</div>'


def _provenance(film: xr.Dataset) -> str:
    parts = [f"<p>{escape(str(film.attrs.get('history', '')))}</p>"]
    parts.append(
        f"<details><summary>Settings</summary><pre>{escape(str(film.attrs['settings']))}</pre></details>"
    )
    kept = json.loads(str(film.attrs.get("calibration", "{}")))
    for title, hashes in (
        ("Inputs of the run", json.loads(str(film.attrs.get("input_hashes", "{}")))),
        ("Inputs of the calibration", kept.get("input_hashes", {})),
    ):
        rows = [
            (escape(name), f'<code class="hash">{escape(digest)}</code>')
            for name, digest in hashes.items()
        ]
        if rows:
            table = _table(rows, head=("File", "SHA-256"))
            parts.append(
                f'<details><summary>{title}</summary><div class="wide">{table}</div></details>'
            )
    return "\n".join(parts)


def _viewer(film: xr.Dataset, coding: MapCoding) -> str:
    last = film.sizes["trigger"] - 1
    ordinal = {2: "2nd", 3: "3rd"}.get(coding.stride, f"{coding.stride}th")
    thinned = (
        f" The page holds every {ordinal} pixel along each axis; the film file holds all."
        if coding.stride > 1
        else ""
    )
    key = "".join(
        f'<li><span class="swatch" style="background:{flag_swatch(flag)}"></span>{flag_title(flag)}</li>'
        for flag in FLAG_COLOURS
    )
    return f"""<p>Move over the map to read the film; click, or use the arrow keys (with Shift ten at a time), to draw the profile
of a row. The dashed box is the region of interest.{thinned} Thickness is kept to {1e3 * coding.step:g} nm; standard deviations
are those of single pixels, medians of 4 × 4.</p>
<p><strong id="trigger-title" aria-live="polite"></strong></p>
<div class="controls">
<label for="trigger">Trigger</label>
<button type="button" id="previous">Previous</button>
<input type="range" id="trigger" min="0" max="{last}" step="1" value="0">
<button type="button" id="next">Next</button>
</div>
<div class="viewer">
<canvas id="map" tabindex="0" role="img" aria-label="Map of film thickness at the chosen trigger"></canvas>
<div><canvas id="profile" role="img" aria-label="Film thickness along the chosen row"></canvas>
<output id="readout" for="trigger"></output></div>
</div>
<ul class="key" aria-label="Colours of pixels without an answer">{key}</ul>
<noscript><p>The viewer needs JavaScript; the figures below do not.</p></noscript>"""


def _viewer_data(film: xr.Dataset, coding: MapCoding) -> str:
    x, y = film.x.values[:: coding.stride], film.y.values[:: coding.stride]
    region = region_of(film)
    sliding = settings_of(film).optics.x_axis == "sliding"
    colours = (
        (np.asarray(colour_map("batlow")(np.linspace(0, 1, 256)))[:, :3] * 255).round().astype(int)
    )
    count = film.sizes["trigger"]
    limits = common_limits(film, range(0, count, max(1, count // 12)))
    pitch = (float(x[1] - x[0]), float(y[1] - y[0]))
    data: dict[str, Any] = {
        "width": int(x.size),
        "height": int(y.size),
        "coding": describe_coding(coding),
        "x": [float(x[0]), pitch[0]],
        "y": [float(y[0]), pitch[1]],
        "pixelAspect": pitch[1] / pitch[0],
        "xLabel": f"x ({'sliding' if sliding else 'axial'}) [mm]",
        "yLabel": f"y ({'axial' if sliding else 'sliding'}) [mm]",
        "region": [*region.x, *region.y],
        "limits": [round(limit, 3) for limit in limits],
        "palette": "".join(
            f"{red:02x}{green:02x}{blue:02x}" for red, green, blue in colours.tolist()
        ),
        "flags": [
            {
                "bit": int(flag),
                "name": flag_title(flag),
                "rgb": [int(flag_swatch(flag)[n : n + 2], 16) for n in (1, 3, 5)],
            }
            for flag in FLAG_COLOURS
        ],
        "triggers": [describe_trigger(film, k).capitalize() for k in range(count)],
    }
    return json.dumps(data, ensure_ascii=False, separators=(",", ":")).replace("<", "\\u003c")
