from .check_page import write_check_page
from .comparison import write_comparison_page, write_pair_table
from .design import list_materials, summarise_design
from .design_page import make_design_page, write_design_page, write_design_table
from .linkage import summarise_linkages
from .page import write_report
from .plan import check_plan_output, summarise_plan, write_plan
from .prediction import summarise_prediction
from .runs import write_runs_report
from .summary import (
    describe_calibration,
    print_budget,
    render_budget,
    summarise,
    summarise_briefly,
    summarise_in_a_line,
)

__all__ = [
    "check_plan_output",
    "describe_calibration",
    "list_materials",
    "make_design_page",
    "print_budget",
    "render_budget",
    "summarise",
    "summarise_briefly",
    "summarise_design",
    "summarise_in_a_line",
    "summarise_linkages",
    "summarise_plan",
    "summarise_prediction",
    "write_check_page",
    "write_comparison_page",
    "write_design_page",
    "write_design_table",
    "write_pair_table",
    "write_plan",
    "write_report",
    "write_runs_report",
]
