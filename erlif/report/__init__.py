"""A film or a calibration for its reader: one page with a viewer, or a few lines of text."""

from erlif.report.budget import render_budget
from erlif.report.maps import MapCoding, decode_map, embed_map
from erlif.report.page import write_report
from erlif.report.summary import describe_calibration, summarise

__all__ = [
    "MapCoding",
    "decode_map",
    "describe_calibration",
    "embed_map",
    "render_budget",
    "summarise",
    "write_report",
]
