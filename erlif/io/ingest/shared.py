"""Both cameras in one file: the key of the settings that separates them.

`erlif init` proposes what the file shows; the user has to check it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from erlif.core.arrays import Array, Counts
from erlif.core.errors import FrameError
from erlif.io.ingest.naming import purpose_of, split_words
from erlif.io.readers import open_frames
from erlif.io.readers.hdf5 import list_datasets

# Pixels along the longer side of the halves that are compared; larger ones are thinned.
_MOST_SIDE = 256

# Peak of the correlation of two halves over its own standard deviation from which they show the
# same object; the highest of 2**15 values of pure noise is at 4.5.
_ALIKE = 8.0


@dataclass(frozen=True)
class SharedFile:
    """Separation of the counts of two cameras within one file.

    Attributes
    ----------
    key : Literal["part", "dataset"]
        Key in [camera1] and [camera2].
    values : tuple[str, str]
        Its value for camera 1 and camera 2.
    reason : str
        What in the file shows it.
    darks : tuple[str, str] | None
        Datasets of dark frames of both cameras; None where there are none.
    flats : tuple[str, str] | None
        Datasets of flat frames of both cameras; None where there are none.
    """

    key: Literal["part", "dataset"]
    values: tuple[str, str]
    reason: str
    darks: tuple[str, str] | None = None
    flats: tuple[str, str] | None = None


def find_cameras_in_file(path: Path, rows: Collection[int] = ()) -> SharedFile | None:
    """Look for two cameras in one file.

    Parameters
    ----------
    path : Path
        File with the only frames that were found.
    rows : collection of int
        Numbers of rows of the tables beside it: one row belongs to one frame pair.

    Returns
    -------
    SharedFile or None
        None where nothing in the file shows two cameras.

    Examples
    --------
    Four alternating pages and a log of two rows:

    >>> import tempfile, tifffile
    >>> path = Path(tempfile.mkdtemp(), "both.tif")
    >>> tifffile.imwrite(path, np.zeros((4, 64, 64), np.uint16), photometric="minisblack")
    >>> find_cameras_in_file(path, rows=[2]).values
    ('odd', 'even')
    """
    datasets = list_datasets(path)
    if len(datasets) > 1:
        return _sort_datasets(datasets)
    try:
        with closing(open_frames(path)) as file:
            if file.channels is not None and set(file.channels) >= {1, 2}:
                channels = ("channel 1", "channel 2")
                return SharedFile("part", channels, "the file has several channels")
            count = len(file.kinds)
            if count not in rows and count % 2 == 0 and count // 2 in rows:
                reason = f"{count} pages, and a table of {count // 2} rows"
                return SharedFile("part", ("odd", "even"), reason)
            return _compare_halves(file.read(0))
    except FrameError:
        return None


def _sort_datasets(names: list[str]) -> SharedFile | None:
    """Frames, darks and flats of both cameras by the names of their datasets."""
    groups: dict[str, list[str]] = defaultdict(list)
    for name in names:
        groups[purpose_of(split_words(name))].append(name)
    frames, darks, flats = (
        (found[0], found[1]) if len(found := groups[purpose]) == 2 else None
        for purpose in ("frames", "darks", "flats")
    )
    if frames is None:
        return None
    return SharedFile("dataset", frames, "the file has two datasets of frames", darks, flats)


def _compare_halves(image: Counts) -> SharedFile | None:
    """Halves of a sensor that show the same object, found by their correlation."""
    if image.ndim != 2 or min(image.shape) < 128 or not np.isfinite(image).all():
        return None
    rows, columns = image.shape
    pairs = {
        ("left", "right"): (image[:, : columns // 2], image[:, columns - columns // 2 :]),
        ("top", "bottom"): (image[: rows // 2], image[rows - rows // 2 :]),
    }
    peaks = {names: _similarity(*halves) for names, halves in pairs.items()}
    best = max(peaks, key=lambda names: peaks[names])
    if peaks[best] < _ALIKE:
        return None
    return SharedFile("part", best, f"its {best[0]} and {best[1]} halves show the same object")


def _similarity(one: Counts, two: Counts) -> float:
    """Peak of the phase correlation of two images over its standard deviation. [1]"""
    step = max(1, max(one.shape) // _MOST_SIDE)
    spectra = []
    for image in (one, two):
        thinned: Array = image[::step, ::step].astype(np.float64)
        window = np.outer(np.hanning(thinned.shape[0]), np.hanning(thinned.shape[1]))
        spectra.append(np.fft.rfft2((thinned - thinned.mean()) * window))

    # all frequencies count alike, so that the profile of the laser does not decide
    product = spectra[0] * np.conj(spectra[1])
    correlation = np.fft.irfft2(product / np.maximum(np.abs(product), 1e-12))
    deviation = float(correlation.std())
    return float(correlation.max() / deviation) if deviation else 0.0
