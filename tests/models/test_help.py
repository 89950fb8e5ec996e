"""help() of every public name of the models has all arguments, fields and units."""

import ast
import builtins
import doctest
import inspect
import re
import symtable
from dataclasses import fields, is_dataclass

from scenes.formulas import public_names

NUMBER = re.compile(r"\b(float|array|Values)\b")
# flags, other objects, and text in arrays
NO_NUMBER = re.compile(r"\b(bool|Groove|FILM_REGIMES)\b")
UNIT = re.compile(r"\[[^\[\]]+\]")


PUBLIC = dict(public_names())


def entries(doc, title):
    """Type and text of each entry of a section of a docstring."""
    lines = (inspect.cleandoc(doc or "") + "\n").split("\n")
    heads = [k for k, line in enumerate(lines[:-1]) if re.fullmatch("-+", lines[k + 1])]
    starts = [k for k in heads if lines[k] == title]
    found, names = {}, []
    for k in starts:
        end = next((head for head in heads if head > k), len(lines))
        for line in lines[k + 2 : end]:
            match = re.match(r"([\w, ]+?) : (.*)$", line)
            if match:
                names = [name.strip() for name in match[1].split(",")]
                found |= {name: [match[2], ""] for name in names}
            elif line.strip():
                for name in names:
                    found[name][1] += " " + line.strip()
    return found


def test_every_number_has_its_unit():
    assert len(PUBLIC) > 180
    without = [
        f"{name}, {section}: {entry}"
        for name, value in PUBLIC.items()
        for section in (("Attributes",) if inspect.isclass(value) else ("Parameters", "Returns"))
        for entry, (kind, text) in entries(value.__doc__, section).items()
        if NUMBER.search(kind) and not NO_NUMBER.search(kind + text) and not UNIT.search(text)
    ]
    assert not without


def members(value):
    """Arguments of a function, or public fields of a class, and the section that has them."""
    if not inspect.isclass(value):
        return set(inspect.signature(value).parameters) - {"self"}, "Parameters"
    names = {field.name for field in fields(value)} if is_dataclass(value) else set()
    names |= set(getattr(value, "_fields", ()))
    return {name for name in names if not name.startswith("_")}, "Attributes"


def test_every_argument_and_field_is_there():
    missing = []
    for name, value in PUBLIC.items():
        wanted, section = members(value)
        missing += [f"{name}: {one}" for one in wanted - set(entries(value.__doc__, section))]
    assert not missing


def names_from_elsewhere(doc):
    """Names that the examples of a docstring use and neither make nor import."""
    examples = doctest.DocTestParser().get_examples(doc or "")
    source = "".join(example.source for example in examples)
    table = symtable.symtable(source, "examples", "exec")
    made = {one.get_name() for one in table.get_symbols() if one.is_assigned() or one.is_imported()}
    used = {node.id for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Name)}
    inner = {one for child in table.get_children() for one in child.get_identifiers()}
    return used - made - inner - set(dir(builtins))


def test_examples_run_once_the_name_itself_and_numpy_are_imported():
    missing = {
        name: found
        for name, value in PUBLIC.items()
        if (found := names_from_elsewhere(value.__doc__) - {"np", name.rpartition(".")[2]})
    }
    assert not missing
