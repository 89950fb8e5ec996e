"""Tables of the settings: frozen, and their types described."""

import pytest

from erlif.core.units import parse_quantity
from erlif.io.settings import FixtureSettings, PlanSettings, RunSettings, keys_of, tables_of
from erlif.joint.settings import DesignSettings, EnduranceSettings

KINDS = (RunSettings, FixtureSettings, PlanSettings, DesignSettings, EnduranceSettings)


@pytest.mark.parametrize("kind", KINDS)
def test_every_example_of_a_quantity_is_in_its_unit(kind):
    quantities = [key for table in tables_of(kind) for key in keys_of(table.kind) if key.unit]
    assert quantities
    for key in quantities:
        parse_quantity(key.example, key.unit)
