"""Write docs/commands.md, all commands with their options: ``python docs/make_commands.py``.

The texts are those of ``--help``, taken from the program.
"""

from __future__ import annotations

import inspect
import re
import textwrap
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

import click

from erlif.commands.main import COMMANDS, main

PAGE = Path(__file__).with_name("commands.md")

INTRODUCTION = """\
<!-- made by docs/make_commands.py; a test holds it to the program -->

# Commands and options

`erlif COMMAND --help` prints the same text. A quantity has a unit, `"51 cm"`. `-o` is the path of
what a command writes. `-v`, before or behind the name of the command, prints all notes, decisions,
times and memory, `-vv` details; `erlif --version` prints the version. Bad input ends with one
message and status 2. [Shell completion](shell_completion.md) completes commands,
options and file names.
"""


def render() -> str:
    """The page as Markdown."""
    lines = [INTRODUCTION]
    with click.Context(main, info_name="erlif") as parent:
        records = {
            name: list(option_records(main.commands[name], parent))
            for names in COMMANDS.values()
            for name in names
        }
        counts = Counter(record for each in records.values() for record in each)
        shared = [record for record, count in counts.items() if count >= 3]
        lines += ["## Options of several commands", "", *options_list(shared)]
        for group, names in COMMANDS.items():
            lines += [f"## {group}", ""]
            for name in names:
                lines += command_section(main.commands[name], parent)
                lines += options_list(one for one in records[name] if one not in shared)
                if also := [f"`{one[0]}`" for one in records[name] if one in shared]:
                    lines += [f"Also {', '.join(also)}.", ""]
    return "\n".join(lines).rstrip("\n") + "\n"


def command_section(command: click.Command, parent: click.Context) -> Iterator[str]:
    """Usage, description and example of a command."""
    with click.Context(command, info_name=command.name, parent=parent) as context:
        usage = " ".join([context.command_path, *command.collect_usage_pieces(context)])
    yield from (f"### erlif {command.name}", "", f"`{usage}`", "")
    for paragraph in inspect.cleandoc(command.help or "").split("\n\n"):
        yield from (*render_paragraph(paragraph), "")


def option_records(command: click.Command, parent: click.Context) -> Iterator[tuple[str, str]]:
    """Names and meaning of each option of a command, but for its help."""
    with click.Context(command, info_name=command.name, parent=parent) as context:
        for option in command.get_params(context):
            record = option.get_help_record(context)
            if record and isinstance(option, click.Option) and "--help" not in option.opts:
                yield record


def options_list(records: Iterable[tuple[str, str]]) -> Iterator[str]:
    """Options, each with its meaning below."""
    for name, meaning in records:
        yield from (f"`{name}`", f": {escape(meaning)}", "")


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
    """A text with its options as code."""
    return re.sub(r"(?<![`\w-])(--[a-z][\w-]*)", r"`\1`", text) if "`" not in text else text


if __name__ == "__main__":
    PAGE.write_text(render(), encoding="utf-8")
