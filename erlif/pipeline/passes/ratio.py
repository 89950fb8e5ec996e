"""Light of one frame pair to the logarithm of its ratio, with variances and flags.

Warp and ratio take turns over bands of rows, so that few rows of the noise of both cameras are kept
at a time.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from erlif.core.flags import Flag
from erlif.correction import NoiseTables, PairLight
from erlif.correction.light import fill_noise
from erlif.pipeline.passes.warp import MapTables, PairWarp, Warp
from erlif.ratio import PairRatio, flag_bubbles
from erlif.ratio.log_ratio import correlate_noise, divide_rows
from erlif.ratio.softening import FARTHEST, Softening

# Rows of a band, and of the noise that is kept: a ratio that is blurred needs rows above and below.
BAND = 64
KEPT = BAND + 2 * FARTHEST

_POOR = np.uint16(Flag.POOR_REGISTRATION)


def measure_ratio(
    light: PairLight,
    tables: MapTables,
    noise: tuple[NoiseTables, NoiseTables],
    drift: tuple[float, float],
    *,
    softening: Softening,
    no_film_below: float,
    warped: PairWarp,
    out: PairRatio,
) -> PairRatio:
    """Logarithm of camera 2 over camera 1 of one frame pair.

    Parameters
    ----------
    light : PairLight
    tables : MapTables
    noise : tuple of two NoiseTables
        Of camera 1, and of camera 2 turned as its image is.
    drift : tuple of float
        Translation (x, y) of camera 2; NaN where it is not known. [px]
    softening : Softening
        Blur of the sharper camera.
    no_film_below : float
        Light relative to the surroundings below which both bands show a bubble. [1]
    warped : PairWarp
        Receives camera 2, its variances and flags in at least `KEPT` rows.
    out : PairRatio
        Its images are filled.

    Returns
    -------
    PairRatio
        With the images of `out`.
    """
    arrays, reach = softening.arrays, max(softening.reach, 1)
    warp = Warp(light, tables, noise[1], drift, warped, band=BAND)
    height = out.log_ratio.shape[0]
    total = of_two = 0.0
    done = last = 0
    noise_one, energy = tuple(noise[0]), np.float32(light.energy[0])
    var_one, fixed_one = np.empty((2, KEPT, out.log_ratio.shape[1]), np.float32)

    # a row of the ratio needs rows of camera 2 below it, so that of each band some are left over;
    # the first of these needs as many above
    for start in range(0, height, BAND):
        stop = min(start + BAND, height)
        first = max(done - reach, 0)
        for kept in (warped.variance, warped.variance_fixed, warped.flags):
            kept[: start - first] = kept[first - last : start - last].copy()
        warp.fill(start, stop, first=first)
        warped.flags[start - first : stop - first] |= tables.flags[start:stop]
        last = first

        # the variances of camera 1 are made where they are read, a band at a time
        ready = stop if stop == height else stop - reach
        fill_noise(light.light[0], noise_one, energy, var_one, fixed_one, done, ready)
        variances = var_one, fixed_one, warped.variance, warped.variance_fixed
        flags = light.flags[0], warped.flags
        rows = first, done, ready
        sums = divide_rows(
            light.light[0],
            warped.light,
            *variances,
            *flags,
            tables.variance,
            *arrays,
            *out.images,
            *rows,
        )
        total, of_two, done = total + sums[0], of_two + sums[1], ready

    # NaN drift leaves no pixel valid, and the reason belongs in the flags
    if np.isnan(drift[0]):
        out.flags[:] |= _POOR
    flag_bubbles(light.light[0], warped.light, out.flags, share=no_film_below)

    one, two = light.peaks
    return replace(
        out,
        light_one=light.light[0],
        noise_correlation=correlate_noise(
            total, of_two, warp.averaging, softening=softening.factors
        ),
        drift=(float(drift[0]), float(drift[1])),
        peaks=(int(one), int(two)),
    )
