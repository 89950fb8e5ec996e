"""What erlif writes and reads back: films, unfinished work, outputs replaced in one step."""

from erlif.files.compression import MapVariable, compress, decompress, round_bits
from erlif.files.contents import (
    check_trigger,
    describe_trigger,
    fastest_trigger,
    has_identity,
    region_of,
    settings_of,
)
from erlif.files.film import describe_hashes, open_film, write_dataset, write_film
from erlif.files.netcdf import has_group, open_netcdf
from erlif.files.replacing import refuse_existing, replacing
from erlif.files.unfinished import PartialFilm

__all__ = [
    "MapVariable",
    "PartialFilm",
    "check_trigger",
    "compress",
    "decompress",
    "describe_hashes",
    "describe_trigger",
    "fastest_trigger",
    "has_group",
    "has_identity",
    "open_film",
    "open_netcdf",
    "refuse_existing",
    "region_of",
    "replacing",
    "round_bits",
    "settings_of",
    "write_dataset",
    "write_film",
]
