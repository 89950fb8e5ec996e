"""The table of the variables that erlif writes."""

import xarray as xr

from erlif.core.flags import FLAG_ATTRS
from erlif.core.variables import CALIBRATION, FILM, FRAMES, PREDICTION, PRESSURE, REGISTRATION


def test_variables_name_variables_of_the_same_file():
    for variable in FILM.values():
        assert {*variable.needs, *variable.attrs.get("ancillary_variables", "").split()} <= {*FILM}


def test_flags_have_the_same_attributes_as_in_memory():
    assert {name: FLAG_ATTRS[name] for name in ("units", "long_name")} == FILM["flags"].attrs


def test_every_variable_is_an_attribute_of_a_dataset_that_holds_it():
    """`film.load` would be the method of xarray, so that the variable is joint_load."""
    taken = set(dir(xr.Dataset)) | set(dir(xr.DataArray))
    tables = (FILM, FRAMES, REGISTRATION, CALIBRATION, PREDICTION, PRESSURE)
    assert not [name for table in tables for name in table if name in taken]


def test_groups_pass_their_keys_on_and_standard_deviations_need_their_variable():
    whens = {FILM[name].when for name in ("film_curvature", "film_curvature_axial_std", "axis")}
    assert whens == {"[joint] is given"}
    assert FILM["speed_exponent_std"].dims == FILM["speed_exponent"].dims == ()
    for name in ("speed_exponent", "film_drag", "friction_torque"):
        std = FILM[f"{name}_std"]
        assert (std.needs, std.low) == ((name,), 0)
    assert [PREDICTION[name].when for name in ("x", "film_min")] == ["", "a film was there"]
