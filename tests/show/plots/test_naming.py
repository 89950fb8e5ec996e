"""Run, load and oil above a figure, and the reason of an empty map."""

import numpy as np
from matplotlib.figure import Figure

from erlif.core.flags import Flag
from erlif.show import plots
from erlif.show.plots.naming import describe_shares, name_film, reason_empty, run_line
from erlif.show.plots.style import in_style


def test_figure_names_run_load_and_oil(film, with_settings):
    assert run_line(film) == "a film <known> & small, 222 N, 0.12 Pa s"
    named = with_settings(('name = ""\nviscosity', 'name = "80W-90"\nviscosity'))
    assert run_line(named).endswith(", 80W-90")
    varying = film.assign(joint_load=("trigger", np.linspace(100.0, 250.0, film.sizes["trigger"])))
    assert "100 to 250 N" in run_line(varying)
    assert plots.film_over_cycle(film)[0].get_figure().get_suptitle() == run_line(film)


def test_a_run_named_after_its_folder_and_the_style_of_a_journal_have_no_title(film, with_settings):
    assert run_line(with_settings(("a film <known> & small", "run"))) == "222 N, 0.12 Pa s"
    for style, title in (("paper", ""), ("slides", run_line(film))):
        with in_style(style):
            assert plots.cycle_figure(film).get_suptitle() == title


def test_what_is_absent_is_left_out(film):
    assert run_line(film.drop_vars("joint_load")) == run_line(film)  # that of [joint]
    assert run_line(film.assign_attrs(settings="x").drop_attrs()) == ""
    figure = Figure()
    name_film(figure, film.drop_attrs())
    assert figure.get_suptitle() == ""


def test_long_name_is_shortened_and_a_dollar_sign_is_text(with_settings):
    name = "a $very$ long name of a run that nobody wants to read above a figure"
    line = run_line(with_settings(("a film <known> & small", name)))
    assert line.startswith("a $very$ long name")
    assert "…, 222 N" in line
    figure = plots.cycle_figure(with_settings(("a film <known> & small", "a $^$")))
    figure.draw_without_rendering()


def test_reason_gives_the_largest_shares():
    flags = np.full((10, 10), int(Flag.DIM), np.uint16)
    flags[:3] |= int(Flag.OUTSIDE_OVERLAP)
    assert reason_empty(flags) == "no valid pixel: 100 % dim, 30 % outside overlap"
    flags[0, 0] = 0
    assert reason_empty(flags) == ""
    assert describe_shares(np.eye(1 + len(Flag))[0]) == ""
