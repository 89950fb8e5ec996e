"""Oil-film thickness maps with honest error bars from two-camera laser-induced fluorescence.

>>> import erlif
>>> calibration = erlif.calibrate("calibration/wedge")  # doctest: +SKIP
>>> film = erlif.process("data_samples/straight_bushing", calibration=calibration)  # doctest: +SKIP
>>> erlif.plots.thickness_map(film, trigger=12)  # doctest: +SKIP

The stages, in the order of the pipeline: `ingest`, `correction`, `registration`, `ratio`,
`calibration`, `thickness`, `kinematics`, `trend`, `prediction`. Each holds plain functions.
`models` is theory, `sizing` the design of joints, `rig` the virtual rig, `plots` the figures.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from erlif.core.kernel_cache import ensure_kernel_cache
from erlif.core.later import after_import
from erlif.core.version import __version__

ensure_kernel_cache()

_FUNCTIONS = {
    "Calibration": "erlif.calibration",
    "ErlifError": "erlif.core.errors",
    "Flag": "erlif.core.flags",
    "analyse_endurance": "erlif.endurance",
    "analyse_friction": "erlif.friction",
    "batch": "erlif.pipeline.batch",
    "budget": "erlif.pipeline.budget",
    "calibrate": "erlif.pipeline.fixture",
    "check": "erlif.audit",
    "compare": "erlif.comparison",
    "compare_designs": "erlif.endurance",
    "design": "erlif.pipeline.design",
    "export": "erlif.conversion",
    "find_pin_position": "erlif.trend",
    "init": "erlif.pipeline.init",
    "open_calibration": "erlif.calibration",
    "open_film": "erlif.files",
    "plan": "erlif.pipeline.plan",
    "predict": "erlif.pipeline.predict",
    "pressure_from_film": "erlif.pipeline.pressure",
    "process": "erlif.pipeline.run",
    "read_endurance_log": "erlif.endurance",
    "save_calibration": "erlif.calibration",
    "simulate": "erlif.rig",
    "summarise": "erlif.report",
}
_MODULES = (
    "audit",
    "calibration",
    "comparison",
    "conversion",
    "correction",
    "endurance",
    "files",
    "friction",
    "ingest",
    "kinematics",
    "models",
    "notebook",
    "pipeline",
    "planning",
    "plots",
    "prediction",
    "ratio",
    "registration",
    "report",
    "rig",
    "settings",
    "sizing",
    "thickness",
    "trend",
)

__all__ = [
    "Calibration",
    "ErlifError",
    "Flag",
    "__version__",
    "analyse_endurance",
    "analyse_friction",
    "audit",
    "batch",
    "budget",
    "calibrate",
    "calibration",
    "check",
    "compare",
    "compare_designs",
    "comparison",
    "conversion",
    "correction",
    "design",
    "endurance",
    "export",
    "files",
    "find_pin_position",
    "friction",
    "ingest",
    "init",
    "kinematics",
    "models",
    "notebook",
    "open_calibration",
    "open_film",
    "pipeline",
    "plan",
    "planning",
    "plots",
    "predict",
    "prediction",
    "pressure_from_film",
    "process",
    "ratio",
    "read_endurance_log",
    "registration",
    "report",
    "rig",
    "save_calibration",
    "settings",
    "simulate",
    "sizing",
    "summarise",
    "thickness",
    "trend",
]

if TYPE_CHECKING:
    from erlif import (
        audit,
        calibration,
        comparison,
        conversion,
        correction,
        endurance,
        files,
        friction,
        ingest,
        kinematics,
        models,
        notebook,
        pipeline,
        planning,
        plots,
        prediction,
        ratio,
        registration,
        report,
        rig,
        settings,
        sizing,
        thickness,
        trend,
    )
    from erlif.audit import check
    from erlif.calibration import Calibration, open_calibration, save_calibration
    from erlif.comparison import compare
    from erlif.conversion import export
    from erlif.core.errors import ErlifError
    from erlif.core.flags import Flag
    from erlif.endurance import analyse_endurance, compare_designs, read_endurance_log
    from erlif.files import open_film
    from erlif.friction import analyse_friction
    from erlif.pipeline.batch import batch
    from erlif.pipeline.budget import budget
    from erlif.pipeline.design import design
    from erlif.pipeline.fixture import calibrate
    from erlif.pipeline.init import init
    from erlif.pipeline.plan import plan
    from erlif.pipeline.predict import predict
    from erlif.pipeline.pressure import pressure_from_film
    from erlif.pipeline.run import process
    from erlif.report import summarise
    from erlif.rig import simulate
    from erlif.trend import find_pin_position


def __getattr__(name: str) -> Any:
    """Load a stage or a function when it is first used, so that ``import erlif`` stays quick."""
    if name in _FUNCTIONS:
        return getattr(import_module(_FUNCTIONS[name]), name)
    if name in _MODULES:
        return import_module(f"erlif.{name}")
    raise AttributeError(f"module 'erlif' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)


def _add_accessors() -> None:
    """Give datasets and arrays of xarray the attribute `erlif`; its code loads when it is used."""
    import xarray as xr

    if not hasattr(xr.Dataset, "erlif"):
        xr.register_dataset_accessor("erlif")(  # type: ignore[no-untyped-call]
            lambda dataset: import_module("erlif.notebook").FilmAccessor(dataset)
        )
        xr.register_dataarray_accessor("erlif")(  # type: ignore[no-untyped-call]
            lambda array: import_module("erlif.notebook").MapAccessor(array)
        )


after_import("xarray", _add_accessors)
