"""The code of the page on notebooks runs on a film."""

import re
import shutil
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

PAGE = Path(__file__).parents[2] / "docs" / "notebook.md"
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


def test_code_of_the_page_runs_as_it_stands(film, tmp_path, monkeypatch, capsys):
    shutil.copy(film, tmp_path)
    monkeypatch.chdir(tmp_path)
    names = {}
    try:
        for block in BLOCKS:
            if "erlif.process(" not in block:  # needs the sample run, and a minute
                exec(block, names)
    finally:
        plt.close("all")
        names["film"].close()

    # the message that the page shows
    shown = capsys.readouterr().out.strip()
    assert shown in PAGE.read_text(encoding="utf-8")
    assert names["random"] < names["found"].film_mean_std_random.max()
    assert names["share"] == pytest.approx(float(names["film"].valid_pixels[3]) / (96 * 128))
