"""JSON schema of run.toml and fixture.toml, for editors that complete and check TOML.

The editor plug-ins Taplo and Even Better TOML read JSON schema draft 7 and find the schema by the
comment ``#:schema`` in the first line of a file.
"""

from __future__ import annotations

from typing import Any

from erlif.io.settings.keys import keys_of, meaning_of, tables_of
from erlif.io.settings.values import Settings

DRAFT = "http://json-schema.org/draft-07/schema#"


def json_schema(kind: type[Settings]) -> dict[str, Any]:
    """JSON schema of a settings file.

    Parameters
    ----------
    kind : type of Settings
        ``RunSettings`` or ``FixtureSettings``.

    Returns
    -------
    dict
        JSON schema, draft 7. Quantities are strings with a pattern, an example and a meaning.

    Examples
    --------
    >>> from erlif.io.settings import RunSettings
    >>> schema = json_schema(RunSettings)
    >>> schema["definitions"]["OpticsSettings"]["properties"]["pixel_pitch"]["examples"]
    ['60 um']
    """
    raw = kind.model_json_schema(ref_template="#/definitions/{model}")
    schema = {"$schema": DRAFT, **_simplify(raw), "definitions": _simplify(raw["$defs"])}
    del schema["$defs"]

    for table in tables_of(kind):
        definition = schema if table.kind is kind else schema["definitions"][table.kind.__name__]
        for name, entry in definition["properties"].items():
            if meaning := meaning_of(table.kind, name):
                entry["description"] = meaning

        # defaults as a user writes them: pydantic has them in the unit in which they are kept
        for key in keys_of(table.kind):
            if key.default is not None:
                definition["properties"][key.name]["default"] = key.default
    return schema


def _simplify(part: Any) -> Any:
    """Remove null and other entries of the schema that TOML or an editor does not need."""
    if isinstance(part, list):
        return [_simplify(item) for item in part]
    if not isinstance(part, dict):
        return part

    left = {name: _simplify(value) for name, value in part.items() if name != "discriminator"}
    if isinstance(left.get("title"), str):
        del left["title"]
    if left.get("default", 0) is None or isinstance(left.get("default"), dict):
        del left["default"]

    # an optional key may be absent, but cannot be null
    options = [option for option in left.get("anyOf", []) if option != {"type": "null"}]
    if len(options) == 1:
        del left["anyOf"]
        left = {**options[0], **left}
    elif options:
        left["anyOf"] = options
    return left
