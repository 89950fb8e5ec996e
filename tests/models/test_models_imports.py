"""The models stand on numpy and scipy alone."""

import pkgutil
import subprocess
import sys

import erlif.models


def test_models_import_numpy_and_scipy_only():
    names = [f"erlif.models.{module.name}" for module in pkgutil.iter_modules(erlif.models.__path__)]
    heavy = ("xarray", "numba", "matplotlib", "cv2", "skimage", "pydantic", "pint", "zarr", "h5py", "pandas", "click")
    code = (
        "import sys\n"
        + "".join(f"import {name}\n" for name in ["erlif.models", *names])
        + f"print([name for name in {heavy!r} if name in sys.modules])"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
    assert "erlif.models.film" in names
