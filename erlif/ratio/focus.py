"""Sharpness of a camera in one frame, by the texture of its light."""

from __future__ import annotations

from erlif.core.arrays import FAST, FlagImage, Image
from erlif.core.speed.kernels import njit
from erlif.correction import NoiseTables

_LAG = 4  # px: distance over which speckle is hardly correlated

_ROWS = 256  # rows of an image that are looked at, evenly spread

_FEWEST = 1000  # pairs of sound pixels, at least


def measure_sharpness(light: Image, flags: FlagImage, noise: NoiseTables) -> float:
    """Ratio of squared differences of neighbours in a row to those of distant pixels.

    Differences are relative to the light and without the variance of the noise: film and energy of
    the pulse do not enter. A blur lowers the difference of neighbours more.

    Parameters
    ----------
    light : array, (y, x)
        Of one camera. [DN]
    flags : array, (y, x)
        0 for sound pixels.
    noise : NoiseTables
        Of this camera.

    Returns
    -------
    float
        From 0, blurred, to 1, neighbours that have nothing in common; NaN without texture. [1]

    Examples
    --------
    >>> import numpy as np
    >>> rng = np.random.default_rng(1)
    >>> sharp = (1000 + 100 * rng.standard_normal((80, 96))).astype(np.float32)
    >>> soft = (0.5 * sharp + 0.5 * np.roll(sharp, 1, axis=1)).astype(np.float32)
    >>> none, one = np.zeros((0, 0), np.float32), np.ones(sharp.shape, np.float32)
    >>> exact = NoiseTables(one, none, none, none, none, np.zeros(3, np.float32))
    >>> flags = np.zeros(sharp.shape, np.uint16)
    >>> [round(measure_sharpness(image, flags, exact), 1) for image in (sharp, soft)]
    [1.0, 0.5]
    """
    step = max(light.shape[0] // _ROWS, 1)
    near, far, count = _sum_differences(light, flags, noise.per_flat, noise.numbers, step)
    if count < _FEWEST or near <= 0 or far <= 0:
        return float("nan")
    return float(near / far)


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _sum_differences(light, flags, per_flat, numbers, step):  # type: ignore[no-untyped-def]
    """Squared relative differences of neighbours and of distant pixels without noise, and pairs."""
    per_gain, read_var = numbers[0], numbers[1]
    near, far, count = 0.0, 0.0, 0
    for i in range(step // 2, light.shape[0], step):
        for j in range(light.shape[1] - _LAG):
            if flags[i, j] | flags[i, j + 1] | flags[i, j + _LAG]:
                continue
            one, next_one, distant = light[i, j], light[i, j + 1], light[i, j + _LAG]
            scale = per_flat[i, j]  # that of its neighbours is hardly different
            noise = 2 * read_var * scale * scale
            sum_near, sum_far = one + next_one, one + distant
            near += ((one - next_one) ** 2 - noise - sum_near * per_gain * scale) / sum_near**2
            far += ((one - distant) ** 2 - noise - sum_far * per_gain * scale) / sum_far**2
            count += 1
    return near, far, count
