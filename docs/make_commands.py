"""Write docs/commands.md, all commands with their options: ``python docs/make_commands.py``.

The texts are those of ``--help``, taken from the program.
"""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Iterator
from pathlib import Path

import click

from erlif.commands.main import COMMANDS, main

PAGE = Path(__file__).with_name("commands.md")

INTRODUCTION = """\
<!-- made by docs/make_commands.py; a test holds it to the program -->

# Commands and options

`erlif COMMAND --help` prints the same text. A quantity has a unit, `"51 cm"`. `erlif -v COMMAND`
shows decisions, times and memory, `-vv` details; `erlif --version` prints the version. Bad input
ends with one message and status 2. [Shell completion](shell_completion.md) completes commands,
options and file names.
"""


def render() -> str:
    """The page as Markdown."""
    lines = [INTRODUCTION]
    with click.Context(main, info_name="erlif") as parent:
        for group, names in COMMANDS.items():
            lines += [f"## {group}", ""]
            for name in names:
                lines += command_section(main.commands[name], parent)
    return "\n".join(lines).rstrip("\n") + "\n"


def command_section(command: click.Command, parent: click.Context) -> Iterator[str]:
    """Usage, description, example and options of a command."""
    with click.Context(command, info_name=command.name, parent=parent) as context:
        usage = " ".join([context.command_path, *command.collect_usage_pieces(context)])
        yield from (f"### erlif {command.name}", "", f"`{usage}`", "")
        for paragraph in inspect.cleandoc(command.help or "").split("\n\n"):
            yield from (*render_paragraph(paragraph), "")
        yield from ("| option | meaning |", "|---|---|")
        for option in command.get_params(context):
            record = option.get_help_record(context)
            if record and isinstance(option, click.Option) and "--help" not in option.opts:
                name = record[0].replace("|", r"\|")
                yield f"| `{name}` | {escape(record[1])} |"
        yield ""


def render_paragraph(paragraph: str) -> Iterator[str]:
    """A paragraph of a help; one that keeps its lines, after a line \\b, is an example."""
    if not paragraph.startswith("\b"):
        yield escape(" ".join(paragraph.split()))
        return
    lines = textwrap.dedent(paragraph.removeprefix("\b\n")).splitlines()
    if lines[0].endswith(":"):
        yield from (lines.pop(0), "")
    yield from ("```sh", *textwrap.dedent("\n".join(lines)).splitlines(), "```")


def escape(text: str) -> str:
    """A text for a table, with its options and file names as code."""
    text = text.replace("|", r"\|")
    return re.sub(r"(?<![`\w-])(--[a-z][\w-]*)", r"`\1`", text) if "`" not in text else text


if __name__ == "__main__":
    PAGE.write_text(render(), encoding="utf-8")
