"""A film in the formats of other programs: table, MATLAB, ImageJ, ParaView."""

from erlif.io.conversion.contents import TriggerColumn, choose_trigger, maps_of, trigger_columns
from erlif.io.conversion.export import EXPORTS, export, format_of
from erlif.io.conversion.surface import find_surface
from erlif.io.conversion.table import table_csv

__all__ = [
    "EXPORTS",
    "TriggerColumn",
    "choose_trigger",
    "export",
    "find_surface",
    "format_of",
    "maps_of",
    "table_csv",
    "trigger_columns",
]
