"""What pages show as printed is what their commands print."""

import re
import shlex
import shutil
from pathlib import Path

import cv2
import matplotlib.pyplot as plt
import numpy as np
import pytest
from click.testing import CliRunner
from scenes.checkout import copy_part

from erlif.commands.main import main

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
BLOCK = re.compile(r"```(\w+)\n(.*?)```", re.DOTALL)


def read(name: str) -> str:
    return (DOCS / name).read_text(encoding="utf-8")


def printed(commands: str) -> str:
    """Output of all commands, each break of a line as one space."""
    texts = []
    for line in filter(None, commands.replace("\\\n", " ").splitlines()):
        name, *words = shlex.split(line, comments=True)
        assert name == "erlif"
        words, into = (words[:-2], words[-1]) if ">" in words else (words, None)
        found = CliRunner().invoke(main, words, catch_exceptions=False)
        assert found.exit_code == 0, found.output
        if into is None:
            texts.append(found.stdout)
        else:
            Path(into).write_text(found.stdout, encoding="utf-8")
    return " ".join("".join(texts).split())


@pytest.mark.slow
@pytest.mark.usefixtures("maps_alone")
@pytest.mark.parametrize("name", ["friction.md", "planning.md", "compare.md"])
def test_the_first_commands_of_a_page_print_what_it_shows(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = BLOCK.findall(read(name))
    place = next(k for k, (kind, _) in enumerate(blocks) if kind == "text")
    for kind, code in blocks[:place]:
        if kind == "python":
            exec(code, {})
    found = printed(blocks[place - 1][1])
    lines = blocks[place][1].splitlines()
    assert [line for line in lines if " ".join(line.split()) not in found] == []


@pytest.mark.slow
def test_the_sample_gives_text_and_picture_of_the_readme(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for part in ("data_samples/thick_oil", "calibration"):
        copy_part(part, Path(part))
    film = "data_samples/thick_oil/film.nc"
    found = printed("erlif process data_samples/thick_oil --overwrite")
    for page in ("../README.md", "speed.md"):
        shown = next(code for kind, code in BLOCK.findall(read(page)) if kind == "text")
        lines = shown.splitlines()
        assert [line for line in lines if " ".join(line.split()) not in found] == []

    printed(f"erlif figures {film} --only film_against_speed --format png")
    kept = cv2.imread(str(DOCS / "images" / "speed.png")).astype(float)
    drawn = cv2.imread(str(Path(film).parent / "figures" / "film_against_speed.png"))
    drawn = cv2.resize(drawn, kept.shape[1::-1], interpolation=cv2.INTER_AREA)
    assert np.abs(kept - drawn).mean() < 2.5  # of 255; a shift of one pixel changes 4.9


def test_code_of_the_page_of_figures_runs(film, tmp_path, monkeypatch):
    shutil.copy(film, tmp_path / "film.nc")
    monkeypatch.chdir(tmp_path)
    names = {}
    try:
        for kind, code in BLOCK.findall(read("figures.md")):
            if kind == "python":
                exec(code, names)
    finally:
        plt.close("all")
        names["film"].close()
    assert (tmp_path / "figure_3.pdf").is_file()
