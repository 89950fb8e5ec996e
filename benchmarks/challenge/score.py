"""Score submissions to the ERLIF challenge against the truth, with numpy and h5py alone.

``python benchmarks/challenge/score.py TRUTH SUBMISSION...``: the folder of the truth, and a folder
for each method with a file NAME.h5 (or .nc) for each rig. docs/challenge.md has the rules.

Judged are the pixels of the region whose film is above three standard deviations of their photon
noise and that a bubble does not hide. A value is false where a bubble hides the film, or where it
is off by more than 20 % of the film and five such standard deviations.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import h5py
import numpy as np

COLUMNS = {
    "bias": "bias, %",
    "scatter": "scatter / limit",
    "within_68": "within 68 %",
    "within_95": "within 95 %",
    "measured": "measured, %",
    "false": "false, %",
    "exponent": "exponent off by",
    "minimum": "minimum, %",
    "seconds": "time, s",
}
IDEAL = {"scatter": 0.0, "within_68": 68.3, "within_95": 95.0, "measured": 100.0}
"""What is best of a column, where it is not zero."""
DIGITS = {"scatter": 2, "exponent": 3, "bias": 2, "false": 2, "minimum": 2}
NAN = float("nan")
TO_STD = 1.4826  # of normal errors, from the median of their sizes


def read(path: Path) -> dict:
    """Datasets and attributes of one file."""
    with h5py.File(path, "r") as file:
        arrays = {
            key: np.asarray(file[key][()]) for key in file if isinstance(file[key], h5py.Dataset)
        }
        return {key: np.squeeze(value) for key, value in file.attrs.items()} | arrays


def rms(values: np.ndarray) -> float:
    """Root mean square of what is finite; NaN of nothing."""
    values = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(np.square(values)))) if values.size else NAN


def score_maps(film: np.ndarray, limit: np.ndarray, found: np.ndarray) -> tuple[float, float]:
    """Rms over the maps of the median error [%], and scatter about it over the limit [1]."""
    medians, scatter = [], []
    for true, width, value in zip(film, limit, found, strict=True):
        given = np.isfinite(value)
        if given.sum() < 50:  # the median of fewer pixels is noise
            continue
        error = value[given] - true[given]
        medians.append(100 * np.median(error / true[given]))
        scatter.append((error - np.median(error)) / width[given])
    if not medians:
        return NAN, NAN
    return rms(np.array(medians)), TO_STD * float(np.median(np.abs(np.concatenate(scatter))))


def score_rig(truth: dict, submission: dict) -> dict[str, float]:
    """All columns of one rig."""
    film, limit = truth["film"].astype(float), truth["limit"].astype(float)
    found = np.asarray(submission["thickness"], float)
    if found.shape != film.shape:
        raise SystemExit(f"Expected maps of {film.shape}, got {found.shape}. One for each trigger.")
    scores = dict.fromkeys(COLUMNS, NAN)

    inside = np.broadcast_to(truth["region"].astype(bool), film.shape)
    judged = inside & (film > 3 * limit)  # a limit of NaN is a bubble
    given, error = np.isfinite(found), np.abs(found - film)
    wrong = ~np.isfinite(limit) | (error > np.maximum(0.2 * film, 5 * limit))
    scores["bias"], scores["scatter"] = score_maps(film, limit, np.where(judged, found, NAN))
    scores["measured"] = 100 * (given & judged).sum() / judged.sum()
    scores["false"] = 100 * (given & inside & wrong).sum() / max((given & inside).sum(), 1)

    if "std" in submission:
        std = np.asarray(submission["std"], float)
        with_bar = given & judged & np.isfinite(std)
        pull = (error[with_bar] / std[with_bar]) if with_bar.any() else np.array([NAN])
        scores["within_68"], scores["within_95"] = (100 * np.mean(pull <= k) for k in (1, 1.96))
    if "minimum" in submission:
        minimum = np.asarray(submission["minimum"], float)
        scores["minimum"] = 100 * rms(minimum / truth["minimum"] - 1)
    if "exponent" in submission:
        scores["exponent"] = float(submission["exponent"] - truth["exponent"])
    scores["seconds"] = float(submission.get("seconds", NAN))
    return scores


def write_cell(key: str, value: float, rivals: list[float]) -> str:
    """A number of a column, in bold where it is the best of its rig."""
    if not np.isfinite(value):
        return "–"
    text, ideal = f"{value:.{DIGITS.get(key, 1)}f}", IDEAL.get(key, 0.0)
    best = len(rivals) > 1 and abs(value - ideal) <= np.nanmin(np.abs(np.array(rivals) - ideal))
    return f"**{text}**" if best else text


def write_rows(scores: dict[tuple[str, str], dict[str, float]]) -> list[str]:
    """A row for each rig and method."""
    rows = []
    for (rig, method), found in scores.items():
        rivals = [other for (of, _), other in scores.items() if of == rig]
        cells = [
            write_cell(key, value, [other[key] for other in rivals]) for key, value in found.items()
        ]
        rows.append(f"| {rig} | {method} | {' | '.join(cells)} |")
    return rows


def average(
    scores: dict[tuple[str, str], dict[str, float]],
) -> dict[tuple[str, str], dict[str, float]]:
    """Median of each column over the rigs of a method; of shares of errors the mean."""
    means = {}
    for method in dict.fromkeys(method for _, method in scores):
        of = [found for (_, name), found in scores.items() if name == method]
        columns = {key: np.abs([s[key] for s in of]) for key in COLUMNS}
        columns = {key: values[np.isfinite(values)] for key, values in columns.items()}
        means["all", method] = {
            key: float((np.mean if key in IDEAL else np.median)(values)) if values.size else NAN
            for key, values in columns.items()
        }
    return means


def tabulate(truth: Path, submissions: Sequence[Path]) -> str:
    """The table over all rigs that have a submission, and that of each rig."""
    scores = {}
    for path in sorted(truth.glob("*.h5")):
        for folder in submissions:
            files = [folder / f"{path.stem}{kind}" for kind in (".h5", ".nc")]
            for file in (file for file in files if file.exists()):
                scores[path.stem, folder.name] = score_rig(read(path), read(file))
    head = f"| rig | method | {' | '.join(COLUMNS.values())} |"
    rule = f"|---|---|{'---:|' * len(COLUMNS)}"
    return "\n".join(
        [head, rule, *write_rows(average(scores)), "", head, rule, *write_rows(scores)]
    )


if __name__ == "__main__":
    print(tabulate(Path(sys.argv[1]), [Path(folder) for folder in sys.argv[2:]]))
