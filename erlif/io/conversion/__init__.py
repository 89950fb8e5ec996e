"""A film in the formats of other programs: table, MATLAB, ImageJ, ParaView, numpy."""

from erlif.io.conversion.contents import TriggerColumn, choose_trigger, maps_of, trigger_columns
from erlif.io.conversion.export import FORMATS, export, format_of
from erlif.io.conversion.surface import find_surface
from erlif.io.conversion.table import table_csv

__all__ = [
    "FORMATS",
    "TriggerColumn",
    "choose_trigger",
    "export",
    "find_surface",
    "format_of",
    "maps_of",
    "table_csv",
    "trigger_columns",
]
