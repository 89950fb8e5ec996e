"""A processed run as one page: numbers, figures and a viewer of the maps, in a file that needs nothing else."""

from erlif.report.maps import decode_map, embed_map
from erlif.report.page import write_report
from erlif.report.summary import describe_calibration, summarise

__all__ = ["decode_map", "describe_calibration", "embed_map", "summarise", "write_report"]
