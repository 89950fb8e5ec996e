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

from erlif.core.speed.kernel_cache import ensure_kernel_cache
from erlif.core.speed.later import after_import
from erlif.core.version import __version__

ensure_kernel_cache()

_FUNCTIONS = {
    "Calibration": "erlif.calibration",
    "ErlifError": "erlif.core.errors",
    "Flag": "erlif.core.flags",
    "analyse_endurance": "erlif.joint.endurance",
    "analyse_friction": "erlif.joint.friction",
    "batch": "erlif.pipeline.batch",
    "budget": "erlif.review.budget",
    "calibrate": "erlif.pipeline.fixture",
    "check": "erlif.review.audit",
    "compare": "erlif.review.comparison",
    "compare_designs": "erlif.joint.endurance",
    "design": "erlif.joint.sizing.design",
    "export": "erlif.io.conversion",
    "find_pin_position": "erlif.trend",
    "init": "erlif.review.init",
    "open_calibration": "erlif.calibration",
    "open_film": "erlif.io.files",
    "plan": "erlif.planning.plan",
    "predict": "erlif.pipeline.physics.predict",
    "pressure_from_film": "erlif.pipeline.physics.pressure",
    "process": "erlif.pipeline.run",
    "read_endurance_log": "erlif.joint.endurance",
    "save_calibration": "erlif.calibration",
    "simulate": "erlif.rig",
    "summarise": "erlif.show.report",
}
_MODULES = {
    "audit": "erlif.review.audit",
    "calibration": "erlif.calibration",
    "comparison": "erlif.review.comparison",
    "conversion": "erlif.io.conversion",
    "correction": "erlif.correction",
    "endurance": "erlif.joint.endurance",
    "files": "erlif.io.files",
    "friction": "erlif.joint.friction",
    "ingest": "erlif.io.ingest",
    "kinematics": "erlif.kinematics",
    "models": "erlif.models",
    "notebook": "erlif.show.notebook",
    "pipeline": "erlif.pipeline",
    "planning": "erlif.planning",
    "plots": "erlif.show.plots",
    "prediction": "erlif.prediction",
    "ratio": "erlif.ratio",
    "readers": "erlif.io.readers",
    "registration": "erlif.registration",
    "report": "erlif.show.report",
    "rig": "erlif.rig",
    "settings": "erlif.io.settings",
    "sizing": "erlif.joint.sizing",
    "thickness": "erlif.thickness",
    "trend": "erlif.trend",
}

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
    "readers",
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
        calibration,
        correction,
        kinematics,
        models,
        pipeline,
        planning,
        prediction,
        ratio,
        registration,
        rig,
        thickness,
        trend,
    )
    from erlif.calibration import Calibration, open_calibration, save_calibration
    from erlif.core.errors import ErlifError
    from erlif.core.flags import Flag
    from erlif.io import conversion, files, ingest, readers, settings
    from erlif.io.conversion import export
    from erlif.io.files import open_film
    from erlif.joint import endurance, friction, sizing
    from erlif.joint.endurance import analyse_endurance, compare_designs, read_endurance_log
    from erlif.joint.friction import analyse_friction
    from erlif.joint.sizing.design import design
    from erlif.pipeline.batch import batch
    from erlif.pipeline.fixture import calibrate
    from erlif.pipeline.physics.predict import predict
    from erlif.pipeline.physics.pressure import pressure_from_film
    from erlif.pipeline.run import process
    from erlif.planning.plan import plan
    from erlif.review import audit, comparison
    from erlif.review.audit import check
    from erlif.review.budget import budget
    from erlif.review.comparison import compare
    from erlif.review.init import init
    from erlif.rig import simulate
    from erlif.show import notebook, plots, report
    from erlif.show.report import summarise
    from erlif.trend import find_pin_position


def __getattr__(name: str) -> Any:
    """Load a stage or a function when it is first used, so that ``import erlif`` stays quick."""
    if name in _FUNCTIONS:
        return getattr(import_module(_FUNCTIONS[name]), name)
    if name in _MODULES:
        return import_module(_MODULES[name])
    raise AttributeError(f"module 'erlif' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)


def _add_accessors() -> None:
    """Give datasets and arrays of xarray the attribute `erlif`; its code loads when it is used."""
    import xarray as xr

    if not hasattr(xr.Dataset, "erlif"):
        xr.register_dataset_accessor("erlif")(  # type: ignore[no-untyped-call]
            lambda dataset: import_module("erlif.show.notebook").FilmAccessor(dataset)
        )
        xr.register_dataarray_accessor("erlif")(  # type: ignore[no-untyped-call]
            lambda array: import_module("erlif.show.notebook").MapAccessor(array)
        )


after_import("xarray", _add_accessors)
