"""The tutorial notebook: it runs, it finds the simulated film, and it is stored without outputs."""

import json
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import pytest

NOTEBOOK = Path(__file__).parents[2] / "docs" / "tutorial.ipynb"
CELLS = [
    cell
    for cell in json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    if cell["cell_type"] == "code"
]


@pytest.mark.slow
def test_notebook_runs_and_finds_the_simulated_film(tmp_path, monkeypatch):
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    names = {}
    try:
        for n, cell in enumerate(CELLS):
            exec(compile("".join(cell["source"]), f"tutorial, code cell {n}", "exec"), names)
    finally:
        plt.close("all")

    # The shares of a normal distribution, 68.3 and 95.4 %; neighbouring pixels share errors.
    assert names["within_one"] == pytest.approx(0.683, abs=0.02)
    assert names["within_two"] == pytest.approx(0.954, abs=0.015)
    assert abs(names["exponent"] - 0.62) < 3 * names["exponent_std"]
