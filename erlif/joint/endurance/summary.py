"""An endurance test in sentences and as a row of a table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from erlif.core.notes import Level
from erlif.core.tables import fill_template
from erlif.core.units import count_of
from erlif.io.conversion import table_csv
from erlif.io.files import write_file
from erlif.joint.endurance.analysis import EnduranceResult
from erlif.joint.endurance.comparison import DesignComparison
from erlif.joint.endurance.search import FEWEST
from erlif.joint.friction.coefficient import doubt_friction
from erlif.show.report.layout import print_columns

_NO_CHANCE = 1e-12  # probabilities below it depend on tails that nobody has measured

_OF_STAGES = (
    "The load that a bearing carries lies between the load survived and that at failure, a step of "
    "the stages; ± is the calibration of the cells and the scatter of the load alone."
)

# Columns of the table of tests: the part of a test that each is of, and how it is written.
_COLUMNS = {
    "test": ("test", "{}"),
    "stages": ("stages", "{}"),
    "failed": ("failed", "{}"),
    "load at failure [N]": ("failure", "{.load:.1f}"),
    "std [N]": ("failure", "{.std:.1f}"),
    "survived [N]": ("failure", "{.survived:.1f}"),
    "stage": ("failure", "{.stage}"),
    "onset [s]": ("onset", "{.time:.2f}"),
    "earliest [s]": ("onset", "{.earliest:.2f}"),
    "latest [s]": ("onset", "{.latest:.2f}"),
    "friction before [1]": ("onset", "{.friction_before:.4f}"),
    "rise [1]": ("onset", "{.rise:.4f}"),
    "rise std [1]": ("onset", "{.rise_std:.4f}"),
    "p-value [1]": ("friction", "{:.3g}"),
    "p-value of temperature [1]": ("temperature", "{:.3g}"),
    "p-value of vibration [1]": ("vibration", "{:.3g}"),
}


def describe_test(result: EnduranceResult) -> list[str]:
    """Describe an endurance test in lines of text.

    Parameters
    ----------
    result : EnduranceResult
        From `erlif.joint.analyse_endurance`.

    Returns
    -------
    list of str

    Examples
    --------
    >>> from erlif.joint.plots.example import example_test
    >>> print(describe_test(example_test())[0])
    example: 6 stages and 6 idle runs in 4424 s
    """
    test, loaded, search = result.test, result.loaded, result.search
    places = np.concatenate([np.arange(one.first, one.last + 1) for one in loaded])
    level = float(test["friction"][places].median())
    left_out = [result.whole[place] for place in search.left_out]
    text = fill_template(
        "erlif.joint.endurance",
        "test.txt",
        found=result,
        count_of=count_of,
        idle=sum(stage.is_idle and stage.part == 1 for stage in result.stages),
        duration=float(test["time"][-1]) - float(test["time"][0]),
        doubts=doubt_friction(
            level, radius=test.attrs.get("pin_radius"), arm=test.attrs.get("arm")
        ),
        divided={stage.number for stage in loaded if stage.part > 1},
        friction=[float(test["friction"][stage.samples].median()) for stage in loaded],
        temperature=test["temperature"].values.tolist() if "temperature" in test else (),
        before=dict(zip(loaded[1:], loaded[:-1], strict=True)),
        period=test.attrs.get("period"),
        # each part of a stage needs its own samples
        left_out=[
            (stage, FEWEST * sum(part.number == stage.number for part in loaded))
            for stage in left_out
        ],
        print_p=_print_p,
        round_below=_round_below,
    )
    return text.splitlines()


def describe_tests(results: Sequence[EnduranceResult]) -> list[str]:
    """Describe several endurance tests in a row each; their warnings follow.

    Parameters
    ----------
    results : sequence of EnduranceResult

    Returns
    -------
    list of str

    Examples
    --------
    >>> from erlif.joint.plots.example import example_test
    >>> for line in describe_tests([example_test()])[:2]:
    ...     print(line)
    test     galling  onset (95 %)                 load at failure  survived
    example  stage 6  4379.9 s (4377.7 to 4383.1)   123.8 ± 0.6 kN  106.6 kN
    """
    rows: list[tuple[str, ...]] = [
        ("test", "galling", "onset (95 %)", "load at failure", "survived")
    ]
    warnings = []
    for one in results:
        failure, onset = one.failure, one.onset
        cells = ["none" if failure.decided else "unclear", "-", "-"]
        if onset is not None:
            load, std = failure.load / 1e3, failure.std / 1e3
            cells = [
                f"stage {failure.stage}",
                f"{onset.time:.1f} s ({onset.earliest:.1f} to {onset.latest:.1f})",
                f"{load:.1f} ± {std:.1f} kN",
            ]
        survived = failure.survived if failure.failed else failure.load
        rows.append((one.name, *cells, f"{survived / 1e3:.1f} kN"))
        doubts = [note for note in one.notes if note.level is not Level.NOTE]
        warnings += [f"{note.level}: {one.name}: {note}" for note in doubts]
    stated = [_OF_STAGES] if any(one.failure.failed for one in results) else []
    return [*print_columns(rows, "<<<>>").splitlines(), *stated, *warnings]


def _print_p(value: float) -> str:
    """A p-value as it is printed."""
    return "p below 1e-12" if value < _NO_CHANCE else f"p = {value:.2g}"


def _round_below(rise: float) -> float:
    """A round number below a rise, with one digit."""
    unit = 10.0 ** np.floor(np.log10(rise))
    return float(np.floor(rise / unit) * unit)


def describe_designs(found: DesignComparison) -> list[str]:
    """Describe the comparison of two designs in lines of text.

    Parameters
    ----------
    found : DesignComparison
        From `erlif.joint.compare_designs`.

    Returns
    -------
    list of str

    Examples
    --------
    >>> from erlif.joint.endurance import FailureLoad, compare_designs
    >>> low = [FailureLoad(load, 0.0, load - 4, True, 1) for load in (24.0, 28.0, 28.0)]
    >>> high = [FailureLoad(load, 0.0, load - 4, True, 1) for load in (36.0, 36.0, 40.0)]
    >>> print(describe_designs(compare_designs(low, high, names=("uncut", "undercut")))[-1])
    log-rank test by permutation: p = 0.1 (so few runs give 0.1 at least)
    """
    text = fill_template("erlif.joint.endurance", "designs.txt", found=found, count_of=count_of)
    return text.splitlines()


def write_test_table(found: Sequence[EnduranceResult], output: Path) -> Path:
    """Write one row for each test as CSV.

    `output` and what is raised are those of `erlif.joint.friction.write_friction_table`.

    Parameters
    ----------
    found : sequence of EnduranceResult

    Returns
    -------
    Path

    Examples
    --------
    >>> import tempfile
    >>> from erlif.joint.plots.example import example_test
    >>> path = Path(tempfile.mkdtemp(), "endurance.csv")
    >>> write_test_table([example_test()], path).read_text().splitlines()[1][:12]
    'example,6,1,'
    """
    rows = [_row(one) for one in found]
    columns = {title: [row[title] for row in rows] for title in _COLUMNS}
    return write_file(output, table_csv(columns))


def _row(found: EnduranceResult) -> dict[str, str]:
    """Texts of one test by their columns; p-values below 1e-12 are written as that."""
    p_values = {sensor.name: sensor.p_value for sensor in found.other_sensors}
    p_values["friction"] = found.search.p_value
    parts = {
        "test": found.name,
        "stages": len(found.loaded),
        "failed": int(found.failure.failed),
        "failure": found.failure,
        "onset": found.onset,
        **{name: max(value, _NO_CHANCE) for name, value in p_values.items()},
    }
    return {
        title: "" if parts.get(part) is None else form.format(parts[part])
        for title, (part, form) in _COLUMNS.items()
    }
