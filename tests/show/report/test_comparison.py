"""The table of pairs of runs, as CSV and as a page."""

import csv

import numpy as np
import pytest

from erlif.review.comparison import compare, describe_comparison
from erlif.show.plots import example_film, write_comparison_figures
from erlif.show.report import write_comparison_page, write_pair_table


@pytest.fixture(scope="module")
def films():
    """The example, and one 0.5 um thicker."""
    film = example_film()
    thicker = {name: film[name] + np.float32(0.5) for name in ("film_min", "film_mean")}
    return film, film.assign(thicker).assign_attrs(input_hashes='{"camera1/*.tif": "b"}')


def test_tables_hold_every_pair_and_escape_names(films, tmp_path):
    film, other = films
    named = film.attrs["settings"].replace('name = "example"', 'name = "<b>one</b>, two"')
    found = compare([film, other, film.assign_attrs(settings=named)])
    write_pair_table(found, tmp_path / "a.csv")
    with (tmp_path / "a.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 6
    assert rows[-1]["second"] == "<b>one</b>, two"
    assert float(rows[0]["difference [um]"]) == 0.5
    figures = write_comparison_figures(found, tmp_path)
    write_comparison_page(found, tmp_path / "a.html", figures)
    page = (tmp_path / "a.html").read_text("utf-8")
    assert "<b>one" not in page
    assert "&lt;b&gt;one" in page
    assert "the second run less the first" in page
    assert '<td class="n">below 1e-12</td>' in page
    assert page.count("data:image/png") == len(figures) == 2
    assert page.count("<li>") >= len(describe_comparison(found))
    assert page.count("<ul><li>") >= 3  # powers and differences stand below what they are
    assert ">nan<" not in page
