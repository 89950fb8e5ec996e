from .directory import simulate
from .endurance import (
    EnduranceRig,
    EnduranceTruth,
    simulate_endurance,
    write_endurance_log,
)
from .settings import DyeSpectra, RigSettings

__all__ = [
    "DyeSpectra",
    "EnduranceRig",
    "EnduranceTruth",
    "RigSettings",
    "simulate",
    "simulate_endurance",
    "write_endurance_log",
]
