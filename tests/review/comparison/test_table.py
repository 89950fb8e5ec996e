"""A comparison in words."""

import json
from dataclasses import replace

import numpy as np
import pytest

from erlif.calibration import save_calibration
from erlif.review.comparison import compare, describe_comparison
from erlif.show.plots import example_calibration


def same(film, other):
    return film


def dark(film, other):
    return other.assign({name: other[name] * np.nan for name in ("film_min", "film_mean")})


def whole(film, other):
    """The region of interest is the whole image."""
    text = other.attrs["settings"]
    start = text.index("[thickness.roi]")
    return other.assign_attrs(settings=text[:start] + text[text.index("\n[", start) :])


@pytest.mark.parametrize(
    ("second", "words"),
    [
        (
            lambda film, other: other,
            (
                "minimum film +0.500 ± ",
                "all runs together: minimum film n = ",
                "conclusion: example (1) and example (2) differ in minimum film and mean film",
            ),
        ),
        (same, ("conclusion: no two runs differ", "no difference found (one of 0.0")),
        (dark, ("conclusion: no runs could be compared",)),
        (whole, ("regions of the film statistics differ",)),
    ],
)
def test_the_conclusion_states_what_differs_or_could_be_found(film, other, second, words):
    text = "\n".join(describe_comparison(compare([film, second(film, other)])))
    assert all(word in text for word in words)
    assert ("regions" in text) == (second is whole)


@pytest.mark.parametrize(
    ("numbers", "day", "words"),
    [
        (["", ""], "", "one rig, serial numbers of the cameras unknown, days unknown"),
        (["11", "12"], "2026-05-02", "one rig, cameras 11, 12, of 2026-05-02"),
        (["11", "13"], "2026-05-02", "two rigs by serial of [camera2]; the errors of both add"),
    ],
)
def test_the_text_states_what_makes_one_rig(film, other, numbers, day, words):
    first = {"camera_serials": '["11", "12"]', "recorded": day} if day else {}
    second = {"camera_serials": json.dumps(numbers), "recorded": day} if day else {}
    found = compare([film.assign_attrs(first), other.assign_attrs(second)])
    assert f"  example (2) and example (1): {words}" in describe_comparison(found)


def test_calibrations_of_other_days_show_how_the_ratio_changes(film, other, tmp_path):
    """Four percent between two calibrations, known to 0.5 %; without them 0.3 % holds."""
    first = example_calibration()
    later = replace(first, ratio_at_zero=1.04 * first.ratio_at_zero, date="2026-12-01")
    save_calibration(later, tmp_path / "later.nc")
    runs = [
        one.assign_attrs(recorded=day) for one, day in ((film, "2026-05-02"), (other, "2026-11-30"))
    ]
    for files, words in (([], "0.3 % (assumed"), ([tmp_path / "later.nc"], " % (by its calib")):
        found = compare(runs, calibrations=files)
        (line,) = (one for one in describe_comparison(found) if "one rig" in one)
        assert "of 2026-11-30 and 2026-05-02; change of the ratio" in line
        assert words in line
        assert found.calibration_drift == pytest.approx(np.log(1.04) if files else 0.0, abs=1e-3)


def test_charts_name_the_runs_beyond_their_limits_and_judge_the_calibrations(film, other, tmp_path):
    first = example_calibration()
    later = replace(first, ratio_at_zero=1.05 * first.ratio_at_zero, date="2026-12-01")
    save_calibration(later, tmp_path / "later.nc")
    found = compare([film, other], calibrations=[tmp_path / "later.nc"])
    chart = {"patch_ratio": ("run", [1.0, 1.1]), "patch_centre": 1.0, "patch_limit": 0.01}
    text = "\n".join(describe_comparison(found.assign(chart)))
    assert "reference patch: beyond the limits: example (2)" in text
    assert "calibration of 2026-12-01: drifted from" in text
    steady = found.assign(chart | {"patch_ratio": ("run", [1.0, 1.0])})
    assert "all runs within the limits" in "\n".join(describe_comparison(steady))
