"""Figures of endurance tests."""

import numpy as np
import pytest
from scenes.pictures import picture, without_texts

import erlif.show.plots.style
from erlif.core.errors import EnduranceError
from erlif.joint.endurance import FailureLoad, compare_designs
from erlif.joint.plots import (
    designs_figure,
    endurance_figure,
    failure_figure,
    name_overviews,
    quantity_over_test,
    write_endurance_figures,
)
from erlif.joint.plots.example import example_test


def test_onset_and_stages_are_marked():
    result = example_test()
    line, mark = quantity_over_test(result, "friction")
    assert mark.get_xdata()[0] == pytest.approx(result.onset.time / 60)
    drawn = np.isfinite(line.get_ydata())
    assert drawn.sum() == sum(stage.last - stage.first + 1 for stage in result.loaded)


def test_the_figure_of_the_failure_shows_the_interval_of_the_onset():
    result = example_test()
    _, friction = failure_figure(result).axes
    before = friction.lines[2]
    assert before.get_ydata()[0] == pytest.approx(result.onset.friction_before)
    assert friction.get_xlim()[0] > result.onset.earliest - 100
    with pytest.raises(EnduranceError, match="survived"):
        failure_figure(example_test(galls=False))


def test_no_overview_has_the_name_of_another_figure():
    names = ["run", "run_load", "run_load_all", "designs"]
    panels = {f"{name}_{kind}.png" for name in names for kind in ("load", "friction", "failure")}
    overviews = name_overviews(names)
    assert len({*overviews.values(), *panels, "designs.png"}) == 4 + len(panels) + 1
    assert overviews["run"] == "run.png"


def test_friction_is_drawn_a_second_time_without_the_jump(tmp_path, monkeypatch):
    drawn = {}
    monkeypatch.setattr(
        erlif.show.plots.style,
        "save_figure",
        lambda figure, path: drawn.update({path.name: figure}),
    )
    result = example_test()
    write_endurance_figures(result, tmp_path)
    whole, before = drawn["example_friction.png"].axes
    after = result.onset.friction_before + result.onset.rise
    assert before.get_ylim()[1] < after < whole.get_ylim()[1]


@picture
def test_picture_of_a_test():
    return without_texts(endurance_figure(example_test()))


def test_runs_that_survived_are_drawn_open_and_the_table_states_the_interval():
    uncut = [FailureLoad(load, 0.1, load - 18e3, True, 6) for load in (106e3, 124e3, 124e3)]
    undercut = [FailureLoad(160e3, 0.1, 142e3, True, 8)] * 2
    undercut.append(FailureLoad(160e3, 0.1, 160e3, False, 8))
    compared = compare_designs(uncut, undercut, names=("uncut", "undercut"))
    figure = designs_figure(compared, uncut, undercut)
    runs, table = figure.axes
    open_marks = [line for line in runs.lines if line.get_markerfacecolor() == "white"]
    assert [[*line.get_xdata()] for line in open_marks] == [[], [160.0], []]  # and their key
    assert [text.get_text() for text in runs.get_yticklabels()] == ["uncut", "undercut"]
    figure.draw_without_rendering()
    cells = {cell.get_text(): cell for cell in table.tables[0].get_celld().values()}
    written = [text.get_text() for text in cells]
    assert f"{compared.low:.2f} to {compared.high:.2f} (lognormal)" in written
    assert "3 runs, 2 failures" in written
    assert any("of so few runs" in text for text in written)
    for text, cell in cells.items():  # rows were half as high as the letters in them
        assert text.get_window_extent().height < 0.8 * cell.get_window_extent().height
        assert text.get_window_extent().width < 0.95 * cell.get_window_extent().width
