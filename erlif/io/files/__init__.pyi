from .compression import MapVariable, round_map
from .contents import (
    axis_labels,
    check_trigger,
    describe_trigger,
    driven_link,
    fastest_trigger,
    flag_shares,
    has_identity,
    motion_of,
    region_of,
    settings_of,
)
from .coordinates import set_coordinates
from .film import describe_hashes, open_film, reading_film, write_dataset, write_film
from .labels import label_films, refuse_repeated
from .netcdf import fix_text, has_group, open_netcdf
from .netcdf_maps import NetcdfMaps
from .replacement import refuse_existing, replacing, replacing_set, write_file
from .unfinished import MapStore, PartialFilm, remove_remains
from .wanted import PRODUCTS, take, takes
from .zarr_maps import ZarrMaps

__all__ = [
    "PRODUCTS",
    "MapStore",
    "MapVariable",
    "NetcdfMaps",
    "PartialFilm",
    "ZarrMaps",
    "axis_labels",
    "check_trigger",
    "describe_hashes",
    "describe_trigger",
    "driven_link",
    "fastest_trigger",
    "fix_text",
    "flag_shares",
    "has_group",
    "has_identity",
    "label_films",
    "motion_of",
    "open_film",
    "open_netcdf",
    "reading_film",
    "refuse_existing",
    "refuse_repeated",
    "region_of",
    "remove_remains",
    "replacing",
    "replacing_set",
    "round_map",
    "set_coordinates",
    "settings_of",
    "take",
    "takes",
    "write_dataset",
    "write_file",
    "write_film",
]
