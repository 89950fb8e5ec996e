"""What pages show as printed is what their commands print."""

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

DOCS = Path(__file__).parents[2] / "docs"
BLOCK = re.compile(r"```(\w+)\n(.*?)```", re.DOTALL)


def read(name: str) -> str:
    return (DOCS / name).read_text(encoding="utf-8")


def printed(commands: str, folder: Path) -> str:
    """Output of all commands, each break of a line as one space."""
    texts = []
    for line in filter(None, commands.replace("\\\n", " ").splitlines()):
        name, *words = shlex.split(line, comments=True)
        assert name == "erlif"
        words, into = (words[:-2], words[-1]) if ">" in words else (words, None)
        command = [sys.executable, "-m", "erlif", *words]
        found = subprocess.run(
            command, cwd=folder, capture_output=True, encoding="utf-8", check=True
        )
        if into is None:
            texts.append(found.stdout)
        else:
            (folder / into).write_text(found.stdout, encoding="utf-8")
    return " ".join("".join(texts).split())


@pytest.mark.slow
@pytest.mark.parametrize("name", ["friction.md", "planning.md", "compare.md"])
def test_the_first_commands_of_a_page_print_what_it_shows(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = BLOCK.findall(read(name))
    place = next(k for k, (kind, _) in enumerate(blocks) if kind == "text")
    for kind, code in blocks[:place]:
        if kind == "python":
            exec(code, {})
    found = printed(blocks[place - 1][1], tmp_path)
    lines = blocks[place][1].splitlines()
    assert [line for line in lines if " ".join(line.split()) not in found] == []


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
