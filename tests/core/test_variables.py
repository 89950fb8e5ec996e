"""The table of the variables that erlif writes."""

from erlif.core.flags import FLAG_ATTRS
from erlif.core.variables import FILM, FRAMES, PREDICTION, PRESSURE


def test_variables_name_variables_of_the_same_file():
    for variable in FILM.values():
        assert {*variable.needs, *variable.attrs.get("ancillary_variables", "").split()} <= {*FILM}


def test_a_number_or_an_array_has_dims_and_attributes_of_the_table():
    load = FILM["load"].fill([220.0, 230.0], comment="as set")
    assert load.dims == ("trigger",)
    assert load.attrs == {"units": "N", "long_name": "load", "comment": "as set"}
    assert FILM["load"].attrs == {"units": "N", "long_name": "load"}
    assert FILM["speed_exponent"].fill(0.7).dims == ()


def test_what_an_entry_leaves_out_is_as_in_the_film():
    mean, frame = PREDICTION["film_mean"], FRAMES["attitude"]
    assert (mean.units, mean.meaning) == (FILM["film_mean"].units, FILM["film_mean"].meaning)
    assert mean.when != FILM["film_mean"].when
    assert frame.dims == ("frame",)
    assert PRESSURE["y"].attrs == {"units": "mm", "long_name": "position in the image"}


def test_flags_have_the_same_attributes_as_in_memory():
    assert {name: FLAG_ATTRS[name] for name in ("units", "long_name")} == FILM["flags"].attrs
