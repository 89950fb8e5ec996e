"""Which column holds what, in which unit."""

import numpy as np
import pytest

from erlif.core.errors import EncoderError
from erlif.io.ingest.logs.columns import ColumnChoice, convert_columns, find_columns
from erlif.io.ingest.logs.table import LogColumn, LogTable, split_unit


def table(*names, rows=(2, 3), **texts):
    columns = []
    for n, name in enumerate(names):
        values = np.array([1.0, 2.0]) + n
        values[list(texts.get(name, {}))] = np.nan
        columns.append(LogColumn(name, split_unit(name)[1], values, texts.get(name, {})))
    return LogTable("log.csv", tuple(columns), rows)


def found(table, **choice):
    units = choice.pop("units", {})
    ticks = choice.pop("ticks", None)
    chosen = ColumnChoice(choice, units, ticks)
    columns, remarks = find_columns(table, chosen)
    log, more = convert_columns(table, columns, chosen, dim="frame")
    return log, [*remarks, *more]


def refusal(*args, **choice):
    with pytest.raises(EncoderError) as refused:
        found(*args, **choice)
    return str(refused.value)


@pytest.mark.parametrize(
    ("name", "quantity", "unit"),
    [
        ("Encoder [deg]", "angle", "degree"),
        ("angle_rad", "angle", "degree"),
        ("Time (ms)", "time", "s"),
        ("Normal_Force [kN]", "load", "N"),
        ("run/Temp [°C]", "temperature", "degree_Celsius"),
        ("T oil [degree C]", "temperature", "degree_Celsius"),
        ("bath temperature [deg C]", "temperature", "degree_Celsius"),
    ],
)
def test_an_obvious_name_is_taken_with_a_remark(name, quantity, unit):
    log, remarks = found(table(name, "x1"))
    variable = "joint_load" if quantity == "load" else quantity
    assert log[variable].attrs["units"] == unit
    assert remarks == [f"{quantity} from column {name!r}"]


def test_chosen_columns_come_first_by_name_with_or_without_unit():
    log, remarks = found(table("angle_deg", "Winkel 2 [rad]", "Kraft"), angle="Winkel 2")
    np.testing.assert_allclose(log.angle, np.degrees([2.0, 3.0]))
    assert "angle_deg" in log  # the other one travels along
    assert remarks[0] == "angle from column 'Winkel 2 [rad]'"


def test_units_of_the_settings_come_before_those_of_the_header():
    log, _ = found(table("Encoder [deg]"), units={"angle": "tick"}, ticks=720)
    np.testing.assert_allclose(log.angle, [0.5, 1.0])


def test_a_speed_is_one_of_sliding_or_of_rotation():
    assert found(table("v [mm/s]"), speed="v")[0]["sliding_speed"].values.tolist() == [1e-3, 2e-3]
    log, _ = found(table("n [rpm]"), speed="n")
    np.testing.assert_allclose(log["rotation_speed"], np.array([1, 2]) * 2 * np.pi / 60)


def test_pulse_energy_needs_no_unit():
    assert found(table("laser"), pulse_energy="laser")[0].pulse_energy.units == "1"


def test_two_columns_that_may_be_meant_are_refused():
    message = refusal(table("angle [deg]", "Encoder [deg]"))
    assert "'angle [deg]' and 'Encoder [deg]' may be meant" in message
    assert 'angle = "angle [deg]"' in message


def test_a_missing_unit_is_refused_with_the_key_that_gives_it():
    message = refusal(table("Winkel"), angle="Winkel")
    assert "the unit of column Winkel of log.csv, the angle; got none in its header" in message
    assert 'units = { angle = "deg" }' in message
    assert "got 'furlong'" in refusal(table("Winkel [furlong]"), angle="Winkel")


def test_ticks_need_the_number_in_a_turn():
    assert "ticks_per_turn = 3600" in refusal(table("Encoder [ticks]"))


def test_a_chosen_column_that_is_not_there_is_refused_with_the_nearest():
    message = refusal(table("Encoder [deg]", "t"), angle="Encodr [deg]")
    assert "chosen as angle; its columns are 'Encoder [deg]', 't'" in message
    assert "Did you mean 'Encoder [deg]'?" in message
    assert "there are 2" in refusal(table("a [V]", "a [N]"), angle="a")


def test_columns_of_a_logger_with_unusable_names_are_left_out_with_a_remark():
    log, remarks = found(table("Encoder [deg]", "thickness", "a/b", "c", "c"))
    assert set(log) == {"angle"}
    assert "left out because of their names: 'thickness', 'a/b', 'c'" in remarks[-1]
