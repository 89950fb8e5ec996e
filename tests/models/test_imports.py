"""The models load on first use, need numpy and scipy alone, and share one form of call."""

import importlib
import inspect
import pkgutil
import subprocess
import sys

import pytest

import erlif.models

MODULES = [f"erlif.models.{module.name}" for module in pkgutil.iter_modules(erlif.models.__path__)]
THEORY = set(erlif.models.__all__) - {"arguments", "sources"}
FUNCTIONS = [
    pytest.param(function, id=f"{name}.{function.__name__}")
    for name in MODULES
    if name.rpartition(".")[2] in THEORY
    for _, function in inspect.getmembers(importlib.import_module(name), inspect.isfunction)
    if f"{function.__module__}.".startswith(f"{name}.") and not function.__name__.startswith("_")
]


TWO_DATA = {"pin_shape", "section_stress", "solve_journal"}
"""Functions of two coordinates or of two objects, neither of which is an option."""


def run(code):
    """Output of a fresh interpreter."""
    command = [sys.executable, "-c", code]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


NAMES = sorted(name.rpartition(".")[2] for name in MODULES)


def test_every_module_loads_on_first_use():
    uses = "".join(f"erlif.models.{name}\n" for name in NAMES)
    code = f"import erlif\n{uses}print(erlif.models.film.film_parameter.__module__)"
    assert run(code) == "erlif.models.film"


def test_modules_are_not_loaded_before_their_use():
    code = (
        "import sys, erlif.models\n"
        "print([name for name in sys.modules if name.startswith('erlif.models.')])\n"
        "print('numpy' in sys.modules)"
    )
    assert run(code).split() == ["[]", "False"]


def test_dir_and_star_import_show_every_module():
    assert set(NAMES) <= set(dir(erlif.models))
    packages = set(erlif.models.reynolds.__all__) | set(erlif.models.edges.__all__)
    assert set(NAMES) | packages == set(erlif.models.__all__)
    assert run("from erlif.models import *\nprint(oil.__name__)") == "erlif.models.oil"
    assert run("import erlif.models\nprint(dir(erlif.models))") == str(dir(erlif.models))


def test_models_import_numpy_and_scipy_only():
    heavy = (
        "xarray",
        "numba",
        "matplotlib",
        "cv2",
        "skimage",
        "pydantic",
        "pint",
        "zarr",
        "h5py",
        "pandas",
        "click",
    )
    code = (
        "import sys\n"
        + "".join(f"import {name}\n" for name in ["erlif.models", *MODULES])
        + f"print([name for name in {heavy!r} if name in sys.modules])"
    )
    assert run(code) == "[]"


@pytest.mark.parametrize("function", FUNCTIONS)
def test_data_first_options_by_keyword_units_in_the_docstring(function):
    _, *options = inspect.signature(function).parameters.values()
    if function.__name__ in TWO_DATA:
        _, *options = options
    assert all(option.kind is option.KEYWORD_ONLY for option in options)
    assert "[" in function.__doc__
