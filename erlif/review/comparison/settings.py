"""Settings that differ between runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from erlif.io.settings import Settings
from erlif.io.settings.toml import toml_value


def list_differing(settings: Sequence[Settings]) -> dict[str, list[str]]:
    """List the settings that are not the same in all runs; the name of a run is its own.

    Parameters
    ----------
    settings : sequence of Settings
        Of each run.

    Returns
    -------
    dict of list of str
        By table and key, the value of each run as it stands in run.toml; "none" where it has none.

    Examples
    --------
    >>> from erlif.io.settings import OpticsSettings
    >>> list_differing([OpticsSettings(pixel_pitch=pitch) for pitch in ("60 um", "50 um")])
    {'pixel_pitch': ['"60 um"', '"50 um"']}
    """
    runs = [dict(_list_values(each.model_dump(exclude_none=True))) for each in settings]
    keys = dict.fromkeys(key for run in runs for key in run if key != "[run] name")
    values = {key: [run.get(key, "none") for run in runs] for key in keys}
    return {key: stated for key, stated in values.items() if len(set(stated)) > 1}


def _list_values(
    table: Mapping[str, Any], where: tuple[str, ...] = ()
) -> Iterator[tuple[str, str]]:
    """Values of a table and of those within it, by the names that run.toml gives them."""
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from _list_values(value, (*where, key))
        else:
            yield f"[{'.'.join(where)}] {key}" if where else key, toml_value(value)
