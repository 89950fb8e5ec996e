"""Two designs by their loads at failure, as drawn."""

from erlif.joint.endurance import FailureLoad, compare_designs
from erlif.show.plots import designs_figure


def test_runs_that_survived_are_drawn_open_and_the_table_states_the_interval():
    uncut = [FailureLoad(load, 0.1, load - 18e3, True, 6) for load in (106e3, 124e3, 124e3)]
    undercut = [FailureLoad(160e3, 0.1, 142e3, True, 8)] * 2
    undercut.append(FailureLoad(160e3, 0.1, 160e3, False, 8))
    compared = compare_designs(uncut, undercut, names=("uncut", "undercut"))
    runs, table = designs_figure(compared, uncut, undercut).axes
    open_marks = [line for line in runs.lines if line.get_markerfacecolor() == "white"]
    assert [line.get_xdata().tolist() for line in open_marks] == [[], [160.0]]
    assert [text.get_text() for text in runs.get_yticklabels()] == ["uncut", "undercut"]
    written = [cell.get_text().get_text() for cell in table.tables[0].get_celld().values()]
    assert f"{compared.low:.2f} to {compared.high:.2f} (lognormal)" in written


def test_rows_of_the_table_hold_their_text():
    """Rows were half as high as the letters in them."""
    failed = [FailureLoad(load, 0.1, load - 18e3, True, 6) for load in (106e3, 124e3)]
    one = [FailureLoad(160e3, 0.1, 142e3, True, 8), FailureLoad(160e3, 0.1, 160e3, False, 8)]
    figure = designs_figure(compare_designs(failed, one, names=("uncut", "undercut")), failed, one)
    figure.draw_without_rendering()
    cells = list(figure.axes[1].tables[0].get_celld().values())
    assert any(cell.get_text().get_text() == "2 runs, 1 failure" for cell in cells)
    for cell in cells:
        assert cell.get_text().get_window_extent().height < 0.8 * cell.get_window_extent().height
