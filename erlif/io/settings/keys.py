"""The keys of a settings file, described: form, unit, default, bounds and meaning of each.

Messages, the template of `erlif init`, the JSON schema and docs/settings.md are made from these.
Form, bounds and default are those of the type of a field; its meaning is the text below it.
"""

from __future__ import annotations

import ast
import inspect
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from erlif.core.units import parse_quantity
from erlif.io.settings.toml import toml_value
from erlif.io.settings.values import Form, Settings

_PLAIN_FORMS: dict[Any, str] = {bool: "true or false", int: "integer", float: "number", str: "text"}

# Bounds in words, by the name that the package annotated_types gives them.
_BOUNDS = {"gt": "above", "ge": "from", "lt": "below", "le": "up to"}


@dataclass(frozen=True)
class Key:
    """One key of a table.

    Attributes
    ----------
    name : str
    form : str
        Kind of value, "length" or "integer".
    unit : str
        Unit in which a quantity is kept; empty for other values.
    example : Any
        Value as a user writes it.
    required : bool
    default : Any
        Value where the key is absent, as a user writes it; None where there is none.
    bounds : str
        Values allowed, "above 0"; empty where all are.
    choices : tuple[str, ...]
        Texts allowed; empty where the form is another one.
    meaning : str
    """

    name: str
    form: str
    unit: str
    example: Any
    required: bool
    default: Any
    bounds: str
    choices: tuple[str, ...]
    meaning: str

    @property
    def expected(self) -> str:
        """Form and example of the value, as one phrase.

        Examples
        --------
        >>> from erlif.io.settings import OpticsSettings
        >>> next(keys_of(OpticsSettings)).expected
        'length from 50 nm to 5 mm, for example "60 um"'
        """
        if self.choices:
            return "one of " + ", ".join(f'"{choice}"' for choice in self.choices)
        bounds = f" {self.bounds}" if self.bounds and not self.unit else ""
        return f"{self.form}{bounds}, for example {toml_value(self.example)}"


@dataclass(frozen=True)
class Table:
    """One table of a settings file.

    Attributes
    ----------
    path : tuple[str, ...]
        Names from the top, ("joint", "pin"); empty for the keys above the first table.
    kind : type[Settings]
    required : bool
        Whether the table around it, or the file, must hold it.
    meaning : str
    """

    path: tuple[str, ...]
    kind: type[Settings]
    required: bool
    meaning: str

    @property
    def title(self) -> str:
        """Name as it stands in the file, "joint.pin"."""
        return ".".join(self.path)


def tables_of(kind: type[Settings], path: tuple[str, ...] = ()) -> Iterator[Table]:
    """Yield the tables of a settings file in the order of the file.

    Parameters
    ----------
    kind : type of Settings
        ``RunSettings`` or ``FixtureSettings``.
    path : tuple of str
        Place of `kind` in the file.

    Returns
    -------
    iterator of Table
        `kind` itself first. A table that has several forms, such as [mechanism], comes once for
        each.

    Examples
    --------
    >>> from erlif.io.settings import FixtureSettings
    >>> [table.title for table in tables_of(FixtureSettings)][:4]
    ['', 'fixture', 'camera1', 'camera2']
    """
    yield Table(path, kind, True, _first_paragraph(kind))
    for name, field in kind.model_fields.items():
        for inner in tables_in(field.annotation):
            for table in tables_of(inner, (*path, name)):
                own = table.path == (*path, name)
                required = field.is_required() if own else table.required
                yield Table(table.path, table.kind, required, table.meaning)


def count_keys(kind: type[Settings]) -> int:
    """Number of keys and tables of a settings file: a version that rises with every new one.

    Returns
    -------
    int

    Examples
    --------
    >>> from erlif.io.settings import VogelSettings
    >>> count_keys(VogelSettings)
    3
    """
    return sum(len(table.kind.model_fields) for table in tables_of(kind))


def keys_of(kind: type[Settings]) -> Iterator[Key]:
    """Yield the keys of one table that hold a value; keys that hold a table are left out.

    Parameters
    ----------
    kind : type of Settings
        Class of the table.

    Returns
    -------
    iterator of Key
        In the order of the class.

    Examples
    --------
    >>> from erlif.io.settings import OpticsSettings
    >>> [(key.name, key.form, key.required) for key in keys_of(OpticsSettings)][:2]
    [('pixel_pitch', 'length from 50 nm to 5 mm', True), ('x_axis', 'text', False)]
    """
    for name, field in kind.model_fields.items():
        if not tables_in(field.annotation):
            yield _describe(kind, name, field)


def tables_in(annotation: Any) -> list[type[Settings]]:
    """Classes of tables in the type of a field; empty where the field holds a value.

    Parameters
    ----------
    annotation : type
        Type of the field, unions and Annotated included.

    Returns
    -------
    list of type
        One class, or several where a table has several forms.

    Examples
    --------
    >>> from erlif.io.settings import VogelSettings
    >>> tables_in(VogelSettings | None), tables_in(float)
    ([<class 'erlif.io.settings.surfaces.VogelSettings'>], [])
    """
    if isinstance(annotation, type):
        return [annotation] if issubclass(annotation, Settings) else []
    return [found for argument in get_args(annotation) for found in tables_in(argument)]


def meaning_of(kind: type[Settings], name: str) -> str:
    """Meaning of a key or of an inner table: the description of its field, or the text below it.

    Parameters
    ----------
    kind : type of Settings
        Its table.
    name : str
        Name in the table.

    Returns
    -------
    str
        Empty for a table that describes itself.

    Examples
    --------
    >>> from erlif.io.settings import OilSettings
    >>> meaning_of(OilSettings, "pressure_viscosity")
    'Pressure-viscosity coefficient of Barus.'
    """
    if described := kind.model_fields[name].description:
        return " ".join(described.split())
    for one in kind.__mro__:  # a pin has the keys of any part
        text = issubclass(one, Settings) and _texts_below_fields(one.__module__).get(
            (one.__name__, name)
        )
        if text:
            return text
    return ""


@cache
def _texts_below_fields(module: str) -> dict[tuple[str, str], str]:
    """Text below each field of a module, by class and field."""
    texts = {}  # read from the source when it is asked for: classes do not keep it
    classes = ast.parse(inspect.getsource(sys.modules[module])).body
    for table in (one for one in classes if isinstance(one, ast.ClassDef)):
        for pair in pairwise(table.body):
            match pair:
                case ast.AnnAssign(ast.Name(field)), ast.Expr(ast.Constant(str(text))):
                    texts[table.name, field] = " ".join(text.split())
    return texts


def example_of(field: FieldInfo) -> Any:
    """Example of a field as a user writes it; None where that of its type serves."""
    return next(iter(field.examples or ()), None)


def _describe(kind: type[Settings], name: str, field: FieldInfo) -> Key:
    """Key of a field."""
    plain, metadata = _unwrap(field)
    own = example_of(field)
    form = next((item for item in metadata if isinstance(item, Form)), None)
    choices = get_args(plain) if get_origin(plain) is Literal else ()

    default = None if field.is_required() else field.default
    if default is not None and form is not None and form.unit and not isinstance(default, str):
        # "0 deg" as a user writes it, rather than "0 rad" as it is kept
        written = [text for text in (own, form.example) if isinstance(text, str)]
        same = (text for text in written if parse_quantity(text, form.unit) == default)
        default = next(same, f"{default:g} {form.unit}")
    elif isinstance(default, tuple):
        default = list(default)

    # an example of the field itself is closer to its meaning than that of its type
    examples = [own, form.example if form else None, default, *choices]
    return Key(
        name=name,
        form="text"
        if choices
        else form.name
        if form
        else _PLAIN_FORMS.get(plain, "pair of numbers"),
        unit=form.unit if form else "",
        example=next((example for example in examples if example is not None), None),
        required=field.is_required(),
        default=default,
        bounds=_describe_bounds(metadata),
        choices=choices,
        meaning=meaning_of(kind, name),
    )


def _unwrap(field: FieldInfo) -> tuple[Any, list[Any]]:
    """Type of a value without None, and all that its annotations hold."""
    plain: Any = field.annotation
    metadata = list(field.metadata)
    if get_origin(plain) in (Union, UnionType):
        plain = next(part for part in get_args(plain) if part is not type(None))
    if hasattr(plain, "__metadata__"):
        metadata += plain.__metadata__
        plain = plain.__origin__

    # bounds within Annotated stand in a FieldInfo of their own
    inner = [item for part in metadata if isinstance(part, FieldInfo) for item in part.metadata]
    return plain, [*metadata, *inner]


def _describe_bounds(metadata: list[Any]) -> str:
    """Bounds of a number in words."""
    return " ".join(
        f"{words} {getattr(item, bound):g}"
        for item in metadata
        for bound, words in _BOUNDS.items()
        if hasattr(item, bound)
    )


def _first_paragraph(kind: type[Settings]) -> str:
    return " ".join((kind.__doc__ or "").strip().split("\n\n")[0].split())
