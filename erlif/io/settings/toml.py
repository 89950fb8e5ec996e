"""Settings written as TOML."""

from __future__ import annotations

import json
from typing import Any

from erlif.io.settings.values import Settings


def to_toml(settings: Settings) -> str:
    """Write settings as TOML, defaults included.

    Parameters
    ----------
    settings : Settings
        A whole file or one table.

    Returns
    -------
    str
        Lines that read back to the same settings; quantities stand as the user wrote them.

    Examples
    --------
    >>> from erlif.io.settings import OpticsSettings
    >>> print(to_toml(OpticsSettings(pixel_pitch="60 um")), end="")
    pixel_pitch = "60 um"
    x_axis = "sliding"
    """
    lines: list[str] = []
    _write_table(settings.model_dump(exclude_none=True), (), lines)
    return "\n".join(lines) + "\n"


def toml_value(value: Any) -> str:
    """One value as TOML.

    Parameters
    ----------
    value : bool, int, float, str, list, tuple or dict
        A dict becomes an inline table.

    Returns
    -------
    str

    Examples
    --------
    >>> toml_value({"x": (4, 15), "unit": "mm"})
    '{ x = [4, 15], unit = "mm" }'
    """
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(toml_value(item) for item in value)}]"
    if isinstance(value, (bool, str)):
        return json.dumps(value, ensure_ascii=False)  # TOML escapes as JSON does
    return repr(value)


def _write_table(table: dict[str, Any], path: tuple[str, ...], lines: list[str]) -> None:
    plain = {key: value for key, value in table.items() if not isinstance(value, dict)}
    if path and plain:
        lines.append(f"[{'.'.join(path)}]")
    lines.extend(f"{key} = {toml_value(value)}" for key, value in plain.items())

    # tables follow the plain keys, which would belong to them otherwise
    for key, value in table.items():
        if isinstance(value, dict):
            _write_table(value, (*path, key), lines)


def stated_keys(settings: Settings) -> str:
    """List the keys that a user stated, in order, with commas between them.

    Parameters
    ----------
    settings : Settings
        As read; what is computed from defaults has no stated keys.

    Returns
    -------
    str
        Names with their tables, "prediction.sideways".

    Examples
    --------
    >>> from erlif.io.settings import OpticsSettings
    >>> stated_keys(OpticsSettings(pixel_pitch="60 um"))
    'pixel_pitch'
    """
    names: list[str] = []
    for key in type(settings).model_fields:
        if key in settings.model_fields_set:
            value = getattr(settings, key)
            inner = stated_keys(value).split(", ") if isinstance(value, Settings) else [""]
            names += [f"{key}.{name}" if name else key for name in inner]
    return ", ".join(names)
