"""A small virtual rig, copies of it that a test may damage, and the command line."""

import functools
import hashlib
import importlib
import os
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

# As in the commands, before numpy is loaded: pytest-xdist has a process for each core, and threads
# of linear algebra that wait for each other triple the processor time of a fit.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import threadpoolctl
import xarray as xr
from click.testing import CliRunner, Result
from hypothesis import settings
from scenes.page import Page

import erlif
from erlif.commands.main import main
from erlif.io.ingest import open_run
from erlif.rig import RigSettings, simulate

# in a single process a plugin has loaded numpy before
threadpoolctl.threadpool_limits(1, user_api="blas")

# the duration of an example depends on the load of the machine
settings.register_profile("erlif", deadline=None, database=None)
settings.load_profile("erlif")

FULL = bool(os.environ.get("ERLIF_FULL"))
"""Whether kills and simulated cases are as many as for a release (CONTRIBUTING.md)."""

SMALL = RigSettings(
    width=128, height=96, spacing=8.0, fixture_frames=3, dark_pages=4, flat_pages=3, bubbles=0
)
"""Six triggers of 128 x 96 pixels."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files with slow tests come first: beside them the short ones fill the other workers."""
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    items.sort(key=lambda item: item.path not in slow)


@dataclass(frozen=True)
class Laboratory:
    """Directories as the rig wrote them; the fixture is calibrated."""

    directory: Path

    @property
    def run(self) -> Path:
        return self.directory / "run"

    @property
    def fixture(self) -> Path:
        return self.directory / "fixture"

    @property
    def film(self) -> Path:
        return self.run / "film.nc"

    @classmethod
    def simulated(cls, directory: Path, *, seed: int, rig: RigSettings) -> "Laboratory":
        """A run of the rig and its fixture, which is calibrated."""
        lab = cls(directory)
        simulate(directory, seed=seed, rig=rig)
        erlif.save_calibration(erlif.calibrate(lab.fixture), lab.fixture / "calibration.nc")
        return lab

    @functools.cached_property
    def truth(self) -> xr.Dataset:
        """Film, displacement and all other inputs of the rig."""
        with xr.open_dataset(self.directory / "truth.nc", engine="h5netcdf") as dataset:
            return dataset.load()

    def copy_run(self, name: str, *changes: tuple[str, str], add: str = "") -> Path:
        """Another run directory with the same frames and other settings."""
        shutil.copytree(self.run, self.directory / name)
        self.edit(f"{name}/run.toml", *changes)
        with (self.directory / name / "run.toml").open("a", encoding="utf-8") as settings:
            settings.write(add)
        return self.directory / name

    def process_copy(self, name: str, *changes: tuple[str, str], add: str = "") -> xr.Dataset:
        """Film of the same frames with other settings."""
        return erlif.process(self.copy_run(name, *changes, add=add), workers=1)

    def errors(
        self, film: xr.Dataset, *, above: float, below: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Valid pixels whose true film lies between two films [um], and film less true film [um].

        Both are (trigger, y, x).
        """
        true = self.truth.film.values
        inside = (film["flags"].values == 0) & (true > above) & (true < below)
        return inside, film.thickness.values - true

    def edit(self, file: str, *changes: tuple[str, str]) -> None:
        """Replace text in a file, each piece once."""
        path = self.directory / file
        text = path.read_text(encoding="utf-8")
        for old, new in changes:
            assert old in text
            text = text.replace(old, new, 1)
        path.write_text(text, encoding="utf-8")

    def frames(self, camera: int) -> list[Path]:
        return sorted((self.run / f"camera{camera}").iterdir())


def reorder(paths: list[Path], order: Sequence[int]) -> None:
    """Give the file at place k the content of the file at place order[k]."""
    content = [path.read_bytes() for path in paths]
    for path, n in zip(paths, order, strict=True):
        path.write_bytes(content[n])


def simulated(rig: RigSettings, seed: int):
    """A fixture of a module: the directories of a rig; never to be changed."""

    @pytest.fixture(scope="module")
    def directories(tmp_path_factory) -> Laboratory:
        return Laboratory.simulated(tmp_path_factory.mktemp("simulated"), seed=seed, rig=rig)

    return directories


def processed(lab: str, name: str = "run", *changes: tuple[str, str], add: str = ""):
    """A fixture of a module: the film of a laboratory, under other settings if these are named."""

    @pytest.fixture(scope="module")
    def made(request) -> xr.Dataset:
        directories = request.getfixturevalue(lab)
        if name == "run":
            return erlif.process(directories.run, workers=2)
        return directories.process_copy(name, *changes, add=add)

    return made


@pytest.fixture(scope="session")
def small_rig(tmp_path_factory) -> Laboratory:
    """Never to be changed; take `lab` for a copy."""
    return Laboratory.simulated(tmp_path_factory.mktemp("rig"), seed=11, rig=SMALL)


@pytest.fixture(scope="session")
def run(small_rig):
    """The rig's run, opened."""
    return open_run(small_rig.run)


@pytest.fixture(scope="session")
def calibration(small_rig):
    return erlif.open_calibration(small_rig.fixture / "calibration.nc")


@pytest.fixture(scope="session")
def two_cycles(tmp_path_factory) -> Laboratory:
    """The same rig over two turns of the crank, not calibrated; never to be changed."""
    lab = Laboratory(tmp_path_factory.mktemp("cycles"))
    simulate(lab.directory, seed=12, rig=replace(SMALL, cycles=2, fixture_frames=1))
    return lab


@pytest.fixture
def lab(small_rig, tmp_path) -> Laboratory:
    """A copy of the rig's directories that a test may damage."""
    for name in ("run", "fixture"):
        shutil.copytree(small_rig.directory / name, tmp_path / "lab" / name)
    return Laboratory(tmp_path / "lab")


@pytest.fixture
def series(small_rig, tmp_path) -> Path:
    """Directory with the runs monday, tuesday and wednesday; the second has a damaged frame."""
    shutil.copytree(small_rig.fixture, tmp_path / "fixture")
    for name in ("monday", "tuesday", "wednesday"):
        shutil.copytree(small_rig.run, tmp_path / name)
    (tmp_path / "tuesday" / "camera1" / "frame_0002.tif").write_bytes(b"")
    return tmp_path


@pytest.fixture(scope="session")
def film(small_rig, tmp_path_factory) -> Path:
    """film.nc of the rig as a single thread makes it."""
    from erlif.pipeline.film import with_theory  # at use: other tests need no pipeline

    path = tmp_path_factory.mktemp("film") / "film.nc"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("erlif.pipeline.run.with_theory", with_theory)  # whichever module asks first
        erlif.process(small_rig.run, output=path, workers=1).close()
    return path


def read_film(path: Path, group: str | None = None) -> xr.Dataset:
    """A film, or a group of it, in memory; its file is closed."""
    with erlif.open_film(path, group=group) as dataset:
        return dataset.load()


@pytest.fixture(scope="session")
def opened(film) -> xr.Dataset:
    """The film of the rig in memory; never to be changed."""
    return read_film(film)


@pytest.fixture
def coarse_pressure(monkeypatch) -> None:
    """The pressure of a film on few cells, for tests that do not look at its values."""
    module = importlib.import_module("erlif.pipeline.physics.pressure")
    coarse = functools.partial(module.find_pressures, cells=(64, 4))
    monkeypatch.setattr(module, "find_pressures", coarse)


@pytest.fixture
def two_models(monkeypatch) -> None:
    """A film compared with a free and a guided pin alone, where the other models do not matter."""
    module = importlib.import_module("erlif.pipeline.physics.fit")
    compare = module.compare_models

    def compare_two(*measured, sideways, **options):
        return compare(*measured, sideways=("free", "any guided"), **options)

    monkeypatch.setattr(module, "compare_models", compare_two)


@pytest.fixture
def maps_alone(monkeypatch) -> None:
    """Films without what theory adds, for tests that look at maps, statistics and notes alone."""
    monkeypatch.setattr("erlif.pipeline.run.with_theory", lambda draft: draft)


@pytest.fixture(scope="module")
def without_theory():
    """The same for all tests of a module."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("erlif.pipeline.run.with_theory", lambda draft: draft)
        yield


@pytest.fixture(scope="module")
def without_prediction():
    """Films without the prediction over the cycle and the physics that it tells apart."""
    from erlif.pipeline.physics.prediction import NO_PREDICTION  # as for `film`

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("erlif.pipeline.film.try_prediction", lambda *run: NO_PREDICTION)
        patch.setattr("erlif.pipeline.film.state_physics", lambda *film: ("", {}))
        yield


def snapshot(directory: Path) -> dict[str, str]:
    """Every file below a directory with the hash of its bytes."""
    files = [
        path for path in sorted(directory.rglob("*")) if path.is_file() and not path.is_symlink()
    ]
    return {
        str(path.relative_to(directory)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in files
    }


@pytest.fixture
def read_page() -> type[Page]:
    return Page


@pytest.fixture
def command() -> Callable[..., Result]:
    """Run an erlif command that must succeed, or end with another status."""

    def run(*arguments: object, status: int = 0) -> Result:
        result = CliRunner().invoke(main, [str(argument) for argument in arguments])
        assert result.exit_code == status, result.output
        return result

    return run


@pytest.fixture
def refused(tmp_path) -> Callable[..., str]:
    """Run an erlif command on bad input; gives its message.

    The status is 2, there is one message, and no file has changed.
    """

    def run(*arguments: object) -> str:
        before = snapshot(tmp_path)
        result = CliRunner().invoke(main, [str(argument) for argument in arguments])
        assert result.exit_code == 2, result.output
        assert "Traceback" not in result.output
        assert result.stderr.count("erlif: ") == 1
        assert snapshot(tmp_path) == before
        return result.stderr.partition("erlif: ")[2].strip()

    return run
