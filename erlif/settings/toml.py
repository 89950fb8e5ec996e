"""Settings written as TOML."""

from __future__ import annotations

import json
from typing import Any

from erlif.settings.tables import Settings


def to_toml(settings: Settings) -> str:
    """Write settings, defaults included, as TOML that reads back to the same settings."""
    lines: list[str] = []
    _write_table(settings.model_dump(exclude_none=True), (), lines)
    return "\n".join(lines) + "\n"


def _write_table(table: dict[str, Any], path: tuple[str, ...], lines: list[str]) -> None:
    plain = {key: value for key, value in table.items() if not isinstance(value, dict)}
    if path and plain:
        lines.append(f"[{'.'.join(path)}]")
    lines.extend(f"{key} = {_toml_value(value)}" for key, value in plain.items())
    for key, value in table.items():
        if isinstance(value, dict):
            _write_table(value, (*path, key), lines)


def _toml_value(value: Any) -> str:
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_toml_value(item) for item in value)}]"
    if isinstance(value, (bool, str)):
        return json.dumps(value, ensure_ascii=False)  # TOML escapes as JSON does
    return repr(value)
