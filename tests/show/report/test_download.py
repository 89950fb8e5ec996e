"""The file of the triggers holds the numbers of the film."""

from __future__ import annotations

import base64
import csv
import io

import numpy as np
import numpy.testing as npt
import pytest
from scenes import film as scene

from erlif.show.report.download import download_link, file_name
from erlif.show.report.tables import trigger_table


def saved(page):
    """Name and rows of the file of a page."""
    (link,) = [attrs for attrs in page.all("a") if "download" in attrs]
    head, _, content = link["href"].partition(",")
    assert head == "data:text/csv;charset=utf-8;base64"
    text = base64.b64decode(content).decode("utf-8")
    return link["download"], list(csv.DictReader(io.StringIO(text)))


def test_file_of_the_page_has_the_numbers_of_the_film(page, film):
    name, rows = saved(page)
    assert name == "a_film_known_small_triggers.csv"
    assert [int(row["trigger"]) for row in rows] == list(range(scene.TRIGGERS))
    found = [float(row["crank_angle [degree]"]) for row in rows]
    npt.assert_allclose(found, scene.CRANK, rtol=1e-9)
    for variable in ("film_min", "film_min_std", "film_mean", "load", "rocker_speed"):
        unit = film[variable].attrs["units"]
        found = [float(row[f"{variable} [{unit}]"]) for row in rows]
        npt.assert_allclose(found, film[variable].values, rtol=5e-9)
    shares = (film.flags == 0).mean(("y", "x")).values
    npt.assert_allclose([float(row["valid share [1]"]) for row in rows], shares, rtol=5e-9)


def test_numbers_that_are_not_known_are_nan(changed, read_page):
    changed.film_min.values[2] = np.nan
    _, rows = saved(read_page(trigger_table(changed, np.ones(6))))
    assert rows[2]["film_min [um]"] == "NaN"


def test_file_and_table_of_many_triggers_are_thinned_and_say_so(changed, read_page):
    many = changed[["frames_used", "film_min", "film_min_std"]].isel(
        trigger=np.arange(2000) % scene.TRIGGERS
    )
    many = many.assign_coords(trigger=np.arange(2000)).assign_attrs(changed.attrs)
    page = read_page(trigger_table(many, np.ones(2000), most=20_000))
    _, rows = saved(page)
    numbers = [int(row["trigger"]) for row in rows]
    step = numbers[1]
    assert numbers == list(range(0, 2000, step))
    text = " ".join(page.texts["p"].split())
    assert f"The CSV file holds one of {step}; erlif export writes all." in text
    assert "The table holds one of 4 triggers." in text
    assert len(page.all("tr")) == 501


def test_all_triggers_are_in_the_file_where_the_table_is_thinned(changed, read_page):
    many = changed[["frames_used", "film_min"]].isel(trigger=np.arange(1200) % 6)
    many = many.assign_coords(trigger=np.arange(1200)).assign_attrs(changed.attrs)
    page = read_page(trigger_table(many.drop_vars("film_min"), np.ones(1200)))
    assert "The CSV file holds all 1200." in page.texts["p"]
    assert len(saved(page)[1]) == 1200


@pytest.mark.parametrize(
    ("run", "name"),
    [
        ("straight bushing 1", "straight_bushing_1_x.csv"),
        ("../../etc/passwd", "etc_passwd_x.csv"),
        ('"><script>alert(1)</script>', "script_alert_1_script_x.csv"),
        ("Öl 5°", "Öl_5_x.csv"),
        ("<>", "x.csv"),
    ],
)
def test_name_of_a_file_is_plain(run, name):
    assert file_name(run, "x.csv") == name


def test_link_cannot_be_ended_by_its_text(read_page):
    link = read_page(download_link("</a>\"'", name='"<b>', label="<i>"))
    assert [tag for tag, _ in link.elements] == ["a"]
    assert link.texts["a"] == "<i>"
