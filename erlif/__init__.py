"""Oil-film thickness maps with honest error bars from two-camera laser-induced fluorescence.

>>> import erlif
>>> calibration = erlif.calibrate("calibration/wedge")  # doctest: +SKIP
>>> film = erlif.process("data_samples/straight_bushing", calibration=calibration)  # doctest: +SKIP
>>> erlif.plots.thickness_map(film, trigger=12)  # doctest: +SKIP

The stages, in the order of the pipeline: `ingest`, `correction`, `registration`, `ratio`,
`calibration`, `thickness`, `kinematics`, `trend`, `prediction`. Each holds plain functions.
`models` is theory, `rig` the virtual rig, `plots` the figures; `joint` designs joints and reads
test logs.
"""

import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType

import lazy_loader

from erlif.core.locking import take_demand
from erlif.core.speed.imports import after_import
from erlif.core.speed.kernel_cache import ensure_kernel_cache

ensure_kernel_cache()
take_demand()

# the names stand in __init__.pyi, for this module and for editors alike
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


class _PublicModules(MetaPathFinder, Loader):
    """Imports `erlif.settings`, which lies elsewhere, as the module that the attribute is."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        package, _, name = fullname.rpartition(".")
        public = package == __name__ and name in __all__
        found = public and isinstance(__getattr__(name), ModuleType)
        return ModuleSpec(fullname, self) if found else None

    def exec_module(self, module: ModuleType) -> None:
        sys.modules[module.__name__] = __getattr__(module.__name__.rpartition(".")[2])


sys.meta_path.append(_PublicModules())


def _add_accessors() -> None:
    """Register the attribute `erlif` of xarray objects; its code loads on first use."""
    import xarray as xr

    if not hasattr(xr.Dataset, "erlif"):
        xr.register_dataset_accessor("erlif")(  # type: ignore[no-untyped-call]
            lambda dataset: import_module("erlif.show.notebook").FilmAccessor(dataset)
        )
        xr.register_dataarray_accessor("erlif")(  # type: ignore[no-untyped-call]
            lambda array: import_module("erlif.show.notebook").MapAccessor(array)
        )


after_import("xarray", _add_accessors)
