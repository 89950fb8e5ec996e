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

from importlib import import_module

import lazy_loader

from erlif.core.speed.imports import after_import
from erlif.core.speed.kernel_cache import ensure_kernel_cache

ensure_kernel_cache()

# the names stand in __init__.pyi, for this module and for editors alike
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


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
