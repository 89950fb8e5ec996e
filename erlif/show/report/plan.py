"""The plan of a rig in sentences and in a table of films."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.core.errors import OutputError
from erlif.core.units import count_of
from erlif.io.files import replacing
from erlif.io.settings import PlanSettings, to_toml

WRITTEN = ("plan.png", "plan.pdf", "films.csv", "tolerances.csv", "plan.toml", "optimum.toml")
"""Files of a plan's directory."""

ORDER_OF_ONE = 1 / 3
"""Reabsorption over absorption from which on a system counts as optically thick: half a decade
around 1, as the source states an order of magnitude."""

_ROWS = 7  # films in the printed table
_MEANINGLESS = 10.0  # share of the film beyond which an error is not printed
_NEARLY_ALL = 0.9995  # of the pulse energy: a smaller change is not printed
_FAR_BELOW = 0.1  # of the fluence of saturation, where a dye loses about a tenth of its absorption


def summarise_plan(plan: xr.Dataset) -> str:
    """State what a rig would measure.

    Parameters
    ----------
    plan : xarray.Dataset
        From `erlif.plan`.

    Returns
    -------
    str
        Sentences, a table of films, the best concentrations and the tolerances.

    Examples
    --------
    >>> from erlif.show.plots import example_plan_results
    >>> print(summarise_plan(example_plan_results()).splitlines()[0])
    Plan: example rig, films of 2 to 10 um
    """
    blocks = [
        [_describe_title(plan), *_describe_dyes(plan), *_describe_range(plan)],
        _film_table(plan),
        _describe_optimum(plan),
        _tolerance_table(plan),
        _describe_limits(plan),
    ]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def _describe_title(plan: xr.Dataset) -> str:
    """Name of the plan, with its films: a name is often kept where the films have changed."""
    first, last = plan.film_range.values
    return f"Plan: {plan.attrs['title']}, films of {first:g} to {last:g} um"


def _describe_dyes(plan: xr.Dataset) -> list[str]:
    p, q = float(plan.attenuation_camera1), float(plan.attenuation_camera2)
    low, high = plan.concentration.values
    share = float(plan.reabsorption / plan.absorption)
    thick = "optically thick" if share >= ORDER_OF_ONE else "not optically thick"
    depth = float(plan.absorption) * float(plan.film_range[1])
    lines = [
        f"Dyes: {low:.4g} and {high:.4g} mol/L; attenuation p = {p:.4g} and q = {q:.4g} 1/um, "
        f"ratio from {float(plan.ratio_at_zero):.3g} (no film) to {float(plan.ratio_thick):.3g} "
        "(very thick film).",
        f"Dye 2 reabsorbs {share:.2f} times as strongly as both dyes absorb the laser: {thick} "
        f"(Farzaneh 2002). The thickest film absorbs {-math.expm1(-depth):.0%} of the laser light.",
    ]
    if plan.attrs["synthetic"]:
        lines.append("The spectra are invented: these numbers are not those of a real dye.")
    return lines


def _describe_range(plan: xr.Dataset) -> list[str]:
    frames = int(plan.attrs["frames"])
    low, high = plan.measurable_range.values
    lines = [
        f"One pixel of one frame is measurable from {low:.3g} to {high:.3g} um."
        if math.isfinite(low)
        else "No film is measurable in one pixel of one frame."
    ]
    first, last = plan.film_range.values
    several, to = plan.measurable_range_frames.values
    if frames > 1 and math.isfinite(several):
        lines.append(f"With {frames} frames it is measurable from {several:.3g} to {to:.3g} um.")
    if not (several <= first and last <= to):
        lines.append(
            f"The wanted range, {first:g} to {last:g} um, is not covered by single pixels."
        )

    wanted, how = _describe_aim(plan)
    needed = _most_frames(plan.frames_needed, plan)
    if math.isfinite(needed):
        pairs = count_of(round(needed), "frame pair")
        lines.append(f"{wanted} over the whole range needs {pairs} in {how}.")
    elif _saturated(plan):
        lines.append(f"{wanted} cannot be reached over the whole range: a camera saturates.")
    else:
        lines.append(
            f"{wanted} cannot be reached over the whole range in {how}: the noise of the dark and "
            "flat pages alone exceeds it. Take more pages, average over more pixels, or change the "
            "concentrations."
        )
    return lines


def _saturated(plan: xr.Dataset) -> dict[int, float]:
    """Signal of the thickest film by camera, where it is beyond full scale. [electron]"""
    wanted = plan.signal.interp(thickness=plan.film_range.values[1]).values
    return {
        number: float(electrons)
        for number, electrons in enumerate(wanted, start=1)
        if electrons > float(plan.full_scale[number - 1])
    }


def _describe_aim(plan: xr.Dataset) -> tuple[str, str]:
    """The wanted standard deviation, and what it holds for."""
    average = int(plan.attrs["average"])
    how = f"averages of {average} x {average} pixels" if average > 1 else "single pixels"
    return f"A standard deviation of {100 * plan.attrs['uncertainty']:.3g} % of the film", how


def _most_frames(needed: xr.DataArray, plan: xr.Dataset) -> float:
    """Frames that the most demanding film of the wanted range needs."""
    first, last = plan.film_range.values
    inside = (plan.thickness >= first) & (plan.thickness <= last)
    return float(needed.where(inside).max())


def _percent(share: float, width: int = 0, sign: str = "") -> str:
    """A share in per cent; beyond ten times the film it has no meaning, and NaN is a dash."""
    if math.isnan(share):
        return f"{'-':>{width}}"
    if abs(share) > _MEANINGLESS:
        return f"{'> 1000%':>{width}}" if width else "more than 1000%"
    return f"{share:{sign}{width or ''}.1%}"


def _film_table(plan: xr.Dataset) -> list[str]:
    frames, average = int(plan.attrs["frames"]), int(plan.attrs["average"])
    plan_label = f"{count_of(frames, 'frame')}" + (f", {average} px" if average > 1 else "")
    head = (
        f"{'film um':>8} {'ratio':>7} {'electrons 1':>11} {'electrons 2':>11} "
        f"{'std um':>8} {'of film':>8} {plan_label:>14} {'frames needed':>13} {'best conc.':>10}"
    )
    first, last = plan.film_range.values
    rows = plan.interp(thickness=np.geomspace(first, last, _ROWS))
    near = plan.sel(thickness=rows.thickness, method="nearest")
    lines = [head]
    for k in range(_ROWS):
        film = float(rows.thickness[k])
        std, averaged = float(rows.thickness_std[k]), float(rows.thickness_std_frames[k])
        one, two = rows.signal.values[:, k]
        count, best = (
            f"{needed:.0f}" if math.isfinite(needed) else "never"
            for needed in (float(near.frames_needed[k]), float(near.optimum_frames_needed[k]))
        )
        lines.append(
            f"{film:8.3g} {float(rows.ratio[k]):7.4f} {one:11.0f} {two:11.0f} "
            f"{_um(std, film):>8} {_percent(std / film, 8)} {_um(averaged, film):>14} {count:>13} "
            f"{best:>10}"
        )
    return lines


def _um(std: float, film: float) -> str:
    """A standard deviation in um; a dash where it has no meaning."""
    return f"{std:.3g}" if std < _MEANINGLESS * film else "-"


def _describe_optimum(plan: xr.Dataset) -> list[str]:
    one, two = plan.optimum_concentration.values
    energy, error = float(plan.optimum_pulse_energy), float(plan.optimum_largest_error)
    limited = plan.attrs["optimum_limited_by_solubility"]
    notes = ", ".join(
        f"dye {number} at its solubility" for number, hit in enumerate(limited, start=1) if hit
    )
    if error > _MEANINGLESS:
        return [
            "No concentrations give a film over the whole wanted range: with the best ones, "
            f"{one:.3g} and {two:.3g} mol/L{f' ({notes})' if notes else ''}, the largest standard "
            f"deviation is {_percent(error)} of the film. Narrow the range, or raise the light."
        ]
    low, high = plan.optimum_measurable_range.values
    lines = [
        f"Best concentrations: {one:.3g} and {two:.3g} mol/L{f' ({notes})' if notes else ''}. The "
        f"largest standard deviation over the wanted range is then {_percent(error)} of the film, "
        f"instead of {_percent(float(plan.largest_error))}."
    ]
    wanted, how = _describe_aim(plan)
    needed = _most_frames(plan.optimum_frames_needed, plan)
    if math.isfinite(needed):
        pairs = count_of(round(needed), "frame pair")
        lines.append(f"{wanted} over the whole range then needs {pairs} in {how}.")
    else:
        lines.append(f"{wanted} is not reached over the whole range with them either.")
    if math.isfinite(low):
        lines.append(f"One pixel of one frame is then measurable from {low:.3g} to {high:.3g} um.")
    frames, (several, to) = int(plan.attrs["frames"]), plan.optimum_measurable_range_frames.values
    if frames > 1 and math.isfinite(several):
        lines.append(
            f"With {frames} frames it is then measurable from {several:.3g} to {to:.3g} um."
        )
    if energy < _NEARLY_ALL:
        lines.append(f"They need {energy:.1%} of the pulse energy, or a camera would saturate.")
    return lines


def _tolerance_table(plan: xr.Dataset) -> list[str]:
    lines = [
        f"{'tolerance':<24} {'size':>6} {'std':>7} {'thinnest':>9} {'thickest':>9} {'film':>7}",
    ]
    for k in range(plan.sizes["tolerance"]):
        row = plan.isel(tolerance=k)
        lines.append(
            f"{row.tolerance.item():<24} {row.tolerance_size.item():>6} "
            f"{_percent(float(row.tolerance_std), 7, '+')} {_change(row.tolerance_thinnest):>9} "
            f"{_change(row.tolerance_thickest):>9} {_percent(float(row.tolerance_film), 7)}"
        )
    return [
        *lines,
        "std: change of the largest standard deviation; thinnest, thickest: change of the "
        "measurable range in um; film: largest error of a film where the change follows the "
        "calibration.",
    ]


def _change(length: xr.DataArray) -> str:
    """Change of an end of the range in um; a dash where there is no range."""
    return f"{float(length):+.2f}" if math.isfinite(float(length)) else "-"


def _describe_limits(plan: xr.Dataset) -> list[str]:
    lines = []
    for number, electrons in _saturated(plan).items():
        full = float(plan.full_scale[number - 1])
        lines.append(
            f"Camera {number} saturates: {electrons:.0f} electrons from the thickest film, full "
            f"scale is {full:.0f}. Lower the pulse energy to {full / electrons:.1%} of it, or less."
        )
    fluence = float(plan.attrs.get("pulse_fluence", 0.0))
    saturation = float(plan.attrs.get("saturation_fluence", math.inf))
    if fluence > _FAR_BELOW * saturation:
        lines.append(
            f"The pulse has {1e3 * fluence:.3g} mJ/cm2; the dyes saturate at about "
            f"{1e3 * saturation:.2g} mJ/cm2. Light and ratio then depart from this plan: lower the "
            "pulse energy or widen the beam."
        )
    return lines


def table_of_films(plan: xr.Dataset) -> str:
    """Write the curves of a plan as CSV.

    Parameters
    ----------
    plan : xarray.Dataset
        From `erlif.plan`.

    Returns
    -------
    str
        One line for each thickness, the units in the header.

    Examples
    --------
    >>> from erlif.show.plots import example_plan_results
    >>> table_of_films(example_plan_results()).splitlines()[0].split(",")[:3]
    ['thickness_um', 'ratio', 'log_ratio_slope_per_um']
    """
    columns = {
        "thickness_um": plan.thickness,
        "ratio": plan.ratio,
        "log_ratio_slope_per_um": plan.log_ratio_slope,
        "signal_camera1_electron": plan.signal[0],
        "signal_camera2_electron": plan.signal[1],
        "std_um": plan.thickness_std,
        "std_frames_um": plan.thickness_std_frames,
        "frames_needed": plan.frames_needed,
        "optimum_ratio": plan.optimum_ratio,
        "optimum_std_um": plan.optimum_thickness_std,
        "optimum_std_frames_um": plan.optimum_thickness_std_frames,
        "optimum_frames_needed": plan.optimum_frames_needed,
    }
    values = np.stack([column.values for column in columns.values()], axis=1)
    lines = [",".join(f"{value:.6g}" for value in row) for row in values]
    return "\n".join([",".join(columns), *lines]) + "\n"


def table_of_tolerances(plan: xr.Dataset) -> str:
    """Write the tolerances of a plan as CSV.

    Parameters
    ----------
    plan : xarray.Dataset
        From `erlif.plan`.

    Returns
    -------
    str
        One line for each tolerance, the largest effect first.

    Examples
    --------
    >>> from erlif.show.plots import example_plan_results
    >>> table_of_tolerances(example_plan_results()).splitlines()[0].split(",")[:2]
    ['tolerance', 'size']
    """
    lines = ["tolerance,size,std_change,thinnest_change_um,thickest_change_um,film_error"]
    for k in range(plan.sizes["tolerance"]):
        row = plan.isel(tolerance=k)
        numbers = (
            float(row[f"tolerance_{name}"]) for name in ("std", "thinnest", "thickest", "film")
        )
        named = f"{row.tolerance.item()},{row.tolerance_size.item()}"
        lines.append(f"{named},{','.join(f'{number:.4g}' for number in numbers)}")
    return "\n".join(lines) + "\n"


def check_plan_output(output: Path, *, overwrite: bool, source: Path | None = None) -> None:
    """Refuse a directory that exists, or that holds something else than the results of a plan.

    Parameters
    ----------
    output : Path
        Directory to be written.
    overwrite : bool
        Allow to replace an earlier plan.
    source : Path, optional
        The plan that is read, which is not replaced.

    Raises
    ------
    OutputError
        If the directory may not be replaced.

    Examples
    --------
    >>> check_plan_output(Path("no such directory"), overwrite=False)
    """
    if output.name in ("", ".."):
        raise OutputError(
            f"Expected the name of a directory to be made; got {output}. Give its name with -o."
        )
    if not output.exists():
        return
    if source is not None and output.resolve() in (source.resolve(), source.resolve().parent):
        raise OutputError(
            f"Expected a directory other than that of {source.name}, which would be replaced with "
            f"it; got {output}. Give another name with -o."
        )
    if not overwrite:
        raise OutputError(
            f"{output} exists already; use --overwrite to replace it, or give another name with -o."
        )
    names = {path.name for path in output.iterdir()} if output.is_dir() else {output.name}
    if names - set(WRITTEN):
        raise OutputError(
            f"Expected {output} to be the directory of an earlier plan; it holds "
            f"{min(names - set(WRITTEN))}, which --overwrite does not replace. Give another name "
            "with -o."
        )


def write_plan(
    plan: xr.Dataset, output: Path, *, folder: Path | None = None, overwrite: bool = False
) -> list[Path]:
    """Write figure, tables, the plan and the plan with the best concentrations.

    Parameters
    ----------
    plan : xarray.Dataset
        From `erlif.plan`.
    output : Path
        Directory; it takes its name when all files are complete.
    folder : Path, optional
        Directory from which the plan names its files of spectra; they are named from `output` in
        the plans that are written. Default: the working directory.
    overwrite : bool
        Replace an earlier plan.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    OutputError
        If the directory exists or cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.show.plots import example_plan_results
    >>> with TemporaryDirectory() as directory:
    ...     paths = write_plan(example_plan_results(), Path(directory, "plan"))
    >>> [path.name for path in paths][-1]
    'optimum.toml'
    """
    from erlif.show.plots import plan_figure, save_figure  # matplotlib is loaded for a figure alone

    check_plan_output(output, overwrite=overwrite)
    figure = plan_figure(plan)
    texts = {
        "films.csv": table_of_films(plan),
        "tolerances.csv": table_of_tolerances(plan),
        "plan.toml": _renamed(plan.attrs["settings"], folder, output),
        "optimum.toml": _renamed(plan.attrs["optimum_settings"], folder, output),
    }
    with replacing(output) as scratch:
        scratch.mkdir()
        for kind in ("png", "pdf"):
            save_figure(figure, scratch / f"plan.{kind}")
        for name, text in texts.items():
            (scratch / name).write_text(text, encoding="utf-8")
    return [output / name for name in WRITTEN]


def _renamed(text: str, folder: Path | None, output: Path) -> str:
    """A plan whose files of spectra are named from the directory it is written to."""
    from erlif.planning.plan import moved_settings  # the fit of the calibration is behind it

    settings = PlanSettings.model_validate(tomllib.loads(text))
    return to_toml(moved_settings(settings, folder or Path(), output))
