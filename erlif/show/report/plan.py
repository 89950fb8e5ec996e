"""The plan of a rig in sentences and in a table of films."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.core.errors import OutputError
from erlif.core.units import count_of
from erlif.io.conversion import table_csv
from erlif.io.files import refuse_existing, replacing_set
from erlif.io.settings import PlanSettings, to_toml
from erlif.show.report.layout import TABLES, print_columns, render_text
from erlif.show.report.remedies import print_remedies

# Files of a plan's directory.
WRITTEN = ("plan.png", "plan.pdf", "films.csv", "tolerances.csv", "plan.toml", "optimum.toml")

# Reabsorption over absorption from which on a system counts as optically thick: half a decade
# around 1, as the source states an order of magnitude.
ORDER_OF_ONE = 1 / 3

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
    first, last = plan.film_range.values
    share = float(plan.reabsorption / plan.absorption)
    fluence = float(plan.attrs.get("pulse_fluence", 0.0))
    saturation = float(plan.attrs.get("saturation_fluence", math.inf))
    limited = plan.attrs["optimum_limited_by_solubility"]
    return render_text(
        "plan.txt",
        plan=plan,
        zip=zip,
        first=first,
        last=last,
        frames=int(plan.attrs["frames"]),
        average=int(plan.attrs["average"]),
        share=share,
        thick=share >= ORDER_OF_ONE,
        absorbed=-math.expm1(-float(plan.absorption) * float(last)),
        # the most demanding film of the wanted range decides
        needed=_most_frames(plan.frames_needed, plan),
        best_needed=_most_frames(plan.optimum_frames_needed, plan),
        pairs=lambda count: count_of(round(count), "frame pair"),
        insoluble=[f"dye {n} at its solubility" for n, hit in enumerate(limited, 1) if hit],
        percent=_percent,
        meaningless=_MEANINGLESS,
        nearly_all=_NEARLY_ALL,
        saturated=_saturated(plan),
        fluence=fluence,
        saturation=saturation,
        bleached=fluence > _FAR_BELOW * saturation,
        films=_film_table(plan),
        tolerances=_tolerance_table(plan),
        limit=_limit_table(plan),
        gap="limit_std_gap" in plan,
        remedies=print_remedies(plan.target_std, "the middle of the wanted range"),
    )


def _saturated(plan: xr.Dataset) -> list[tuple[int, float, float]]:
    """Camera, signal of the thickest film and full scale, where it is exceeded. [electron]"""
    # the signal rises with the film, so that the thickest one decides
    wanted = plan.signal.interp(thickness=plan.film_range.values[1]).values.tolist()
    scales = zip(wanted, plan.full_scale.values.tolist(), strict=True)
    return [(n, signal, full) for n, (signal, full) in enumerate(scales, 1) if signal > full]


def _most_frames(needed: xr.DataArray, plan: xr.Dataset) -> float:
    """Frames that the most demanding film of the wanted range needs."""
    first, last = plan.film_range.values
    inside = (plan.thickness >= first) & (plan.thickness <= last)
    return float(needed.where(inside).max())


def _percent(share: float, sign: str = "", most: str = "more than 1000%") -> str:
    """A share in per cent; beyond ten times the film it has no meaning, and NaN is a dash."""
    if math.isnan(share):
        return "-"
    return most if abs(share) > _MEANINGLESS else f"{share:{sign}.1%}"


def _film_table(plan: xr.Dataset) -> str:
    frames, average = int(plan.attrs["frames"]), int(plan.attrs["average"])
    how = count_of(frames, "frame") + (f", {average} px" if average > 1 else "")
    head = ("film um", "ratio", "signal 1", "signal 2", "std um", "of film", how)
    first, last = plan.film_range.values
    rows = plan.interp(thickness=np.geomspace(first, last, _ROWS))
    # frames are whole numbers, which are not interpolated
    near = plan.sel(thickness=rows.thickness, method="nearest")

    lines: list[tuple[str, ...]] = [(*head, "needed", "best")]
    for k, film in enumerate(rows.thickness.values.tolist()):
        one = rows.isel(thickness=k)
        stds = [float(one.thickness_std), float(one.thickness_std_frames)]
        std, averaged = (f"{std:.3g}" if std < _MEANINGLESS * film else "-" for std in stds)
        share = _percent(stds[0] / film, most="> 1000%")
        signals = (f"{signal:.0f}" for signal in one.signal.values)
        counts = (float(near.frames_needed[k]), float(near.optimum_frames_needed[k]))
        needed = (f"{count:.0f}" if math.isfinite(count) else "never" for count in counts)
        ratio = f"{float(one.ratio):.4f}"
        lines.append((f"{film:.3g}", ratio, *signals, std, share, averaged, *needed))
    return print_columns(lines, ">>>>>>>>>")


def _limit_table(plan: xr.Dataset) -> str:
    kinds = ["", "_gap"] if "limit_std_gap" in plan else [""]
    lines = [("no frame shows", "width", "with the gap")[: 1 + len(kinds)]]
    for k, term in enumerate(plan.limit.values.tolist()):
        shares = (f"{100 * float(plan[f'limit_std{kind}'][k]):.2f} %" for kind in kinds)
        lines.append((term, *shares))
    for k, film in enumerate(plan.limit_film.values.tolist()):
        stds = (f"{1e3 * float(plan[f'limit_film_std{kind}'][k]):.0f} nm" for kind in kinds)
        lines.append((f"film of {film:g} um", *stds))
    return print_columns(lines, "<>>")


def _tolerance_table(plan: xr.Dataset) -> str:
    lines = [("tolerance", "size", "std", "thinnest", "thickest", "film")]
    for k in range(plan.sizes["tolerance"]):
        row = plan.isel(tolerance=k)
        ends = float(row.tolerance_thinnest), float(row.tolerance_thickest)
        thinnest, thickest = (
            f"{round(end, 2) + 0.0:+.2f}" if math.isfinite(end) else "-" for end in ends
        )
        std = _percent(float(row.tolerance_std), "+", most="> 1000%")
        film = _percent(float(row.tolerance_film), most="> 1000%")
        named = str(row.tolerance.item()), str(row.tolerance_size.item())
        lines.append((*named, std, thinnest, thickest, film))
    return print_columns(lines, "<>>>>>")


def table_of_films(plan: xr.Dataset) -> str:
    """Write the curves of a plan as CSV: one line for each thickness, units in the header."""
    return _write_columns(plan, "films", digits=6)


def table_of_tolerances(plan: xr.Dataset) -> str:
    """Write the tolerances of a plan as CSV: one line for each, the largest effect first."""
    return _write_columns(plan, "tolerances", digits=4)


def _write_columns(plan: xr.Dataset, table: str, *, digits: int) -> str:
    """Variables of a plan as CSV, by the table that names their columns."""
    columns = {}
    for title, variable in TABLES[table].items():
        name, _, camera = variable.partition(" ")
        column = plan[name].sel(camera=int(camera)) if camera else plan[name]
        columns[title] = column.values
    return table_csv(columns, digits=digits, missing="nan")


def check_plan_output(output: Path, *, overwrite: bool, source: Path | None = None) -> None:
    """Refuse a directory that holds results of a plan, or files of their names.

    Parameters
    ----------
    output : Path
        Directory to be written; other files in it stay.
    overwrite : bool
        Allow to replace an earlier plan.
    source : Path, optional
        The plan that is read, which is not replaced.

    Raises
    ------
    OutputError
        If a file may not be replaced.

    Examples
    --------
    >>> check_plan_output(Path("no such directory"), overwrite=False)
    """
    for name in WRITTEN:
        refuse_existing(output / name, overwrite=overwrite)
        if source is not None and (output / name).resolve() == source.resolve():
            raise OutputError(
                f"Expected a directory other than that of {name}, which would be replaced; got "
                f"{output}. Give another name with -o."
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
        Directory; the files take their names when all are complete.
    folder : Path, optional
        Directory from which the plan names its files of spectra; they are named from `output` in
        the plans that are written. Default: the working directory.
    overwrite : bool
        Replace an earlier plan; refusals are those of `check_plan_output`.

    Returns
    -------
    list of Path
        The files.

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
    texts = {
        "films.csv": table_of_films(plan),
        "tolerances.csv": table_of_tolerances(plan),
        "plan.toml": _renamed(plan.attrs["settings"], folder, output),
        "optimum.toml": _renamed(plan.attrs["optimum_settings"], folder, output),
    }
    with replacing_set(output, WRITTEN) as scratch:
        figure = plan_figure(plan)
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
