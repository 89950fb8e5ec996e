"""A comparison in words and tables."""

import csv

import numpy as np

from erlif.review.comparison import compare, describe_comparison, write_pair_table
from erlif.review.comparison.table import pair_rows


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


def test_tables_hold_every_pair_and_escape_names(film, other, tmp_path):
    named = film.attrs["settings"].replace('name = "example"', 'name = "<b>one</b>, two"')
    found = compare([film, other, film.assign_attrs(settings=named)])
    write_pair_table(found, tmp_path / "a.csv")
    with (tmp_path / "a.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(pair_rows(found)) == 6
    assert rows[-1]["second"] == "<b>one</b>, two"
    assert float(rows[0]["difference [um]"]) == 0.5
    write_pair_table(found, tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text()
    assert "<b>one" not in page
    assert "&lt;b&gt;one" in page


def test_page_of_pairs_states_direction_and_bound_of_the_probability(film, other, tmp_path):
    write_pair_table(compare([film, other]), tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text()
    assert "the second run less the first" in page
    assert "<td>below 1e-12</td>" in page
    assert "<td>0</td>" not in page
