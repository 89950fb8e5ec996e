"""What a notebook shows: one picture for each figure."""

import nbformat
import pytest
from nbclient import NotebookClient

from erlif.show import plots

CELLS = (
    "import erlif\nfilm = erlif.plots.example_film()",
    "erlif.show.plots.thickness_map(film, trigger=1)",
    "erlif.show.plots.film_over_cycle(film)",
    "erlif.show.plots.cycle_figure(film)",
    "import matplotlib.pyplot as plt\nfig, ax = plt.subplots()\nerlif.plots.pin_orbit(film, ax=ax)",
)


@pytest.mark.slow
def test_each_figure_is_shown_once(monkeypatch):
    """Of one panel, of several, and drawn into axes of the user."""
    monkeypatch.delenv("MPLBACKEND", raising=False)
    cells = [nbformat.v4.new_code_cell(source) for source in CELLS]
    notebook = nbformat.v4.new_notebook(cells=cells)
    NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    shown = [sum("image/png" in out.get("data", {}) for out in cell.outputs) for cell in cells]
    assert shown == [0, 1, 1, 1, 1]


def test_completion_lists_what_draws_and_nothing_else():
    listed = dir(plots)
    assert {"thickness_map", "cycle_figure", "write_figures"} <= set(listed)
    assert not {
        "find_run",
        "missing_figures",
        "example_film",
        "predicted_map",
        "lazy_loader",
    } & set(listed)
    assert all(hasattr(plots, name) for name in plots.__all__)
