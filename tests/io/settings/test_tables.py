"""Tables of the settings: frozen, and their types described."""

import pytest

from erlif.core.units import parse_quantity
from erlif.io.settings import CameraSettings, FixtureSettings, RunSettings, read_run_settings
from erlif.io.settings.keys import keys_of, tables_of

KINDS = pytest.mark.parametrize("kind", [RunSettings, FixtureSettings])


def test_settings_cannot_be_changed(small_rig):
    camera = read_run_settings(small_rig.run).camera1
    with pytest.raises(ValueError, match="frozen"):
        camera.bit_depth = 10


def test_full_scale_follows_from_the_bit_depth():
    camera = CameraSettings(files="a.tif", band="580 nm", bit_depth=10, offset="0 DN")
    assert camera.full_scale == 1023


@KINDS
def test_every_example_of_a_quantity_is_in_its_unit(kind):
    quantities = [key for table in tables_of(kind) for key in keys_of(table.kind) if key.unit]
    assert quantities
    for key in quantities:
        parse_quantity(key.example, key.unit)
