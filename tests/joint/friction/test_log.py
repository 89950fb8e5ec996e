"""Logs of load and torque as loggers write them."""

import numpy.testing as npt
import pytest

from erlif.core.errors import EnduranceError
from erlif.joint.friction import LogColumns, read_torque_log

ROWS = [[n * 0.5, 18e3 + n, 17e3, 400 + n % 5, 25 + 0.01 * n, 0.4] for n in range(80)]
HEADER = ["Time [s]", "Cell 1 [N]", "Cell 2 [N]", "Arm [N]", "Pin temperature [degC]", "Vib [g]"]


def write(path, header=HEADER, rows=ROWS, separator=","):
    lines = [separator.join(header), *(separator.join(map(str, row)) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_plain_names_are_found(tmp_path):
    log = read_torque_log(write(tmp_path / "run.csv"))
    assert log.time.values.tolist() == [row[0] for row in ROWS]  # to the last digit
    npt.assert_allclose(log.cells.sum("cell"), [row[1] + row[2] for row in ROWS])
    npt.assert_allclose(log.arm_force, [row[3] for row in ROWS])
    assert log.temperature.units == "degree_Celsius"
    assert log.vibration.units == "g"
    assert "arm_force from 'Arm [N]'" in log.attrs["columns"]


def test_names_of_another_language_and_units_are_chosen(tmp_path):
    header = ["Zeit;Zelle A;Zelle B;Stange;Stift;x"]
    rows = [[";".join(str(value).replace(".", ",") for value in row)] for row in ROWS]
    path = write(tmp_path / "run.txt", header, rows)
    columns = LogColumns(
        cells=("Zelle A", "Zelle B"),
        arm_force="Stange",
        temperature=("Stift",),
        units={"time": "min", "cells": "kN", "arm_force": "lbf", "temperature": "degF"},
    )
    log = read_torque_log(path, columns)
    npt.assert_allclose(log.time, [60 * row[0] for row in ROWS])
    npt.assert_allclose(log.cells[0], [1e3 * row[1] for row in ROWS])
    npt.assert_allclose(log.arm_force[0], 400 * 4.4482216152605)
    npt.assert_allclose(log.temperature[0], (25 - 32) / 1.8)


@pytest.mark.parametrize(
    ("header", "columns", "message"),
    [
        (["Time [s]", "F"], LogColumns(), "column for the cells.*--column cells="),
        (["Time [s]", "Load [N]"], LogColumns(), "column for the torque or arm_force"),
        (
            ["Time [s]", "Cell 1 [N]", "Load [N]", "Arm [N]"],
            LogColumns(),
            "'Cell 1 .N.' and 'Load .N.' may be meant",
        ),
        (["Time [s]", "Load [N]", "Torque"], LogColumns(units={"torque": "bar"}), "got 'bar'"),
    ],
)
def test_columns_that_are_not_clear_are_refused(tmp_path, header, columns, message):
    path = write(tmp_path / "run.csv", header, [row[: len(header)] for row in ROWS])
    with pytest.raises(EnduranceError, match=message):
        read_torque_log(path, columns)


@pytest.mark.parametrize(
    ("place", "value", "message"),
    [
        ((7, 0), 3.0, "row 9, column Time .s.*: 3 s repeats 3 s"),
        ((7, 0), 1.0, "comes after"),
        ((5, 3), "", "row 7, column Arm"),
        ((5, 3), "broken", "got 'broken'"),
        ((5, 4), 4000.0, "temperature.*row 7"),
    ],
)
def test_values_that_cannot_be_are_refused_with_their_row(tmp_path, place, value, message):
    rows = [list(row) for row in ROWS]
    rows[place[0]][place[1]] = value
    with pytest.raises(EnduranceError, match=message):
        read_torque_log(write(tmp_path / "run.csv", rows=rows))


def test_files_that_are_no_log_are_refused(tmp_path):
    (tmp_path / "empty.csv").touch()
    for name, rows, message in (
        ("empty.csv", None, "rows found: 0"),
        ("none.csv", None, "No such file"),
        (".", None, "not a regular file"),
        ("short.csv", ROWS[:20], "at least 60 rows"),
        ("head.csv", [], "rows of numbers"),
        ("back.csv", ROWS[::-1], "order of time"),
    ):
        path = tmp_path / name if rows is None else write(tmp_path / name, rows=rows)
        with pytest.raises(EnduranceError, match=message):
            read_torque_log(path)


def test_seconds_are_taken_where_the_time_of_day_stands_beside_them(tmp_path):
    header = ["Uhrzeit", "Time [s]", "Load [N]", "Torque [N m]"]
    rows = [[f"08:{n // 60:02}:{n % 60:02}", *row[:3]] for n, row in enumerate(ROWS)]
    log = read_torque_log(write(tmp_path / "run.csv", header, rows))
    npt.assert_array_equal(log.time, [row[0] for row in ROWS])
    assert log.attrs["unused"] == "'Uhrzeit'"


def test_gaps_are_refused_in_one_message_and_left_out_on_request(tmp_path):
    rows = [list(row) for row in ROWS]
    for place in range(5, 25):
        rows[place][2 + place % 2] = "" if place % 3 else "NaN"
    path = write(
        tmp_path / "run.csv", HEADER, [*rows, *([80 + n, *row[1:]] for n, row in enumerate(ROWS))]
    )
    with pytest.raises(EnduranceError, match=r"20 rows of 160.*rows 8, 10, 12.*--skip-bad-rows"):
        read_torque_log(path)
    log = read_torque_log(path, skip_bad_rows=True)
    assert log.sizes["time"] == 140
    assert log.attrs["left_out"].startswith("20 rows of 160 ")
    assert 7 * 0.5 not in log.time


def test_cells_may_read_compression_as_negative(tmp_path):
    path = write(tmp_path / "run.csv", rows=[[r[0], -r[1], -r[2], *r[3:]] for r in ROWS])
    with pytest.raises(EnduranceError, match="--compression-negative"):
        read_torque_log(path)
    log = read_torque_log(path, compression_negative=True)
    npt.assert_allclose(log.cells.sum("cell"), [row[1] + row[2] for row in ROWS])


def test_a_temperature_of_any_place_is_found_and_other_columns_are_named(tmp_path):
    header = ["Time [s]", "Load [N]", "Torque [N m]", "Lagertemperatur [°C]", "Raumtemperatur [°C]"]
    rows = [[*row[:3], row[4], 21.0] for row in ROWS]
    log = read_torque_log(write(tmp_path / "run.csv", header, rows))
    npt.assert_allclose(log.temperature, [row[4] for row in ROWS])
    assert log.attrs["unused"] == "'Raumtemperatur [°C]'"
