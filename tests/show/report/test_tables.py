"""Tables of the report: numbers are those of the film, with units and standard deviations."""

import re

import numpy as np
import numpy.testing as npt
import pytest
from scenes import film as scene

from erlif.core.flags import Flag
from erlif.io.files import open_film
from erlif.show.report.tables import (
    flag_table,
    registration_table,
    results_table,
    theory_limits,
    trigger_section,
    with_error,
    with_span,
)


@pytest.fixture
def groups(film_path):
    loaded = []
    for name in ("registration", "frames"):
        with open_film(film_path, group=name) as group:
            loaded.append(group.load())
    return loaded


def test_values_have_two_digits_of_their_standard_deviation():
    for value, std, text in (
        (0.39320, 0.0021, "0.3932 ± 0.0021"),
        (-2.0, 0.5, "−2.00 ± 0.50"),
        (120.4, 12.0, "120 ± 12"),
        (float("nan"), 0.1, "not known"),
        (3.14159, float("nan"), "3.142"),
        (3.14159, 0.0, "3.142"),
    ):
        assert with_error(value, std) == text
    for values, text in (
        ([3.0, np.nan, 1.5], "1.5 to 3"),
        ([2.0, 2.0], "2"),
        ([np.nan], "not known"),
    ):
        assert with_span(np.array(values)) == text


def test_results_are_rows_of_the_summary_and_stand_against_theory(film):
    """Theory of the scene is twenty times the minimum film thickness."""
    shares = np.full((scene.TRIGGERS, 1 + len(Flag)), 0.9)
    rows = dict(results_table(film, shares).rows)
    assert rows["Valid pixels"] == "90.0%"
    assert rows["Load"] == "222.4 N"
    assert rows["Minimum film thickness"].count(" ± 0.03 µm (trigger ") == 2
    assert "the joint swings" in rows["Theory at the top speed"]
    steady = dict(results_table(film.drop_vars("film_predicted_min"), shares).rows)
    assert "the largest governs" in steady["Theory at the top speed"]

    # sentences that are too long for a cell
    noted = film.film_predicted_min.assign_attrs(notes="fitted to the minima\nrigid bodies")
    limits = theory_limits(film.assign(film_predicted_min=noted))
    assert limits == ["fitted to the minima", "rigid bodies"]
    carried = film.assign_attrs(physics="Squeeze carries the film.")
    rows = dict(results_table(carried, shares).rows)
    assert rows["What carries the film"] == "Squeeze carries the film."


def test_the_largest_error_of_the_film_is_among_the_results(film):
    named = film.assign_attrs(largest_error="lag of the cameras: 97 nm at 3 um. Measure it")
    rows = dict(results_table(named, np.zeros((film.sizes["trigger"], 1 + len(Flag)))).rows)
    assert rows["Largest error"] == "lag of the cameras: 97 nm at 3 µm. Measure it"


def test_drift_is_its_length(groups):
    """3 px along x and 4 px along y are 5 px."""
    registration, frames = groups
    frames.drift_x.values[:], frames.drift_y.values[:] = 3.0, 4.0
    rows = dict(registration_table(registration, frames).rows)
    assert rows["Drift of camera 2"] == "5.00 px rms, 5.00 px at most"
    assert rows["Correlation of the aligned textures"] == "0.970"
    assert rows["Standard deviation of the map"] == "0.010 px (median)"
    assert rows["Spread of the pulse energy"] == "0.0 %"
    frames.drift_x.values[1:3] = np.nan
    rows = dict(registration_table(registration, frames).rows)
    assert rows["Frame pairs without drift, or left out"] == "2"
    frames.drift_x.values[:] = np.nan
    assert "Drift of camera 2" not in dict(registration_table(registration, frames).rows)


def test_flags_that_occur_are_listed_with_their_share():
    shares = np.zeros(len(Flag))
    assert flag_table(shares).rows == []
    shares[list(Flag).index(Flag.NO_FILM)] = 0.0123
    ((name, *row),) = flag_table(shares).rows
    assert name.endswith(">no film")
    assert row == ["bubble or bare wall: both bands are without fluorescence", "1.23 %"]
    assert len(flag_table(np.ones(len(Flag))).rows) == len(Flag)


def rows_of(section):
    """Cells of the table of the triggers as text, row by row."""
    rows = re.findall(r"<tr>(.*?)</tr>", section)
    return [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in rows]


def test_triggers_have_their_numbers(film):
    head, *rows = rows_of(trigger_section(film, np.full(scene.TRIGGERS, 0.5)))
    assert len(rows) == scene.TRIGGERS
    assert all(len(row) == len(head) for row in rows)
    speeds = scene.rocker_speed(scene.CRANK)
    for k, row in enumerate(rows):
        one = dict(zip(head, row, strict=True))
        assert one["Trigger"] == f"{k}"
        assert one["Stroke"] == ("outward" if speeds[k] > 0 else "return")
        assert one["Crank [°]"] == f"{scene.CRANK[k]:.2f}"
        assert one["Speed [rad/s]"] == f"{speeds[k]:.3f}".replace("-", "−")
        assert one["Sliding [mm/s]"] == f"{33.36 * abs(speeds[k]):.1f}"
        assert one["Minimum film thickness [µm]"] == f"{scene.minimum_film()[k]:.3f} ± 0.030"
        assert one["Valid pixels"] == "50.0 %"
    assert "Oil [°C]" not in head


def test_theory_has_three_significant_digits(changed, read_page):
    changed["film_theory"] = changed.film_theory.copy(
        data=np.resize([0.04567, 7.654, 123.4], scene.TRIGGERS)
    )
    changed["film_min_x"] = ("trigger", np.full(scene.TRIGGERS, 68.5))
    changed["film_min_y"] = ("trigger", np.full(scene.TRIGGERS, 13.0))
    head, *rows = rows_of(trigger_section(changed, np.ones(scene.TRIGGERS)))
    found = [row[head.index("Steady theory [µm]")] for row in rows[:3]]
    assert found == ["0.0457", "7.65", "123"]
    assert rows[0][head.index("at column, row [px]")] == "68, 13"
    changed.film_min.values[2] = np.nan
    _, rows = read_page(trigger_section(changed, np.ones(6))).saved()
    assert rows[2]["film_min [um]"] == "NaN"


def test_file_of_the_page_has_the_numbers_of_the_film(page, film):
    name, rows = page.saved()
    assert name == "a_film_known_small_triggers.csv"
    assert [int(row["trigger"]) for row in rows] == list(range(scene.TRIGGERS))
    found = [float(row["crank_angle [degree]"]) for row in rows]
    npt.assert_allclose(found, scene.CRANK, rtol=1e-9)
    for variable in ("film_min", "film_min_std", "film_mean", "joint_load", "rocker_speed"):
        unit = film[variable].attrs["units"]
        found = [float(row[f"{variable} [{unit}]"]) for row in rows]
        npt.assert_allclose(found, film[variable].values, rtol=5e-9)
    shares = (film.flags == 0).mean(("y", "x")).values
    npt.assert_allclose([float(row["valid share [1]"]) for row in rows], shares, rtol=5e-9)


def test_file_and_table_of_many_triggers_are_thinned_and_say_so(changed, read_page):
    many = changed[["frames_used", "film_min", "film_min_std"]].isel(
        trigger=np.arange(2000) % scene.TRIGGERS
    )
    many = many.assign_coords(trigger=np.arange(2000)).assign_attrs(changed.attrs)
    page = read_page(trigger_section(many, np.ones(2000), most=20_000))
    _, rows = page.saved()
    numbers = [int(row["trigger"]) for row in rows]
    step = numbers[1]
    assert numbers == list(range(0, 2000, step))
    text = " ".join(page.texts["p"].split())
    assert f"The CSV file holds one of {step}; erlif export writes all." in text
    assert "The table holds one of 4 triggers." in text
    assert len(page.all("tr")) == 501
