"""Endurance tests of bearings: log to friction, stages, onset of galling and load at failure."""

from erlif.joint.endurance.analysis import EnduranceResult, analyse_endurance
from erlif.joint.endurance.blocks import StageFriction
from erlif.joint.endurance.comparison import DesignComparison, compare_designs
from erlif.joint.endurance.failure import FailureLoad, failure_load
from erlif.joint.endurance.onset import OnsetSearch, find_onset
from erlif.joint.endurance.posterior import Onset
from erlif.joint.endurance.stages import Stage, find_stages, join_stages
from erlif.joint.endurance.summary import describe_designs, describe_test, write_test_table
from erlif.joint.endurance.witness import Witness, hear_witnesses
from erlif.joint.friction import (
    QUANTITIES,
    SEVERAL,
    LogColumns,
    ReversalSeries,
    analyse_friction,
    describe_friction,
    measure_friction,
    read_torque_log,
    write_friction_table,
)

read_endurance_log = read_torque_log
"""The name in this stage of `erlif.joint.friction.read_torque_log`."""

# earlier names of what erlif.friction holds
analyse_reversals = analyse_friction
describe_reversals = describe_friction
write_reversal_table = write_friction_table

__all__ = [
    "QUANTITIES",
    "SEVERAL",
    "DesignComparison",
    "EnduranceResult",
    "FailureLoad",
    "LogColumns",
    "Onset",
    "OnsetSearch",
    "ReversalSeries",
    "Stage",
    "StageFriction",
    "Witness",
    "analyse_endurance",
    "analyse_reversals",
    "compare_designs",
    "describe_designs",
    "describe_reversals",
    "describe_test",
    "failure_load",
    "find_onset",
    "find_stages",
    "hear_witnesses",
    "join_stages",
    "measure_friction",
    "read_endurance_log",
    "write_reversal_table",
    "write_test_table",
]
