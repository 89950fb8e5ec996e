"""What erlif writes and reads back: films, unfinished work, outputs replaced in one step."""

from erlif.io.files.compression import MapVariable, round_map
from erlif.io.files.contents import (
    axis_labels,
    check_trigger,
    describe_trigger,
    fastest_trigger,
    flag_shares,
    has_identity,
    motion_of,
    region_of,
    settings_of,
)
from erlif.io.files.coordinates import set_coordinates
from erlif.io.files.film import describe_hashes, open_film, reading_film, write_dataset, write_film
from erlif.io.files.labels import label_films, refuse_repeated
from erlif.io.files.netcdf import fix_text, has_group, open_netcdf
from erlif.io.files.netcdf_maps import NetcdfMaps
from erlif.io.files.replacing import refuse_existing, replacing, replacing_set
from erlif.io.files.store import MapStore
from erlif.io.files.unfinished import PartialFilm, remove_remains
from erlif.io.files.wanted import take, takes, takes_products
from erlif.io.files.zarr_maps import ZarrMaps

__all__ = [
    "MapStore",
    "MapVariable",
    "NetcdfMaps",
    "PartialFilm",
    "ZarrMaps",
    "axis_labels",
    "check_trigger",
    "describe_hashes",
    "describe_trigger",
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
    "takes_products",
    "write_dataset",
    "write_film",
]
