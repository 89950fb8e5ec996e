"""Descriptions of the keys: complete, and true to the types."""

from erlif.core.tables import read_table
from erlif.io.settings import (
    CameraSettings,
    DesignSettings,
    EncoderSettings,
    EnduranceSettings,
    FixtureSettings,
    PlanSettings,
    RunSettings,
    ThicknessOptions,
    keys_of,
    tables_of,
)

KINDS = (RunSettings, FixtureSettings, PlanSettings, DesignSettings, EnduranceSettings)


def key(kind, name):
    return next(key for key in keys_of(kind) if key.name == name)


def test_every_key_and_table_has_a_meaning_and_an_example():
    described = {}
    for table in (table for kind in KINDS for table in tables_of(kind)):
        assert table.meaning
        fields = {name for one in table.kind.__mro__ for name in getattr(one, "model_fields", ())}
        described |= {one.__name__: fields for one in table.kind.__mro__}
        for one in keys_of(table.kind):
            assert one.meaning.endswith((".", "]")), f"{table.title}.{one.name}"
            assert one.example is not None, f"{table.title}.{one.name}"

    # and keys.toml describes no key that there is not
    for name, keys in read_table("erlif.io.settings", "keys.toml").items():
        assert set(keys) <= described[name], name


def test_tables_come_in_the_order_of_the_file_and_inner_ones_after_their_own():
    titles = [table.title for table in tables_of(RunSettings)]
    assert titles[:5] == ["", "run", "camera1", "camera2", "optics"]
    assert titles.index("joint.pin") == titles.index("joint") + 1
    assert titles.count("mechanism") == 4  # two linkages, rotation and sinusoidal


def test_unit_bounds_default_and_choices_are_those_of_the_type():
    assert key(CameraSettings, "band").unit == "nm"
    assert key(CameraSettings, "gain").unit == "electron/DN"  # optional quantities too
    assert key(CameraSettings, "bit_depth").bounds == "from 8 up to 16"
    assert key(CameraSettings, "bit_depth").default == 12
    assert key(ThicknessOptions, "least_signal").default == "100 electron"
    assert key(ThicknessOptions, "no_film_below").bounds == "above 0 below 1"
    assert key(EncoderSettings, "mounted_on").choices == ("rocker", "crank", "coupler")
    assert key(EncoderSettings, "triggers_per_cycle").default is None
