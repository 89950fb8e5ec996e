"""Endurance tests of bearings: log to friction, stages, onset of galling and load at failure."""

from erlif.joint.endurance.analysis import (
    EnduranceResult,
    FailureLoad,
    analyse_endurance,
    failure_load,
)
from erlif.joint.endurance.blocks import StageFriction
from erlif.joint.endurance.comparison import DesignComparison, compare_designs
from erlif.joint.endurance.onset import Onset
from erlif.joint.endurance.other_sensors import SensorChange, check_other_sensors
from erlif.joint.endurance.search import OnsetSearch, find_onset
from erlif.joint.endurance.stages import Stage, find_stages, join_stages
from erlif.joint.endurance.summary import (
    describe_designs,
    describe_test,
    describe_tests,
    write_test_table,
)
from erlif.joint.friction import LogColumns, measure_friction, read_torque_log

__all__ = [
    "DesignComparison",
    "EnduranceResult",
    "FailureLoad",
    "LogColumns",
    "Onset",
    "OnsetSearch",
    "SensorChange",
    "Stage",
    "StageFriction",
    "analyse_endurance",
    "check_other_sensors",
    "compare_designs",
    "describe_designs",
    "describe_test",
    "describe_tests",
    "failure_load",
    "find_onset",
    "find_stages",
    "join_stages",
    "measure_friction",
    "read_torque_log",
    "write_test_table",
]
