"""The look of the figures and their files: nothing depends on the day or changes the caller."""

import subprocess
import sys

import matplotlib
import matplotlib.pyplot as plt
import matplotlib.style
import numpy.testing as npt
import pytest
from matplotlib.figure import Figure

from erlif.core.errors import ConfigError
from erlif.show import plots
from erlif.show.plots.style import figure_bytes, letter, new_figure, plain_log_ticks


def test_file_does_not_change_with_the_time(calibration, monkeypatch):
    """The build time that matplotlib takes from the environment does not reach the file."""
    figure = plots.calibration_figure(calibration)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    early = figure_bytes(figure, kind="pdf")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")
    assert figure_bytes(figure, kind="pdf") == early


def test_settings_of_the_caller_are_left_alone(film):
    before = dict(matplotlib.rcParams)
    plots.thickness_map(film, trigger=0)
    plots.calibration_figure(plots.example_calibration())
    assert dict(matplotlib.rcParams) == before


def test_drawing_and_viewer_are_loaded_only_when_needed_and_open_no_window():
    """One new process for both, as loading erlif takes most of the time."""
    code = (
        "import sys, erlif, erlif.pipeline, erlif.show.view, erlif.commands.main\n"
        "late = {'matplotlib', 'tornado', 'tomlkit', 'erlif.show.view.handlers'}\n"
        "assert not late & set(sys.modules), late & set(sys.modules)\n"
        "import erlif.show.plots, erlif.show.report\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_letter_of_a_panel_is_bold_beside_a_title_as_well():
    """Signs of mathematics in the title stay text."""
    for title in ("", "a title in $ and in $"):
        ax = new_figure().add_subplot(title=title)
        letter(ax, "c")
        drawn = ax.get_title(loc="left")
        assert drawn.startswith(r"$\mathbf{(c)}$")
        assert title.replace("$", r"\$") in drawn
        ax.get_figure().draw_without_rendering()


def test_style_of_the_caller_is_kept(film):
    """A larger text takes lines and markers with it."""
    with matplotlib.rc_context({"font.size": 14.0}):
        image = plots.thickness_map(film, trigger=0)
        assert image.axes.title.get_fontsize() == 14.0
        assert image.axes.spines["left"].get_linewidth() == pytest.approx(1.2)
    with matplotlib.style.context("erlif.show.plots.paper"):
        ax = plots.film_over_cycle(film)[0].axes
    npt.assert_allclose(25.4 * ax.get_figure().get_figwidth(), 85, atol=0.01)
    assert ax.xaxis.label.get_fontsize() == 8.0


def test_figure_of_several_panels_shows_itself_and_fits_into_another(film):
    figure = plots.cycle_figure(film)
    assert figure._repr_png_()[:4] == b"\x89PNG"
    whole = Figure(figsize=(8, 4), layout="constrained")
    left, right = whole.subfigures(1, 2)
    assert plots.cycle_figure(film, figure=left) is left
    assert plots.pin_figure(film, figure=right) is right
    assert figure_bytes(right, kind="png", dpi=50)[:4] == b"\x89PNG"
    assert len(whole.axes) == 6


def test_a_panel_that_is_not_drawn_leaves_no_figure(film):
    before = plt.get_fignums()
    with pytest.raises(ConfigError):
        plots.pin_orbit(film.drop_vars("pin_displacement", errors="ignore"))
    assert plt.get_fignums() == before


@pytest.mark.parametrize("ends", [(0.991, 1.008), (2.44, 2.56), (0.8, 2.7), (0.3, 14.0)])
def test_a_logarithmic_axis_of_any_range_has_ticks(ends):
    ax = new_figure().add_subplot(yscale="log", ylim=ends)
    plain_log_ticks(ax)
    assert sum(ends[0] <= place <= ends[1] for place in ax.get_yticks()) >= 3
