"""Descriptions of the keys: complete, and true to the types."""

from erlif.io.settings import FixtureSettings, PlanSettings, RunSettings, keys_of, tables_of
from erlif.joint.settings import DesignSettings, EnduranceSettings

KINDS = (RunSettings, FixtureSettings, PlanSettings, DesignSettings, EnduranceSettings)


def test_every_key_and_table_has_a_meaning_and_an_example():
    for table in (table for kind in KINDS for table in tables_of(kind)):
        assert table.meaning
        for one in keys_of(table.kind):
            assert one.meaning.endswith((".", "]")), f"{table.title}.{one.name}"
            assert one.example is not None, f"{table.title}.{one.name}"


def test_a_default_is_written_as_a_user_writes_it():
    keys = {
        (table.title, key.name): key
        for table in tables_of(DesignSettings)
        for key in keys_of(table.kind)
    }
    shown = {name: key.default for (_, name), key in keys.items()}
    assert (shown["thickness"], shown["interference"]) == ("10 mm", "0 mm")
