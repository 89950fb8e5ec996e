"""Plain numpy arrays by name, as NPZ."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.core.progress import Progress
from erlif.core.version import __version__
from erlif.io.conversion.contents import (
    MAPS,
    attributes_of,
    describe_units,
    maps_of_triggers,
    small_variables,
)

_LEVEL = 1  # of compression; the maps are rounded, and higher levels take three times as long


def write_archive(
    film: xr.Dataset, output: Path, *, triggers: list[int], progress: Progress
) -> None:
    """Write every variable as one array; units and attributes are JSON texts beside them.

    Maps are read and written one at a time.

    Parameters
    ----------
    film : xarray.Dataset
    output : Path
        File to write.
    triggers : list of int
        Triggers to write.
    progress : Progress
        Called after each map.
    """
    small = small_variables(film, triggers)
    small["units"] = np.array(json.dumps(describe_units(film), sort_keys=True))
    small["attributes"] = np.array(json.dumps(attributes_of(film), sort_keys=True))

    # numpy writes whole arrays only; the parts of the archive are those of numpy.savez, whose
    # date is fixed, so that the same film gives the same bytes
    with zipfile.ZipFile(output, "w", zipfile.ZIP_DEFLATED, compresslevel=_LEVEL) as archive:
        archive.comment = f"erlif {__version__}".encode()
        for name, values in small.items():
            with archive.open(f"{name}.npy", "w") as part:
                # numpy would pickle text of any length
                plain = values.astype(str) if values.dtype.kind == "O" else values
                np.lib.format.write_array(part, plain, allow_pickle=False)
        for name in MAPS:
            variable = film[name]
            shape = (len(triggers), *variable.shape[1:])
            with archive.open(f"{name}.npy", "w", force_zip64=True) as part:
                header = {
                    "descr": np.lib.format.dtype_to_descr(variable.dtype),
                    "fortran_order": False,
                    "shape": shape,
                }
                np.lib.format.write_array_header_1_0(part, header)
                for image in maps_of_triggers(film, name, triggers, progress):
                    part.write(image.tobytes())
