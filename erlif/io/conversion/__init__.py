"""A film in the formats of other programs: table, MATLAB, ImageJ, ParaView."""

from erlif.io.conversion.contents import (
    TriggerColumn,
    choose_trigger,
    maps_of,
    table_columns,
    trigger_columns,
)
from erlif.io.conversion.export import EXPORTS, export, format_of, table_csv
from erlif.io.conversion.vtk_xml import find_surface

__all__ = [
    "EXPORTS",
    "TriggerColumn",
    "choose_trigger",
    "export",
    "find_surface",
    "format_of",
    "maps_of",
    "table_columns",
    "table_csv",
    "trigger_columns",
]
