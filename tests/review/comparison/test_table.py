"""A comparison in words."""

import numpy as np

from erlif.review.comparison import compare, describe_comparison


def test_the_conclusion_names_the_runs_that_differ(film, other):
    lines = describe_comparison(compare([film, other]))
    assert lines[-1] == (
        "conclusion: example (1) and example (2) differ in minimum film and mean film"
    )
    assert any("minimum film +0.500 ± " in line and line.endswith("differs") for line in lines)
    assert any("all runs together: minimum film n = " in line for line in lines)


def test_without_a_difference_the_size_that_would_be_found_is_stated(film):
    lines = describe_comparison(compare([film, film]))
    assert (
        lines[-1]
        == "conclusion: no two runs differ by more than chance, at 5 % for all 2 tests together"
    )
    assert any("no difference found (one of 0.0" in line for line in lines)


def test_runs_without_a_common_film_are_not_stated_to_agree(film, other):
    dark = other.assign({name: other[name] * np.nan for name in ("film_min", "film_mean")})
    lines = describe_comparison(compare([film, dark]))
    assert lines[-1].startswith("conclusion: no runs could be compared")


def test_regions_that_differ_are_reported(film, other):
    text = other.attrs["settings"]
    start = text.index("[thickness.roi]")
    end = text.index("\n[", start)
    whole = other.assign_attrs(settings=text[:start] + text[end:])
    lines = describe_comparison(compare([film, whole]))
    assert any("regions of the film statistics differ" in line for line in lines)
    assert not any("regions" in line for line in describe_comparison(compare([film, other])))
