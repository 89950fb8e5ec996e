"""The page of the formats: its example of a reader, its table, its parts."""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
import tifffile

from erlif.core.errors import FrameError
from erlif.io.readers import open_frames, registry
from erlif.io.settings import CameraSettings

PAGE = (Path(__file__).parents[2] / "docs" / "formats.md").read_text(encoding="utf-8")


def example(language: str) -> str:
    """The last example of the page in a language."""
    return re.findall(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)[-1]


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """The package of the page, installed as pip does it: a module and its metadata."""
    points = tomllib.loads(example("toml"))["project"]["entry-points"]
    lines = [
        line
        for group, names in points.items()
        for line in (f"[{group}]", *(f"{name} = {value}" for name, value in names.items()))
    ]
    information = tmp_path / "site" / "my_reader-1.0.dist-info"
    information.mkdir(parents=True)
    (information / "METADATA").write_text("Metadata-Version: 2.1\nName: my-reader\nVersion: 1.0\n")
    (information / "entry_points.txt").write_text("\n".join(lines))
    (tmp_path / "site" / "my_reader.py").write_text(example("python"))
    monkeypatch.syspath_prepend(tmp_path / "site")
    registry._foreign_formats.cache_clear()
    yield
    registry._keep.cache_clear()
    registry._foreign_formats.cache_clear()
    sys.modules.pop("my_reader", None)


def test_the_reader_of_the_page_is_found_by_its_entry_point(installed, tmp_path):
    counts = np.random.default_rng(1).integers(0, 4096, (3, 64, 80), dtype=np.uint16)
    header = b"MINE" + np.array([64, 80], "<u4").tobytes()
    (tmp_path / "a.dat").write_bytes(header + counts.astype("<u2").tobytes())
    file = open_frames(tmp_path / "a.dat")
    assert len(file.kinds) == 3
    for index in (2, 0, 1):
        np.testing.assert_array_equal(file.read(index), counts[index])
    file.close()

    (tmp_path / "b.mine").write_bytes(header)
    with pytest.raises(FrameError, match="holds no frame"):
        open_frames(tmp_path / "b.mine")


def test_init_and_check_see_the_frames_of_this_reader(installed, lab, command):
    settings = (lab.run / "run.toml").read_text(encoding="utf-8")
    for path in lab.run.glob("camera?/*.tif"):
        counts = tifffile.imread(path)
        header = b"MINE" + np.array(counts.shape, "<u4").tobytes()
        path.with_suffix(".mine").write_bytes(header + counts.astype("<u2").tobytes())
        path.unlink()
    printed = command("init", lab.run, "--overwrite").stdout
    assert "camera1: 6 frames of 128 x 96 uint16, camera1/*.mine" in printed
    found = (lab.run / "run.toml").read_text(encoding="utf-8")
    assert 'files = "camera2/*.mine"' in found

    (lab.run / "run.toml").write_text(re.sub(r"(camera\d/.*)\.tif", r"\1.mine", settings), "utf-8")
    assert "error" not in command("check", lab.run).stdout


def test_every_format_has_its_place_on_the_page():
    names = {part.strip() for entry in registry.FORMATS for part in entry.name.split(",")}
    assert not [name for name in names if name not in PAGE]


def test_the_parts_of_the_page_are_those_of_the_settings():
    for one in re.findall(r'`"((?:left|right|top|bottom|odd|even|channel \d))"`', PAGE):
        assert CameraSettings(files="a", band="580 nm", offset="0 DN", part=one).part == one
