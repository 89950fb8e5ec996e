"""Options that name the columns of a log."""

from erlif.joint.commands.log_columns import choose_columns
from erlif.joint.friction import LogColumns


def test_columns_and_units_of_options_come_before_those_of_settings():
    named = LogColumns(time="Zeit", torque="T", units={"time": "min", "torque": "N mm"})
    chosen = choose_columns({"cells": ("Fx", "Fy"), "torque": ("M",)}, {"torque": ("N m",)}, named)
    assert (chosen.time, chosen.cells, chosen.torque) == ("Zeit", ("Fx", "Fy"), "M")
    assert chosen.units == {"time": "min", "torque": "N m"}
