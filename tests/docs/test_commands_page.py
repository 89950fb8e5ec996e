"""docs/commands.md, held to the program."""

from pathlib import Path

from scenes.scripts import load_script

from erlif.commands.main import COMMANDS, main

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "commands.md").read_text(encoding="utf-8")


def test_the_committed_page_is_the_generated_one():
    assert load_script(DOCS / "make_commands.py").render() == PAGE, "python docs/make_commands.py"


def test_every_option_stands_in_the_section_of_its_command():
    sections = {part.partition("\n")[0]: part for part in PAGE.split("\n### erlif ")[1:]}
    assert list(sections) == [name for names in COMMANDS.values() for name in names]
    missing = [
        (name, option)
        for name, section in sections.items()
        for parameter in main.commands[name].params
        for option in parameter.opts
        if option.startswith("-") and option not in section
    ]
    assert not missing
