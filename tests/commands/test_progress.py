"""Progress on the terminal and elsewhere."""

import io
import sys

import numba

from erlif.commands.progress import ANNOUNCEMENT, announced_compiling, echo_above, show_progress


class Terminal(io.StringIO):
    """A stream that claims to be a terminal."""

    def isatty(self) -> bool:
        return True


def test_elsewhere_each_piece_of_work_has_one_line_when_it_is_finished(capsys):
    with show_progress() as progress:
        for done in (1, 2, 3, 3):
            progress("film", done, 3)
        progress("ratio", 1, 2)
    assert capsys.readouterr().err == "film: 3 done\n"


def test_a_terminal_shows_how_far_the_work_is(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with show_progress() as progress:
        progress("film", 1, 4)
        progress("film", 4, 4)
    assert "1/4" in terminal.getvalue()
    assert "4/4" in terminal.getvalue()
    assert "done" not in terminal.getvalue()


def test_a_line_of_result_stands_above_the_bar(monkeypatch, capsys):
    """Both streams end on one screen: the bar is cleared, and drawn again below the line."""
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(sys, "stdout", terminal)
    with show_progress() as progress:
        progress("film", 1, 4)
        echo_above("monday: finished")
        progress("film", 2, 4)
    shown = terminal.getvalue()
    assert "\rmonday: finished\n" in shown
    assert shown.index("1/4") < shown.index("monday: finished") < shown.index("2/4")


def kernels():
    """Two kernels that no cache holds; the second has a function of numba inside."""
    return numba.njit(lambda x: x + 1), numba.njit(lambda x: max(x, 0.5) + min(x, 2.5))


def test_the_first_kernel_is_announced_and_no_other(capsys):
    one, two = kernels()
    with announced_compiling():
        assert capsys.readouterr().err == ""
        assert (one(1.0), two(1.0)) == (2.0, 2.0)
        assert one(1) == 2  # another type of argument
    assert capsys.readouterr().err == f"{ANNOUNCEMENT}\n"
