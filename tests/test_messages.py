"""Every message of an error ends with what to do."""

import ast
import re
import tomllib
from pathlib import Path

from scenes.messages import STEPS

import erlif

SOURCES = sorted(Path(erlif.__file__).parent.rglob("*.py"))

ERRORS = (
    *("ErlifError", "ConfigError", "FrameError", "EncoderError", "RegistrationError"),
    *("CalibrationError", "OutputError", "ClusterError", "ModelError"),
    "EnduranceError",
)

COMPLETED = {
    "erlif/io/readers/": "bare reasons, which erlif.ingest.images.with_advice completes",
    "erlif/models/": "functions of numbers: the condition on the argument is the step",
}
"""Folders whose messages need no step, with the reason."""

ELSEWHERE = {
    "_cure": "the advice of the fault",
    "cure": "the advice of the fault",
    "fixed": "where the speed is given in [mechanism]",
    "hint": "the next step, by what lies in the directory",
    "todo": "alignment and depth that fit",
    "listed": "the keys to correct, below the message that asks for it",
    "_SAME": "the same versions on both machines",
    "_MAKE_ONE": "the command that makes a film",
    "make_one": "the command that makes a film",
    "reason": "a reason with its advice",
    "with_advice": "completes a bare reason of a reader",
    "_refusal": "the option for links that leave the directory",
    "_fault_message": "the options for unreadable frames",
    "error": "the message of a reason that is complete itself",
}
"""Names that stand at the end of a message, and what they hold."""

BARE = {
    "the file has changed while it was read": "a reason within read_content, completed there",
    "it has no channels": "a reason within find_pages, completed there",
    "The same command resumes": "the step is the command itself",
    "the same command resumes": "the step is the command itself",
    "dask writes it with": "the command follows",
    "With local:": "the option follows",
}
"""Messages with another form of a next step."""


def skeleton(node: ast.AST) -> str:
    """Text of a message; what is filled in stands in braces."""
    match node:
        case ast.Constant():
            return str(node.value)
        case ast.JoinedStr():
            return "".join(map(skeleton, node.values))
        case ast.FormattedValue():
            return "{" + ast.unparse(node.value) + "}"
        case ast.BinOp():
            return skeleton(node.left) + skeleton(node.right)
        case _:
            return "{" + ast.unparse(node) + "}"


def names_a_step(message: str) -> bool:
    """Whether a sentence after the first begins with a step, or the message ends with one."""
    sentences = re.split(r"(?<=[.;:?}])\s+", message)
    first = (re.match(r"[A-Za-z]+", sentence) for sentence in sentences[1:])
    if any(word and word.group().lower() in STEPS for word in first):
        return True
    ends = message.rstrip(".").endswith("}")
    held = [name for name in re.findall(r"\{\(?([A-Za-z_]+)", message) if name in ELSEWHERE]
    after_or = re.search(r"\bor ([a-z]+)\b", message)
    return bool(
        (ends and held)
        or (after_or and after_or.group(1) in STEPS)
        or any(text in message for text in BARE)
    )


def messages() -> list[tuple[str, str]]:
    """Place and text of all errors that are made in the program, and of tables of refusals."""
    found = [
        (f"{path.name} [{name}]", entry["text"])
        for path in sorted(Path(erlif.__file__).parent.rglob("refusals.toml"))
        for name, entry in tomllib.loads(path.read_text(encoding="utf-8")).items()
    ]
    for path in SOURCES:
        place = "erlif/" + path.relative_to(Path(erlif.__file__).parent).as_posix()
        if place.startswith(tuple(COMPLETED)):
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            named = isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
            if named and node.func.id in ERRORS and node.args:
                found.append((f"{place}:{node.lineno}", skeleton(node.args[0])))
    return found


def test_every_message_ends_with_what_to_do():
    found = messages()
    assert len(found) > 150
    lacking = [f"{place}: {text}" for place, text in found if not names_a_step(text)]
    assert not lacking, "\n".join(lacking)
