"""Every message of an error ends with what to do."""

import ast
import re
from pathlib import Path

from scenes.messages import STEPS

import erlif

SOURCES = sorted(Path(erlif.__file__).parent.rglob("*.py"))

ERRORS = (
    *("ErlifError", "ConfigError", "FrameError", "EncoderError", "RegistrationError"),
    *("CalibrationError", "OutputError", "ClusterError", "ModelError"),
    *("EnduranceError", "table.use.error"),
)

COMPLETED = ("erlif/io/readers/", "erlif/models/", "erlif/joint/models/")
"""Bare reasons that the ingest completes; functions of numbers, whose condition is the step."""

ELSEWHERE = (
    *("_cure", "cure", "fixed", "hint", "todo", "listed", "_SAME", "_MAKE_ONE", "make_one"),
    *("reason", "with_advice", "_refusal", "_fault_message", "error"),
)
"""Names that stand at the end of a message and hold its step."""

BARE = (
    *("the file has changed while it was read", "it has no channels"),  # completed by the caller
    *("he same command resumes", "dask writes it with", "With local:"),
)
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
    """Place and text of all errors that are made in the program."""
    found = []
    for path in SOURCES:
        place = "erlif/" + path.relative_to(Path(erlif.__file__).parent).as_posix()
        if place.startswith(COMPLETED):
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            made = isinstance(node, ast.Call) and ast.unparse(node.func) in ERRORS
            if made and node.args:
                found.append((f"{place}:{node.lineno}", skeleton(node.args[0])))
    return found


def test_every_message_ends_with_what_to_do():
    found = messages()
    assert len(found) > 150
    lacking = [f"{place}: {text}" for place, text in found if not names_a_step(text)]
    assert not lacking, "\n".join(lacking)
