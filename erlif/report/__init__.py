"""A processed run as one page: numbers, figures and a viewer of the maps, in a file that needs nothing else."""

from erlif.report.maps import decode_map, embed_map
from erlif.report.page import write_report

__all__ = ["decode_map", "embed_map", "write_report"]
