from . import (
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
from .calibration import Calibration, open_calibration, save_calibration
from .core.errors import ErlifError
from .core.flags import Flag
from .core.version import __version__
from .io import conversion, files, ingest, readers, settings
from .io.conversion import export
from .io.files import open_film
from .joint import endurance, friction, sizing
from .joint.endurance import analyse_endurance, compare_designs, read_endurance_log
from .joint.friction import analyse_friction
from .joint.sizing.design import design
from .pipeline.batch import batch
from .pipeline.fixture import calibrate
from .pipeline.physics.predict import predict
from .pipeline.physics.pressure import pressure_from_film
from .pipeline.run import process
from .planning.plan import plan
from .review import comparison
from .review.budget import budget
from .review.check import check
from .review.comparison import compare
from .review.init import init
from .rig import simulate
from .show import notebook, plots, report
from .show.report import summarise
from .trend import find_pin_position

__all__ = [
    "Calibration",
    "ErlifError",
    "Flag",
    "__version__",
    "analyse_endurance",
    "analyse_friction",
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
