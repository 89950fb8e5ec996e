"""A commented run.toml or fixture.toml with marked gaps, for `erlif init`."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Collection, Iterator, Mapping
from typing import Any, Final

from erlif.core.tables import read_table
from erlif.io.settings.keys import Key, Table, example_of, keys_of, meaning_of, tables_in, tables_of
from erlif.io.settings.toml import toml_value
from erlif.io.settings.values import Settings

# Columns of a line of comment.
WIDTH = 98

_NO_BREAK = "\N{NO-BREAK SPACE}"


# In place of a value: the key is required and the user has to fill it in.
GAP: Final = object()

_HEAD = """\
#:schema ./{stem}.schema.json
# {name}, made by erlif init from the files in this directory.
# Every "??" is a gap: replace it. `erlif check` lists the gaps that are left.
# Quantities are text with a unit. A key behind "#" is optional and shown with its default, or with
# an example where there is no default.
"""

_SHORT_HEAD = """\
#:schema ./{stem}.schema.json
# {name}, made by erlif init from the files in this directory.
# Every "??" is a gap: replace it. `erlif check` lists the gaps that are left.
# Quantities are text with a unit. `erlif init --full` writes the optional keys with their meaning.
"""


def gap_text(key: Key) -> str:
    """Placeholder for an unknown value in a settings file.

    Parameters
    ----------
    key : Key
        Key of the value.

    Returns
    -------
    str
        ``"??"``, with the unit of the example where the value is a quantity.

    Examples
    --------
    >>> from erlif.io.settings import OpticsSettings
    >>> gap_text(next(keys_of(OpticsSettings)))
    '?? um'
    """
    if not key.unit:
        return "??"
    unit = str(key.example).partition(" ")[2]
    return f"?? {unit}"


def write_template(
    kind: type[Settings],
    values: Mapping[str, Any],
    remarks: Mapping[str, str],
    *,
    forms: Mapping[str, str] | None = None,
    leave_out: Collection[str] = (),
    head: str = "",
    full: bool = True,
) -> str:
    """Write a commented settings file.

    Parameters
    ----------
    kind : type of Settings
        ``RunSettings`` or ``FixtureSettings``.
    values : mapping of str to value
        What is known, by table and key ("camera1.files"); `GAP` for an optional key that this
        directory needs all the same.
    remarks : mapping of str to str
        A sentence on a value or a gap: where the value comes from, or what may be meant.
    forms : mapping of str to str, optional
        Kind of a table that has several forms: ``{"mechanism": "rotation"}``. Default: the first.
    leave_out : collection of str
        Optional tables that are not written.
    head : str
        First lines, comments. Default: those of `erlif init`.
    full : bool
        Write optional keys as well, as comments with their meaning; else their names alone, and the
        meaning of gaps.

    Returns
    -------
    str
        TOML in which required keys without a value are gaps, and optional ones are comments.

    Examples
    --------
    >>> from erlif.io.settings import RunSettings
    >>> text = write_template(RunSettings, {"run.name": "straight bushing"}, {})
    >>> [line for line in text.splitlines() if "name =" in line]
    ['name = "straight bushing"', '# name = "80W-90"']
    """
    stem = (kind.__doc__ or "").removesuffix(".toml.")
    default = _HEAD if full else _SHORT_HEAD
    lines = [(head or default.format(stem=stem, name=f"{stem}.toml")).rstrip("\n")]
    seen: set[str] = set()
    unused: list[str] = []
    left_out = {(name,) for name in leave_out}
    for table in tables_of(kind):
        # a table with several forms is written in one of them; optional inner tables are
        # written in one line with the keys of the table around them
        inner = not table.required and len(table.path) > 1
        if table.title in seen or inner or table.path[:1] in left_out:
            continue
        if _form_of(table) != (forms or {}).get(table.title, _form_of(table)):
            continue
        seen.add(table.title)
        if full:
            lines += ["", *_table_lines(table, values, remarks)]
        elif (
            table.required
            or any(key.required for key in keys_of(table.kind))
            or any(name.startswith(f"{table.title}.") for name in values)
        ):
            lines += ["", *_short_lines(table, values, remarks)]
        else:
            unused.append(f"[{table.title}]")
    if unused:
        lines += ["", *_comment(f"Optional tables: {', '.join(unused)}.")]
    return "\n".join(lines) + "\n"


def write_example(
    kind: type[Settings], package: str, name: str, *, leave_out: Collection[str] = ()
) -> str:
    """Write a commented settings file that works as it is.

    Arguments that are not listed are those of `write_template`.

    Parameters
    ----------
    package, name : str
        Table of the package, see `erlif.core.tables.read_table`: the first lines under ``head``,
        the values under ``example`` by table and key.

    Returns
    -------
    str
        TOML.

    Examples
    --------
    >>> from erlif.io.settings import PlanSettings
    >>> write_example(PlanSettings, "erlif.planning", "plan.toml").count("[dye1]")
    1
    """
    table = read_table(package, name)
    values = {
        f"{part}.{key}": value
        for part, keys in table["example"].items()
        for key, value in keys.items()
    }
    return write_template(kind, values, {}, leave_out=leave_out, head=table["head"])


def _form_of(table: Table) -> str:
    """First kind of a table that has several forms; empty for any other table."""
    first = next(keys_of(table.kind), None)
    return first.choices[0] if first is not None and first.name == "kind" else ""


def _table_lines(
    table: Table, values: Mapping[str, Any], remarks: Mapping[str, str]
) -> Iterator[str]:
    """Heading of a table, and its keys with their comments."""
    if table.path:
        yield from _comment(table.meaning)
        yield from _comment(_arrow(remarks.get(table.title)))
        yield f"[{table.title}]"

    for n, key in enumerate(keys_of(table.kind)):
        place = f"{table.title}.{key.name}".lstrip(".")
        if n or table.path:
            yield ""
        yield from _key_lines(key, values.get(place), remarks.get(place))

    for name, example in _inner_tables(table):
        yield ""
        yield from _comment(meaning_of(table.kind, name))
        known = values.get(f"{table.title}.{name}")
        mark = "# " if known is None else ""
        yield f"{mark}{name} = {toml_value(example if known is None else known)}"


def _short_lines(
    table: Table, values: Mapping[str, Any], remarks: Mapping[str, str]
) -> Iterator[str]:
    """Heading of a table, the keys that have a value or need one, and names of the others."""
    if table.path:
        yield from _comment(_arrow(remarks.get(table.title)))
        yield f"[{table.title}]"
    optional = []
    for key in keys_of(table.kind):
        place = f"{table.title}.{key.name}".lstrip(".")
        value, remark = values.get(place), remarks.get(place)
        if value is None and not key.required:
            optional.append(key.name)
            continue
        *comment, line = _key_lines(key, value, remark)
        yield from comment if f'"{gap_text(key)}"' in line else _comment(_arrow(remark))
        yield line
    for name, _ in _inner_tables(table):
        if (known := values.get(f"{table.title}.{name}")) is not None:
            yield f"{name} = {toml_value(known)}"
    if optional:
        yield from _comment(f"optional: {', '.join(optional)}")


def _inner_tables(table: Table) -> Iterator[tuple[str, Any]]:
    """Names and examples of the optional tables inside a table, which are written as values."""
    for name, field in table.kind.model_fields.items():
        if table.path and tables_in(field.annotation) and not field.is_required():
            yield name, example_of(field)


def _key_lines(key: Key, value: Any, remark: str | None) -> Iterator[str]:
    """Comment and value of one key."""
    only = key.choices[0] if len(key.choices) == 1 and key.required else None
    value = only if value is None else value
    missing = value is GAP or (value is None and key.required)

    expected = ""
    if missing or len(key.choices) > 1:
        expected = f" {key.expected[0].upper()}{key.expected[1:]}."
    yield from _comment(f"{key.meaning}{expected}")
    yield from _comment(_arrow(remark))

    if missing:
        yield f"{key.name} = {toml_value(gap_text(key))}"
    elif value is not None:
        yield f"{key.name} = {toml_value(value)}"
    else:
        shown = key.default if key.default not in (None, "", []) else key.example
        yield f"# {key.name} = {toml_value(shown)}"


def _arrow(remark: str | None) -> str:
    """Mark a remark about this directory with an arrow; empty without a remark."""
    return f"-> {remark}" if remark else ""


def _comment(text: str) -> list[str]:
    """Lines of comment; a quoted value stays on one line."""
    whole = re.sub(r'"[^"]*"', lambda quoted: quoted[0].replace(" ", _NO_BREAK), text)
    lines = textwrap.wrap(  # a name of a file stays whole
        whole,
        WIDTH,
        initial_indent="# ",
        subsequent_indent="# ",
        break_long_words=False,
        break_on_hyphens=False,
    )
    return [line.replace(_NO_BREAK, " ") for line in lines]
