"""Light of simulated cells by the narrow-band law, written out here."""

import numpy as np

from erlif.ratio import LightCells, cell_places
from erlif.show.plots import example_calibration

CALIBRATION = example_calibration()
K, P, Q = CALIBRATION.parameters
X, Y = cell_places()


def draw_run(
    rng,
    *,
    background=(0.0, 0.0),
    frames=50,
    films=(2.0, 5.0),
    speckle=0.01,
    meter=0.005,
    flat=False,
):
    """Record and logged energies of a run whose calibration errs within its covariance.

    Minimum films lie between two `films` [um]; `flat` is one film and one illumination in all
    cells. Shares: background of the median light of each camera, speckle and meter of the light.
    """
    phase = 2 * np.pi * np.arange(frames) / frames
    minimum = np.mean(films) + np.ptp(films) / 2 * np.cos(phase)
    form = 0.0 * X if flat else 5.0 * X**2 + 0.3 * Y + 0.1 * np.sin(9 * X + 5 * Y)
    gap = minimum[:, None] + form

    error = rng.multivariate_normal(np.zeros(3), CALIBRATION.covariance)
    k, p, q = np.array([K, P, Q]) - error

    energy = 1 + 0.03 * rng.standard_normal(frames)
    beam = 1.0 if flat else np.exp(-0.4 * (X**2 + Y**2))
    illumination = 800 * beam * energy[:, None] * np.ones_like(gap)
    illumination = illumination * np.exp(speckle * rng.standard_normal(gap.shape))

    # light of both bands, in which the background is a share of the median, and its noise
    one = illumination * (1 - np.exp(-p * gap)) / p
    two = k * illumination * (1 - np.exp(-q * gap)) / q
    one, two = (
        light + share * np.median(light) * energy[:, None]
        for light, share in zip((one, two), background, strict=True)
    )

    variance = np.full(gap.shape, 1e-6)
    ratio = np.log(two / one) + np.sqrt(variance) * rng.standard_normal(gap.shape)
    logged = energy * (1 + meter * rng.standard_normal(frames))
    return LightCells(np.log(one), ratio, np.zeros(gap.shape), variance), logged
