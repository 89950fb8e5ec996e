"""What of a film is converted."""

import numpy as np
import pytest

from erlif.core.errors import ErlifError
from erlif.core.variables import FILM
from erlif.io.conversion.contents import (
    choose_trigger,
    describe_units,
    table_columns,
    trigger_columns,
)


def test_every_number_of_a_trigger_has_one_column(film):
    columns = trigger_columns(film)
    names = [column.name for column in columns]
    assert len(set(names)) == len(names)
    expected = sum(
        variable.size // 6
        for name, variable in film.variables.items()
        if variable.dims[:1] == ("trigger",) and variable.ndim <= 2
    )
    # of the matrices, the standard deviations of two displacements and two tilts
    assert len(columns) == expected + 4
    assert names[:3] == ["trigger", "frames_used", "crank_angle"]


def test_a_number_with_further_dims_is_named_by_its_labels(film):
    columns = {column.name: column for column in trigger_columns(film)}
    side = columns["pin_displacement_side"]
    assert side.unit == "um"
    np.testing.assert_array_equal(side.values, film.pin_displacement.values[:, 1])
    assert columns["pin_displacement_side_std"].unit == "um"
    std = columns["pin_tilt_side_std"]
    np.testing.assert_allclose(std.values**2, film.pin_position_cov.values[:, 3, 3])


def test_counts_of_flags_are_named_by_the_flag(film):
    counts = np.arange(48).reshape(6, 8)
    counted = film.assign_coords(flag=("flag", 2 ** np.arange(8))).assign(
        flagged_pixels=(("trigger", "flag"), counts)
    )
    columns = {column.name: column for column in trigger_columns(counted)}
    np.testing.assert_array_equal(columns["flagged_pixels_no_film"].values, counts[:, 7])


def test_a_table_has_at_most_forty_columns_of_what_erlif_writes(film):
    """A full run of a crank-rocker has all but what ball on disc and torque logs add."""
    full = film.assign_coords(flag=("flag", 2 ** np.arange(8)))
    others = ("film_central", "rotation_speed", "position", "torque_")
    for name, known in FILM.items():
        if name not in full and known.dims in (("trigger",), ("trigger", "flag")):
            full[name] = known.dims, np.zeros([full.sizes[dim] for dim in known.dims])
    full = full.drop_vars([name for name in full if str(name).startswith(others)])
    names = [column.name for column in table_columns(full)]
    logged = full.assign(reference_force=("trigger", np.zeros(6)))
    assert [one.name for one in table_columns(logged)] == [*names, "reference_force"]
    assert len(trigger_columns(full)) > 60
    assert len(names) <= 40
    assert {"film_min", "film_mean_std", "rocker_speed", "film_over_theory_std"} <= set(names)


def test_a_crank_angle_counts_over_the_full_turn(film):
    # triggers at 250, 290, 330, 70, 110 and 150 degree
    assert choose_trigger(film, crank_angle=10.0 + 360.0 * 2 + 66.0) == 3
    assert choose_trigger(film, crank_angle=345.0) == 2
    assert choose_trigger(film, trigger=5) == 5
    assert choose_trigger(film) is None


@pytest.mark.parametrize("angle", [np.nan, np.inf])
def test_an_angle_that_is_no_number_is_refused(film, angle):
    with pytest.raises(ErlifError, match="Expected the crank angle of a trigger in degree"):
        choose_trigger(film, crank_angle=angle)


def test_an_angle_far_from_all_triggers_is_refused(film):
    with pytest.raises(ErlifError, match=r"of all triggers, that at 70\.00 degree is the nearest"):
        choose_trigger(film, crank_angle=21.0)
    with pytest.raises(ErlifError, match="Give one of them"):
        choose_trigger(film, crank_angle=20.0, trigger=1)
    with pytest.raises(ErlifError, match="a trigger from 0 to 5"):
        choose_trigger(film, trigger=6)
    still = film.drop_vars(["crank_angle", "encoder_angle"])
    with pytest.raises(ErlifError, match="by its number"):
        choose_trigger(still, crank_angle=70.0)
    turned = film.drop_vars("crank_angle")
    angle = float(film.encoder_angle[4])
    assert choose_trigger(turned, encoder_angle=angle) == 4


def test_every_variable_of_erlif_has_a_unit(film):
    units = describe_units(film)
    assert all(units[name] for name in units if "trigger" in film[name].dims)
    matrix = {"comment": "displacements in um, tilts in um mm-1"}
    cov = film.assign(cov=(("trigger", "a", "b"), np.zeros((6, 2, 2)), matrix))
    assert describe_units(cov)["cov"] == matrix["comment"]
