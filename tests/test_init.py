"""What ``import erlif`` offers."""

import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import erlif
from erlif.core.errors import OutputError

ROOT = Path(__file__).parents[1]

MODULES = {
    name: module.__name__
    for name in erlif.__all__
    if isinstance(module := getattr(erlif, name), ModuleType)
}
"""Where the modules lie that are public as `erlif.name`."""


def test_functions_stay_functions_when_every_module_is_loaded():
    """A submodule of the same name would take a function's place as soon as it is imported.

    Public modules are imported first by name, then by way of the others.
    """
    code = (
        "import sys, erlif, pkgutil, types\n"
        "from importlib import import_module\n"
        "assert 'matplotlib' not in sys.modules\n"
        f"for name, place in {MODULES}.items():\n"
        "    assert import_module('erlif.' + name) is import_module(place), name\n"
        "    assert import_module('erlif.' + name) is getattr(erlif, name), name\n"
        "for found in pkgutil.walk_packages(erlif.__path__, 'erlif.'):\n"
        "    if not found.name.endswith('__main__'): import_module(found.name)\n"
        "names = [n for n in erlif.__all__ if isinstance(getattr(erlif, n), types.ModuleType)]\n"
        "functions = {'batch', 'budget', 'check', 'compare', 'init', 'plan', 'predict'}\n"
        "assert not functions & set(names), names\n"
        "assert not isinstance(erlif.joint.design, types.ModuleType)\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_every_public_name_resolves():
    for package in (erlif, erlif.joint):
        for name in package.__all__:
            assert getattr(package, name) is not None


def test_a_public_module_is_the_same_as_attribute_and_imported():
    code = (
        "import erlif\n"
        "from importlib import import_module\n"
        f"for name, place in {MODULES}.items():\n"
        "    assert getattr(erlif, name) is import_module(place), name\n"
        "    assert import_module('erlif.' + name) is getattr(erlif, name), name\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_type_checkers_find_a_public_module_where_it_lies():
    stubs = {path.stem: path.read_text().split()[1] for path in (ROOT / "erlif").glob("[!_]*.pyi")}
    assert stubs == {name: place for name, place in MODULES.items() if place != f"erlif.{name}"}


def test_processing_loads_no_library_that_it_does_not_need():
    """Each of these takes 0.1 to 0.4 s to load, before the first frame is read."""
    slow = ["dask", "matplotlib", "pint", "scipy.optimize", "scipy.signal", "scipy.stats", "zarr"]
    code = (
        "import sys\n"
        "from erlif import pipeline\n"
        "from erlif.show.report import summarise\n"
        "from erlif.io.files.soundness import read_settings\n"
        "from erlif.io.settings import read_run_settings, to_toml\n"
        "from pathlib import Path\n"
        "read_settings(to_toml(read_run_settings(Path('data_samples/straight_bushing'))))\n"
        f"loaded = [name for name in {slow} if name in sys.modules]\n"
        "assert not loaded, loaded\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=ROOT)


@pytest.mark.parametrize(
    "write",
    [
        lambda film, out, **shown: erlif.process(film.parent, output=out / "film.nc", **shown),
        lambda film, out, **shown: erlif.predict(film, output=out / "prediction.nc", **shown),
        lambda film, out, **shown: erlif.export(film, out / "film.tif", **shown),
        lambda film, out, **shown: erlif.plots.cycle_movie(film, out / "cycle.gif", **shown),
        lambda film, out, **shown: erlif.plots.write_figures(film, out / "figures", **shown),
        lambda film, out, **shown: erlif.report.write_report(film, out / "report.html", **shown),
        lambda film, out, **shown: erlif.report.write_runs_report(
            [film], out / "report.html", **shown
        ),
    ],
)
def test_a_misspelt_folder_of_an_output_is_refused_before_the_work(film, tmp_path, write):
    def progress(step, done, total):
        pytest.fail(f"{step} has begun")

    with pytest.raises(OutputError, match="Expected an existing folder for the output"):
        write(film, tmp_path / "misspelt", progress=progress)
    assert list(tmp_path.iterdir()) == []
