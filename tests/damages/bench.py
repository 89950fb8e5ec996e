"""A copy of the small rig that costs no disk, and what one damage is."""

import os
import shutil
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tifffile

TEXTS = tomllib.loads(Path(__file__).with_name("texts.toml").read_text(encoding="utf-8"))
"""Damages that are text alone, by their kind and name."""


@dataclass(frozen=True)
class Bench:
    """Directories of the rig, a film of formulas beside them; files are hard links.

    Nothing is written in place, because the originals share the bytes.
    """

    directory: Path

    @property
    def run(self) -> Path:
        return self.directory / "run"

    @property
    def fixture(self) -> Path:
        return self.directory / "fixture"

    @property
    def film(self) -> Path:
        return self.directory / "films" / "film.nc"

    @property
    def calibration(self) -> Path:
        return self.fixture / "calibration.nc"

    def frame(self, number: int, camera: int = 1) -> Path:
        return self.run / f"camera{camera}" / f"frame_{number:04d}.tif"

    def write(self, path: Path, content: bytes | str) -> None:
        """Put a new file in the place of one."""
        path.unlink(missing_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content)

    def own(self, path: Path) -> Path:
        """The file as a copy of its own, which may be changed in place."""
        content = path.read_bytes()
        path.unlink()
        path.write_bytes(content)
        return path

    def edit(self, path: Path, *changes: tuple[str, str]) -> None:
        """Replace text in a file, each piece once."""
        text = path.read_text(encoding="utf-8")
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new, 1)
        self.write(path, text)

    def pages(self, path: Path, change: Callable[[np.ndarray], np.ndarray], **options) -> None:
        """Write the pages of a TIFF again, changed."""
        with tifffile.TiffFile(path) as file:
            pages = [change(page.asarray()) for page in file.pages]
        path.unlink()
        with tifffile.TiffWriter(path) as file:
            for page in pages:
                file.write(page, contiguous=False, metadata=None, **options)

    def all_frames(self, change: Callable[[np.ndarray], np.ndarray], camera: int = 0) -> None:
        """Change the frames of one camera, or of both."""
        for number in (camera,) if camera else (1, 2):
            for path in sorted((self.run / f"camera{number}").iterdir()):
                self.pages(path, change)


def copy_rig(source: Path, target: Path) -> Bench:
    """Copy the directories of the rig as hard links."""
    for name in ("run", "fixture", "films"):
        shutil.copytree(source / name, target / name, copy_function=os.link)
    return Bench(target)


Change = Callable[[Bench], object]


@dataclass(frozen=True)
class Damage:
    """One damage.

    Attributes
    ----------
    name : str
        What was done, in words.
    change : Change
        Does it to a bench.
    command : str
        The command line; names of files are relative to the bench.
    words : tuple[str, ...]
        Words that the message holds.
    """

    name: str
    change: Change
    command: str
    words: tuple[str, ...]
