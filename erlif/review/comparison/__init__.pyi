from .control import control_chart
from .difference import PairDifference, average_difference, correct_for_many
from .maps import difference_map
from .records import RunRecord, read_run, refuse_unlike
from .runs import compare
from .table import NO_CHANCE, describe_comparison

__all__ = [
    "NO_CHANCE",
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
