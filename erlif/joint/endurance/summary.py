"""An endurance test in sentences and as a row of a table."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from erlif.core.arrays import AnyArray
from erlif.core.units import count_of
from erlif.io.files import replacing
from erlif.joint.endurance.analysis import EnduranceResult
from erlif.joint.endurance.comparison import DesignComparison
from erlif.joint.endurance.onset import FEWEST
from erlif.joint.endurance.other_sensors import SensorChange
from erlif.joint.endurance.posterior import Onset
from erlif.joint.friction.coefficient import doubt_friction

HEADINGS = (
    "test",
    "stages",
    "failed",
    "load at failure [N]",
    "std [N]",
    "survived [N]",
    "stage",
    "onset [s]",
    "earliest [s]",
    "latest [s]",
    "friction before",
    "rise",
    "rise std",
    "p-value",
    "p-value of temperature",
    "p-value of vibration",
)
"""Headings of the table of tests."""

_NO_CHANCE = 1e-12  # probabilities below it depend on tails that nobody has measured


def describe_test(found: EnduranceResult) -> list[str]:
    """Describe an endurance test in lines of text.

    Parameters
    ----------
    found : EnduranceResult
        From `erlif.analyse_endurance`.

    Returns
    -------
    list of str

    Examples
    --------
    >>> from erlif.show.plots.example import example_test
    >>> print(describe_test(example_test())[0])
    example: 6 stages and 6 idle runs in 4424 s
    """
    test, failure = found.test, found.failure
    last = float(test["time"][-1])
    idle = sum(stage.is_idle and stage.part == 1 for stage in found.stages)
    lines = [
        f"{found.name}: {count_of(len(found.whole), 'stage')} and {count_of(idle, 'idle run')} in "
        f"{last - float(test['time'][0]):.0f} s"
    ]
    level = float(test["friction"][_samples_of(found)].median())
    lines += doubt_friction(level, radius=test.attrs.get("pin_radius"), arm=test.attrs.get("arm"))
    divided = {stage.number for stage in found.loaded if stage.part > 1}
    for stage in found.loaded:
        friction = float(test["friction"][stage.samples].median())
        part = f", part {stage.part}" if stage.number in divided else ""
        line = (
            f"  stage {stage.number}{part}: {stage.load / 1e3:.1f} kN, {stage.start:.0f} to "
            f"{stage.end:.0f} s, friction {friction:.3f}"
        )
        if "temperature" in test:
            line += f", {float(test['temperature'][stage.last]):.1f} degC at its end"
        lines.append(line)

    for before, after in pairwise(found.loaded):
        if after.part > 1:
            lines.append(
                f"note: the log pauses from {before.end:.0f} to {after.start:.0f} s, within stage "
                f"{after.number}"
            )
    if "period" in test.attrs:
        lines.append(
            f"note: the torque reverses with a period of {test.attrs['period']:.3g} s; friction is "
            "half the difference of its directions over two periods. erlif friction gives it for "
            "each reversal"
        )
    lines += [f"{note.level}: {note}" for note in found.notes]
    lines += [
        f"note: the {name} {reason}; it is left out" for name, reason in found.unusable.items()
    ]
    for place in found.search.left_out:
        stage = found.whole[place]
        needed = FEWEST * sum(part.number == stage.number for part in found.loaded)
        lines.append(
            f"note: stage {stage.number} has {stage.last - stage.first + 1} samples and was not "
            f"searched for galling; {needed} are needed"
        )
    chance = found.search.p_value
    p = "p below 1e-12" if chance < _NO_CHANCE else f"p = {chance:.2g}"
    onset = found.onset
    if onset is None:
        lines += _describe_no_galling(found, p)
        if failure.decided:
            lines.append(f"load survived: {failure.load / 1e3:.1f} kN")
        else:
            lines.append(
                f"not decided whether it survived: carried {failure.load / 1e3:.1f} kN, and is "
                "compared as a bearing that carries at least that"
            )
        return lines
    into = onset.time - found.whole[onset.stage].start
    since = "" if onset.pause else f", {into:.0f} s into it"
    lines.append(f"galling in stage {failure.stage} {_describe_time(onset)}{since}; {p}")
    lines.append(_describe_rise(onset))
    lines += [_describe_sensor(sensor) for sensor in found.other_sensors]
    lines.append(
        f"load at failure: {failure.load / 1e3:.2f} ± {failure.std / 1e3:.2f} kN; "
        f"{failure.survived / 1e3:.1f} kN were survived"
    )
    share = found.calibration * failure.load / 1e3
    lines.append(
        f"  of this, {share:.2f} kN is the calibration of the cells, "
        f"{100 * found.calibration:.2g} % of the load (load_error of the settings)"
    )
    return lines


def _samples_of(found: EnduranceResult) -> AnyArray:
    """Places of the samples under load."""
    return np.concatenate([np.arange(one.first, one.last + 1) for one in found.loaded])


def _describe_no_galling(found: EnduranceResult, p: str) -> list[str]:
    """That there is no galling, and which rise there is that is too small."""
    small, least = found.search.small, found.search.least_rise
    if small is None:
        what = "galling" if found.failure.decided else "sudden rise of friction within a stage"
        return [f"no {what} found ({p})"]
    stage = found.whole[small.stage]
    return [
        f"no galling found: in stage {stage.number} friction rises {_describe_time(small)} by "
        f"{small.rise:.3f} ± {small.rise_std:.3f}, which is significant ({p}), but below the least "
        f"rise of {least:g} that counts",
        f"  a smaller rise counts with --least-rise {_next_below(small.rise):g}, or least_rise "
        "under [galling] of the settings",
    ]


def _next_below(rise: float) -> float:
    """A round number below a rise, with one digit."""
    unit = 10.0 ** np.floor(np.log10(rise))
    return float(np.floor(rise / unit) * unit)


def _describe_time(onset: Onset) -> str:
    """When it begins: a pause of the log hides it."""
    if onset.pause is not None:
        return (
            f"between {onset.earliest:.1f} and {onset.latest:.1f} s (95 %), an interval with a "
            "pause of the log"
        )
    return f"at {onset.time:.1f} s (95 %: {onset.earliest:.1f} to {onset.latest:.1f} s)"


def _describe_rise(onset: Onset) -> str:
    after = onset.friction_before + onset.rise
    return (
        f"friction: {onset.friction_before:.3f} to {after:.3f}, a rise of {onset.rise:.3f} ± "
        f"{onset.rise_std:.3f}"
    )


def _describe_sensor(sensor: SensorChange) -> str:
    verdict = "confirms it" if sensor.confirms else "does not confirm it"
    span = f"{sensor.low:.2f} to {sensor.high:.2f}"
    if sensor.name == "temperature":
        what = f"temperature: slope {sensor.change:+.2f} K/min more from the onset on ({span})"
    else:
        what = f"vibration: {sensor.change:.2f} times the level before ({span})"
    return f"{what}, p = {sensor.p_value:.2g}: {verdict}"


def describe_designs(found: DesignComparison) -> list[str]:
    """Describe the comparison of two designs in lines of text.

    Parameters
    ----------
    found : DesignComparison
        From `erlif.compare_designs`.

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
    lines = [
        f"{name}: {count_of(runs, 'run')}, {count_of(failures, 'failure')}"
        for name, runs, failures in zip(
            (found.first, found.second), found.runs, found.failures, strict=True
        )
    ]
    if found.ratio == found.ratio:
        lines.append(
            f"load at failure of {found.second} over {found.first}: {found.ratio:.2f} (95 %: "
            f"{found.low:.2f} to {found.high:.2f}, {found.model}); {found.second} carries more "
            f"with a probability of {found.probability:.3g}"
        )
    else:
        lines.append("no ratio of the loads: it needs a failure of each design")
    lines.append(
        f"log-rank test by permutation: p = {found.log_rank:.2g} (so few runs give "
        f"{found.least_p:.2g} at least)"
    )
    return lines


def write_test_table(found: Sequence[EnduranceResult], output: Path) -> Path:
    """Write one row for each test as CSV.

    Parameters
    ----------
    found : sequence of EnduranceResult
    output : Path

    Returns
    -------
    Path
        `output`.

    Raises
    ------
    OutputError
        If it cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from erlif.show.plots.example import example_test
    >>> path = Path(tempfile.mkdtemp(), "endurance.csv")
    >>> write_test_table([example_test()], path).read_text().splitlines()[1][:12]
    'example,6,1,'
    """
    with replacing(output) as scratch, scratch.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(HEADINGS)
        writer.writerows(_row(one) for one in found)
    return output


def _row(found: EnduranceResult) -> list[str]:
    failure, onset = found.failure, found.onset
    row = [
        found.name,
        str(len(found.loaded)),
        str(int(failure.failed)),
        f"{failure.load:.1f}",
        f"{failure.std:.1f}",
        f"{failure.survived:.1f}",
        str(failure.stage),
    ]
    if onset is None:
        row += [""] * 6
    else:
        row += [f"{value:.2f}" for value in (onset.time, onset.earliest, onset.latest)]
        row += [f"{value:.4f}" for value in (onset.friction_before, onset.rise, onset.rise_std)]
    chances = {sensor.name: f"{sensor.p_value:.3g}" for sensor in found.other_sensors}
    others = [chances.get(name, "") for name in ("temperature", "vibration")]
    return [*row, f"{found.search.p_value:.3g}", *others]
