"""Renew the tables of errors: ``python docs/make_budget.py``.

In docs/uncertainty.md the budget of the sample run, in docs/limits.md the errors that frames do not
show, the remedies and their list for a rig that states nothing. Tests hold the first two tables and
the remedies to what erlif computes.
"""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import erlif
from erlif.calibration import NO_SYSTEMATICS, Systematics
from erlif.commands.lines import wrap
from erlif.core.remedies import REMEDIES
from erlif.core.terms import SOURCES, TERMS
from erlif.rig import RigSettings, simulate
from erlif.show.report import print_budget
from erlif.show.report.remedies import print_remedies

ROOT = Path(__file__).parents[1]
FILMS = (1.0, 3.0, 6.0, 10.0)
"""Films of the table of limits. [um]"""
MEDIAN = 6.0
"""Median film of its run. [um]"""
STEEPNESS = 17.9 / 19.14
"""Rise of the wedge, by its profile. [um/mm]"""


def limits() -> str:
    """The table of docs/limits.md."""
    calibration = replace(
        erlif.calibrate(ROOT / "calibration" / "wedge"), systematics=NO_SYSTEMATICS
    )
    one = float(calibration.model.light(MEDIAN).signal)
    light = one, one * float(calibration.predict(MEDIAN))
    widths = {key: (term.width or 0.0) / 100 for key, term in TERMS.items() if term.file}
    widths["position"] = 0.06 * STEEPNESS
    parameters = len(calibration.full_covariance)
    whole = replace(
        calibration, systematics=Systematics.of(widths, parameters=parameters, light=light)
    )
    split = [whole.split_error(whole.film_gradient(film), anywhere=True) for film in FILMS]

    rows = []
    for term in ("calibration", *TERMS):
        if term not in split[0]:  # two fixtures have it
            continue
        source = SOURCES[term]
        sizes = " | ".join(f"{1e3 * each[term]:.0f}" for each in split)
        default = "one pixel" if term == "position" else ""
        default = default if source.width is None else f"{source.width:g} %"
        rows.append(f"| `{term}`: {source.what} | {default} | {sizes} | {source.cure} |\n")
    total = " | ".join(f"**{1e3 * float(whole.thickness_std(film)):.0f}**" for film in FILMS)
    head = (
        "| key | default | 1 um | 3 um | 6 um | 10 um | what removes it |\n"
        "|---|---|---:|---:|---:|---:|---|\n"
    )
    return head + "".join(rows) + f"| **all** | | {total} | |\n"


def remedies() -> str:
    """The remedies of docs/limits.md."""
    rows = [f"| `{key}`: {remedy.what} | {remedy.why} |\n" for key, remedy in REMEDIES.items()]
    return "| remedy | how it enters, and what it leaves |\n|---|---|\n" + "".join(rows)


def list_of_means() -> str:
    """The list for 1 % of the film of a virtual rig that states nothing."""
    with tempfile.TemporaryDirectory() as scratch:
        rig = RigSettings(width=128, height=96, spacing=4.0, fixture_frames=3, bubbles=0)
        simulate(Path(scratch) / "rig", seed=1, rig=replace(rig, write_systematics=False))
        budget = erlif.budget(Path(scratch) / "rig" / "run", target="1 %")
    text = wrap(print_remedies(budget.target_std, "the median film of the run"))
    return f"```text\n{text}\n```\n"


def renew(page: str, name: str, table: str) -> None:
    """Replace the table between the marks of a page."""
    path, begin, end = ROOT / "docs" / page, f"<!-- {name} -->\n", f"<!-- end of {name} -->"
    before, rest = path.read_text(encoding="utf-8").split(begin)
    _, after = rest.split(end)
    path.write_text(before + begin + table + end + after, encoding="utf-8")


def main() -> None:
    """Renew all tables."""
    budget = erlif.budget(ROOT / "data_samples" / "straight_bushing")
    renew("uncertainty.md", "budget", f"```text\n{print_budget(budget)}\n```\n")
    renew("limits.md", "limits", limits())
    renew("limits.md", "list of remedies", remedies())
    renew("limits.md", "remedies", list_of_means())


if __name__ == "__main__":
    main()
