from .coefficient import measure_friction
from .log import QUANTITIES, SEVERAL, LogColumns, read_torque_log
from .reversals import (
    ReversalSeries,
    analyse_friction,
    describe_friction,
    write_friction_table,
)

__all__ = [
    "QUANTITIES",
    "SEVERAL",
    "LogColumns",
    "ReversalSeries",
    "analyse_friction",
    "describe_friction",
    "measure_friction",
    "read_torque_log",
    "write_friction_table",
]
