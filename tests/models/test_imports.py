"""The models load on first use and need numpy and scipy alone."""

import pkgutil
import subprocess
import sys

import erlif.joint.models
import erlif.models

MODULES = [
    f"{package.__name__}.{module.name}"
    for package in (erlif.models, erlif.joint.models)
    for module in pkgutil.iter_modules(package.__path__)
]


def run(code):
    """Output of a fresh interpreter."""
    command = [sys.executable, "-c", code]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def test_modules_are_not_loaded_before_their_use():
    code = (
        "import sys, erlif.models, erlif.joint.models\n"
        "print([name for name in sys.modules if '.models.' in name and 'erlif' in name])\n"
        "print('numpy' in sys.modules)"
    )
    assert run(code).split() == ["[]", "False"]


def test_models_import_numpy_and_scipy_only():
    heavy = [
        "xarray", "numba", "matplotlib", "cv2", "skimage", "pydantic",
        "pint", "zarr", "h5py", "pandas", "click",
    ]  # fmt: skip
    code = (
        "import sys\n"
        + "".join(f"import {name}\n" for name in ["erlif.models", *MODULES])
        + f"print([name for name in {heavy!r} if name in sys.modules])"
    )
    assert run(code) == "[]"
