"""Friction of bearings from logs of load and torque: over a test, and from reversals."""

from erlif.joint.friction.coefficient import measure_friction
from erlif.joint.friction.log import QUANTITIES, SEVERAL, LogColumns, read_torque_log
from erlif.joint.friction.reversals import (
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
