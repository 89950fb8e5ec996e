"""Stacks of images for ImageJ and Fiji, as TIFF."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray
from erlif.core.progress import Progress
from erlif.core.version import __version__
from erlif.io.conversion.contents import maps_of
from erlif.io.files import describe_trigger
from erlif.io.files.headers import MAPS

# Size from which on the stack has one directory for all images, in place of one for each: addresses
# of TIFF end at 4 GiB. ImageJ finds the images by their order. [byte]
LARGEST = 2**32 - 2**20

_DISPLAYED = (1.0, 99.0)  # per cent of the pixels within the displayed range
_ALL_FLAGS = 255.0


def write_stack(film: xr.Dataset, output: Path, *, triggers: list[int], progress: Progress) -> None:
    """Write a hyperstack with a channel for each map and a time for each trigger.

    Flags are numbers from 0 to 255 in the fourth channel. Pixels without a thickness are NaN.

    Arguments as in `write_matlab`.
    """
    import tifffile

    shape = (len(triggers), len(MAPS), film.sizes["y"], film.sizes["x"])
    labels = [
        f"{name} {film[name].attrs.get('units', '')}".removesuffix(" 1")
        + f", {describe_trigger(film, trigger)}"
        for trigger in triggers
        for name in MAPS
    ]

    def images() -> Iterator[AnyArray]:
        for k, trigger in enumerate(triggers):
            for _, image in maps_of(film, trigger):
                yield image.astype(np.float32)
            progress("maps", k + 1, len(triggers))

    with tifffile.TiffWriter(output, imagej=True) as writer:
        writer.write(
            images(),
            shape=shape,
            dtype=np.float32,
            photometric="minisblack",
            resolution=(_per_mm(film.x.values), _per_mm(film.y.values)),
            software=f"erlif {__version__}",
            truncate=4 * int(np.prod(shape)) > LARGEST,
            metadata={
                "axes": "TCYX",
                "unit": "mm",
                "mode": "grayscale",
                "Labels": labels,
                "Ranges": _ranges(film, triggers),
                "Info": f"{film.attrs.get('title', '')}\n{film.attrs.get('settings', '')}",
            },
        )


def _per_mm(place: AnyArray) -> float:
    """Pixels per mm along an axis, whichever way it runs; 1 for a single pixel."""
    return 1.0 if place.size < 2 else (place.size - 1) / abs(float(place[-1] - place[0]))


def _ranges(film: xr.Dataset, triggers: list[int]) -> tuple[float, ...]:
    """Smallest and largest displayed value of each channel, from the trigger in the middle."""
    limits: list[float] = []
    for name, image in maps_of(film, triggers[len(triggers) // 2]):
        known = image[np.isfinite(image)]
        low, high = np.percentile(known, _DISPLAYED) if known.size else (0.0, 1.0)
        limits += (0.0, _ALL_FLAGS) if name == "flags" else (float(low), float(high))
    return tuple(limits)
