"""Oil-film thickness maps with honest error bars from two-camera laser-induced fluorescence.

>>> import erlif
>>> calibration = erlif.calibrate("calibration/wedge")  # doctest: +SKIP
>>> film = erlif.process("data_samples/straight_bushing", calibration=calibration)  # doctest: +SKIP
>>> erlif.plots.thickness_map(film, trigger=12)  # doctest: +SKIP

The stages, in the order of the pipeline: `ingest`, `correction`, `registration`, `alignment`, `ratio`, `calibration`, `thickness`,
`kinematics`, `trend`. Each is a module of plain functions. `models` is theory, `rig` the virtual rig, `plots` the figures.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_FUNCTIONS = {
    "Calibration": "erlif.calibration",
    "ErlifError": "erlif.core.errors",
    "Flag": "erlif.core.flags",
    "audit": "erlif.inspection",
    "calibrate": "erlif.pipeline",
    "open_calibration": "erlif.pipeline",
    "open_film": "erlif.core.store",
    "process": "erlif.pipeline",
    "save_calibration": "erlif.pipeline",
    "simulate": "erlif.rig",
    "summarise": "erlif.summary",
    "uncertainty_budget": "erlif.budget",
}
_MODULES = (
    "alignment",
    "calibration",
    "correction",
    "ingest",
    "kinematics",
    "models",
    "pipeline",
    "plots",
    "ratio",
    "registration",
    "report",
    "rig",
    "thickness",
    "trend",
)

__all__ = [
    "Calibration",
    "ErlifError",
    "Flag",
    "__version__",
    "alignment",
    "audit",
    "calibrate",
    "calibration",
    "correction",
    "ingest",
    "kinematics",
    "models",
    "open_calibration",
    "open_film",
    "pipeline",
    "plots",
    "process",
    "ratio",
    "registration",
    "report",
    "rig",
    "save_calibration",
    "simulate",
    "summarise",
    "thickness",
    "trend",
    "uncertainty_budget",
]

if TYPE_CHECKING:
    from erlif import (
        alignment,
        calibration,
        correction,
        ingest,
        kinematics,
        models,
        pipeline,
        plots,
        ratio,
        registration,
        report,
        rig,
        thickness,
        trend,
    )
    from erlif.budget import uncertainty_budget
    from erlif.calibration import Calibration
    from erlif.core.errors import ErlifError
    from erlif.core.flags import Flag
    from erlif.core.store import open_film
    from erlif.inspection import audit
    from erlif.pipeline import calibrate, open_calibration, process, save_calibration
    from erlif.rig import simulate
    from erlif.summary import summarise


def __getattr__(name: str) -> Any:
    """Load a stage or a function when it is first used, so that ``import erlif`` stays quick."""
    if name in _FUNCTIONS:
        return getattr(import_module(_FUNCTIONS[name]), name)
    if name in _MODULES:
        return import_module(f"erlif.{name}")
    raise AttributeError(f"module 'erlif' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
