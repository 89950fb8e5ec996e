"""The count at which a camera saturates."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from erlif.ingest import Recording, read_frames

_BELOW = 16  # counts below a pile-up that must hold few pixels, each
_STEEP = 5  # times as many pixels at the pile-up as at any of those counts
_LEAST_PILE = 20  # pixels


def find_pile_up(histogram: npt.NDArray[np.int64]) -> int | None:
    """Find the count at which a camera saturates below its full scale: many pixels there, few just below, hardly one above.

    The counts of an image thin out towards its brightest ones, so that the highest count has few pixels and never many
    times as many as the counts below it. A picture of fewer than 16 different counts is not judged. A camera whose pixels
    saturate at counts of their own, as after a correction inside the camera, shows no pile-up.

    Parameters
    ----------
    histogram : array of int, (full scale + 1,)
        Pixels by count, of one image or several.

    Returns
    -------
    int or None
        The count, None where there is no pile-up below full scale. [DN]
    """
    if np.count_nonzero(histogram) < _BELOW:
        return None
    above = histogram[::-1].cumsum()[::-1] - histogram
    for count in np.nonzero((histogram >= _LEAST_PILE) & (100 * above < histogram))[0][::-1]:
        below = histogram[max(count - _BELOW, 0) : count]
        if _BELOW <= count < histogram.size - 1 and histogram[count] > _STEEP * below.max():
            return int(count)
    return None


_FRAMES_SEEN = 8  # frames searched for saturation below full scale


def _find_saturation_in_frames(recording: Recording) -> list[npt.NDArray[np.int64]]:
    """Pixels by count in a few frames of each camera."""
    usable = recording.frames
    places = np.unique(np.linspace(0, len(usable) - 1, _FRAMES_SEEN).round().astype(int))
    seen = [np.zeros(settings.full_scale + 1, np.int64) for settings in recording.cameras]
    for place in places:
        counts = read_frames(recording, [usable[place]]).counts.values
        for camera, histogram in enumerate(seen):
            histogram += np.bincount(counts[camera].ravel(), minlength=histogram.size)
    return seen
