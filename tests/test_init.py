"""What ``import erlif`` offers."""

import subprocess
import sys

import erlif


def test_functions_stay_functions_when_every_module_is_loaded():
    """A submodule of the same name would take a function's place as soon as it is imported."""
    code = (
        "import erlif, pkgutil, importlib, types\n"
        "for found in pkgutil.walk_packages(erlif.__path__, 'erlif.'):\n"
        "    if not found.name.endswith('__main__'): importlib.import_module(found.name)\n"
        "names = [n for n in erlif._FUNCTIONS if isinstance(getattr(erlif, n), types.ModuleType)]\n"
        "assert not names, names\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_every_public_name_resolves():
    for name in erlif.__all__:
        assert getattr(erlif, name) is not None
