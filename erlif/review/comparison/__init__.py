"""Runs against each other: what differs, by how much, and how sure that is."""

from erlif.review.comparison.compare import compare
from erlif.review.comparison.control import control_chart
from erlif.review.comparison.difference import PairDifference, average_difference, correct_for_many
from erlif.review.comparison.maps import difference_map
from erlif.review.comparison.records import RunRecord, read_run, refuse_unlike
from erlif.review.comparison.table import describe_comparison

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
]
