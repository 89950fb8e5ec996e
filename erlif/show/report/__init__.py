"""A film or a calibration for its reader: one page with a viewer, or a few lines of text."""

from typing import TYPE_CHECKING, Any

from erlif.show.report.budget import render_budget
from erlif.show.report.design import list_materials, summarise_design
from erlif.show.report.linkage import summarise_linkages
from erlif.show.report.maps import MapCoding, decode_map, embed_map
from erlif.show.report.plan import check_plan_output, summarise_plan, write_plan
from erlif.show.report.prediction import summarise_prediction
from erlif.show.report.summary import describe_calibration, summarise, summarise_in_a_line

if TYPE_CHECKING:
    from erlif.show.report.check_page import write_check_page
    from erlif.show.report.design_page import make_design_page, write_design_page
    from erlif.show.report.page import write_report
    from erlif.show.report.runs import write_runs_report

__all__ = [
    "MapCoding",
    "check_plan_output",
    "decode_map",
    "describe_calibration",
    "embed_map",
    "list_materials",
    "make_design_page",
    "render_budget",
    "summarise",
    "summarise_design",
    "summarise_in_a_line",
    "summarise_linkages",
    "summarise_plan",
    "summarise_prediction",
    "write_check_page",
    "write_design_page",
    "write_plan",
    "write_report",
    "write_runs_report",
]


def __getattr__(name: str) -> Any:
    """Load a page, and matplotlib with it, when it is first used."""
    if name == "write_check_page":
        from erlif.show.report.check_page import write_check_page

        return write_check_page
    if name in ("make_design_page", "write_design_page"):
        from erlif.show.report import design_page

        return getattr(design_page, name)
    if name == "write_report":
        from erlif.show.report.page import write_report

        return write_report
    if name == "write_runs_report":
        from erlif.show.report.runs import write_runs_report

        return write_runs_report
    raise AttributeError(f"module 'erlif.show.report' has no attribute {name!r}")
