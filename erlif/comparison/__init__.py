"""Runs against each other: what differs, by how much, and how sure that is."""

from erlif.comparison.compare import compare
from erlif.comparison.control import control_chart
from erlif.comparison.difference import PairDifference, average_difference, correct_for_many
from erlif.comparison.maps import difference_map
from erlif.comparison.records import RunRecord, read_run, refuse_unlike
from erlif.comparison.table import describe_comparison, write_pair_table

__all__ = [
    "PairDifference",
    "RunRecord",
    "average_difference",
    "compare",
    "control_chart",
    "correct_for_many",
    "describe_comparison",
    "difference_map",
    "read_run",
    "refuse_unlike",
    "write_pair_table",
]
