"""JSON schema for editors, held to what the reader accepts."""

import json
import re
import tomllib

import pytest

from erlif.io.settings import FixtureSettings, RunSettings, json_schema, keys_of, tables_of

KINDS = pytest.mark.parametrize("kind", [RunSettings, FixtureSettings])


def definitions(kind):
    schema = json_schema(kind)
    return {kind.__name__: schema, **schema["definitions"]}


@KINDS
def test_every_key_is_in_the_schema_with_its_meaning_and_its_default(kind):
    found = definitions(kind)
    for table in tables_of(kind):
        part = found[table.kind.__name__]
        assert part["additionalProperties"] is False
        for key in keys_of(table.kind):
            entry = part["properties"][key.name]
            assert entry["description"] == key.meaning
            assert entry.get("default") == key.default
            assert (key.name in part.get("required", [])) == key.required


@KINDS
def test_quantities_are_text_with_a_number_and_a_unit(kind):
    found = definitions(kind)
    for table in tables_of(kind):
        for key in keys_of(table.kind):
            if key.unit:
                entry = found[table.kind.__name__]["properties"][key.name]
                assert entry["type"] == "string"
                for text in (key.example, *entry["examples"]):
                    assert re.search(entry["pattern"], text)
                for wrong in ("5.5", "?? um", "5,5 cm", ""):
                    assert not re.search(entry["pattern"], wrong)


@KINDS
def test_the_schema_knows_neither_null_nor_lost_references(kind):
    schema = json_schema(kind)
    text = json.dumps(schema)
    assert '"null"' not in text
    assert "$defs" not in text
    assert set(re.findall(r"#/definitions/(\w+)", text)) <= set(schema["definitions"])


@pytest.mark.parametrize(("name", "kind"), [("run", RunSettings), ("fixture", FixtureSettings)])
def test_an_editor_accepts_settings_of_the_rig_and_marks_gaps_and_unknown_keys(
    small_rig, name, kind
):
    jsonschema = pytest.importorskip("jsonschema")
    validator = jsonschema.Draft7Validator(json_schema(kind))
    jsonschema.Draft7Validator.check_schema(json_schema(kind))
    written = tomllib.loads((small_rig.directory / name / f"{name}.toml").read_text())
    assert list(validator.iter_errors(written)) == []

    written["optics"] |= {"pixel_pitch": "?? um", "pitch": "60 um"}
    gap, unknown = sorted(validator.iter_errors(written), key=lambda error: len(error.path))[::-1]
    assert list(gap.path) == ["optics", "pixel_pitch"]
    assert "'pitch' was unexpected" in unknown.message
