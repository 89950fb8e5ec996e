"""Lines of 80 columns."""

import click

from erlif.commands.lines import list_notes, wrap
from erlif.core.notes import Level, Note

LONG = "word " * 30


def test_a_row_keeps_its_columns_and_a_table_its_line():
    lines = wrap(f"  film  {LONG}").splitlines()
    assert all(len(line) <= 80 for line in lines)
    assert [line.index("word") for line in lines] == [8] * len(lines)
    table = f"  film  {LONG} 1.0  2.0"
    assert wrap(table) == table


def test_words_are_those_of_the_text():
    assert wrap(f"See {LONG}").split() == f"See {LONG}".split()
    assert wrap("a\n  b: c\n\nd") == "a\n  b: c\n\nd"


def shown(notes, verbose):
    with click.Context(click.Command("check")) as context:
        context.meta["erlif.verbose"] = verbose
        return list(list_notes(notes, "-v"))


def test_the_first_note_of_a_subject_and_warnings_are_whole():
    notes = [
        Note(Level.NOTE, "light", LONG),
        Note(Level.NOTE, "light", "even"),
        Note(Level.WARNING, "light", LONG),
        Note(Level.WARNING, "light", "dim"),
    ]
    first, warning, other, more = shown(notes, 0)
    assert first.split() == f"note light: {LONG}".split()
    assert all(len(line) <= 80 for line in first.splitlines())
    assert warning.split() == f"warning light: {LONG}".split()
    assert (other, more) == ("warning light: dim", "more    1 note: -v")
    assert " ".join(shown(notes, 1)).split().count("word") == 60
