"""The table of the variables that erlif writes."""

from erlif.core.flags import FLAG_ATTRS
from erlif.core.variables import FILM


def test_variables_name_variables_of_the_same_file():
    for variable in FILM.values():
        assert {*variable.needs, *variable.attrs.get("ancillary_variables", "").split()} <= {*FILM}


def test_flags_have_the_same_attributes_as_in_memory():
    assert {name: FLAG_ATTRS[name] for name in ("units", "long_name")} == FILM["flags"].attrs
