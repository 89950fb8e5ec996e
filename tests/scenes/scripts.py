"""Scripts beside the package, loaded as modules."""

import importlib.util
import sys


def load_script(path):
    """Module of a script; its classes find it by its name."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = sys.modules[path.stem] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
