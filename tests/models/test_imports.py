"""The models stand on numpy and scipy alone, and are all called alike."""

import importlib
import inspect
import pkgutil
import subprocess
import sys

import pytest

import erlif.models

MODULES = [f"erlif.models.{module.name}" for module in pkgutil.iter_modules(erlif.models.__path__)]
OURS = {"bearing", "contact", "film", "friction", "mechanism", "oil", "reaction", "wear"}
FUNCTIONS = [
    pytest.param(function, id=f"{name}.{function.__name__}")
    for name in MODULES
    if name.rpartition(".")[2] in OURS
    for _, function in inspect.getmembers(importlib.import_module(name), inspect.isfunction)
    if function.__module__ == name and not function.__name__.startswith("_")
]


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
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
    assert {f"erlif.models.{name}" for name in OURS} <= set(MODULES)


@pytest.mark.parametrize("function", FUNCTIONS)
def test_data_first_options_by_keyword_units_in_the_docstring(function):
    _, *options = inspect.signature(function).parameters.values()
    assert all(option.kind is option.KEYWORD_ONLY for option in options)
    assert "[" in function.__doc__ or function.__name__ in {"lubrication_regimes", "design_report"}
