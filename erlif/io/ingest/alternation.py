"""Two cameras whose pages alternate in one file: pages in the place of the other camera."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from erlif.core.arrays import AnyArray, Mask
from erlif.core.errors import FrameError
from erlif.core.notes import list_some
from erlif.io.ingest.images import Page, read_page

# Side of the thinned images that are compared. [px]
_SIDE = 32

# Pages whose turns are trusted at first: three of four pairs may not be exchanged.
_FIRST = 8

# Gap between the pages of two cameras, in their whole range, below which nothing is found.
_CLEAR = 0.1

_ROUNDS = 3  # until pages and direction agree


def check_turns(
    one: Sequence[Page], two: Sequence[Page], directory: Path, shape: tuple[int, ...]
) -> None:
    """Refuse alternating pages where a camera has the place of the other.

    Parameters
    ----------
    one, two : sequence of Page
        Of camera 1 and camera 2.
    directory : Path
    shape : (rows, columns)

    Raises
    ------
    FrameError
        Names the pages.
    """
    files = {path: n for n, path in enumerate(dict.fromkeys(page.path for page in (*one, *two)))}
    pages = sorted((*one, *two), key=lambda page: (files[page.path], page.index))
    mine = set(one)
    step = max(1, min(shape) // _SIDE)
    images = np.stack(
        [read_page(page, directory, shape)[::step, ::step].astype(np.float32) for page in pages]
    )
    wrong = find_exchanged(images, np.array([page in mine for page in pages]))
    if not wrong:
        return
    fault = f"{list_some((pages[k].name for k in wrong), most=4)} are exchanged"
    if wrong[-1] == len(pages) - 1:
        fault = f"from {pages[wrong[0]].name} on they have changed places: a page may be missing"
    raise FrameError(
        f"Expected pages of camera 1 and camera 2 in turn; {fault}. Export the recording with a "
        "file for each camera, or leave out the pairs of these pages."
    )


def find_exchanged(images: AnyArray, expected: Mask) -> list[int]:
    """Pages that are like those of the other camera.

    Parameters
    ----------
    images : array, (page, y, x)
    expected : array of bool, (page,)
        Whether a page should be of camera 1.

    Returns
    -------
    list of int
        Empty where the images of the cameras are not clearly different.
    """
    if len(images) < _FIRST:
        return []
    flat = images.reshape(len(images), -1)
    flat = flat / np.maximum(flat.mean(axis=1, keepdims=True), 1)  # pulses differ in energy
    flat -= flat.mean(axis=0)

    # from the first pages on: the direction in which the cameras differ, and the pages along it
    axis = np.where(expected, 1, -1)[:_FIRST] @ flat[:_FIRST]
    for _ in range(_ROUNDS):
        along = flat @ axis
        low, high = along.min(), along.max()
        is_one = along > (low + high) / 2
        if low == high:
            return []
        axis = flat[is_one].mean(axis=0) - flat[~is_one].mean(axis=0)
    along = flat @ axis
    if along[is_one].min() - along[~is_one].max() < _CLEAR * np.ptp(along):
        return []

    # a film that changes divides the pages of each camera alike; cameras change places in pairs
    wrong = is_one != expected
    lengths = np.diff(np.flatnonzero(np.diff(wrong, prepend=False, append=False)))[::2]
    lengths = lengths[:-1] if wrong[-1] else lengths
    return [] if (lengths % 2).any() else np.flatnonzero(wrong).tolist()
