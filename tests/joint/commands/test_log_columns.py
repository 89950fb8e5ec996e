"""Options that name the columns of a log."""

import click
import pytest

from erlif.joint.commands.log_columns import choose_columns, column_pairs


def test_columns_and_units_become_the_choice_of_the_reader():
    chosen = choose_columns({"cells": ("Fx", "Fy"), "torque": ("M",)}, {"torque": ("N m",)})
    assert chosen.cells == ("Fx", "Fy")
    assert chosen.torque == "M"
    assert chosen.units == {"torque": "N m"}


@pytest.mark.parametrize("text", ["cells", "=Fx", "cells="])
def test_a_pair_without_name_or_column_is_refused(text):
    with pytest.raises(click.BadParameter, match="QUANTITY=NAME"):
        column_pairs(None, None, (text,))
