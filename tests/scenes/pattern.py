"""Cells of a film that moves, with a fixed factor of the ratio and marks."""

import numpy as np

from erlif.ratio.cells import LightCells, cell_centres
from erlif.show.plots import example_calibration

SHAPE = 400, 480
CENTRES = cell_centres(SHAPE)
CURVE = example_calibration()
NOISE = 1e-3


def draw_field(length, rng, places=CENTRES, count=()):
    """Gaussian fields of standard deviation 1 at places, correlated as exp(-d^2 / length^2)."""
    apart = sum(np.subtract.outer(at, at) ** 2 for at in places)
    root = np.linalg.cholesky(np.exp(-apart / length**2) + 1e-9 * np.eye(len(apart)))
    return rng.standard_normal((*count, len(apart))) @ root.T


def photograph(
    factor, *, swing=1.5, marks=0.1, frames=40, seed=0, centres=CENTRES, acts=np.ones_like
):
    """Cells of a film that moves by `swing` [um] about 4 um, with a fixed factor of the ratio."""
    rng = np.random.default_rng(seed)
    x, y = (2 * at / np.ptp(at) - 1 for at in centres)
    move = swing * np.sin(np.linspace(0, 2 * np.pi, frames))
    film = 4 + move[:, None] + 0.8 * x**2 + 0.1 * y + marks * rng.standard_normal(x.size)
    log_ratio = (
        CURVE.predict_log(film) + factor * acts(film) + NOISE * rng.standard_normal(film.shape)
    )
    return LightCells(0 * film, log_ratio, 0 * film, 0 * film + NOISE**2)


def act_of_wall(film, mean=0.0):
    """Change of the log ratio with the reflectance of a wall, 0 to 1, over that at 4 um.

    By an integral of the light of each depth, whose laser comes from the window and returns from
    the wall, as does its own light. Both attenuations are those of laser and light together.
    """
    _, p, q = CURVE.parameters
    laser = 0.8 * q
    depth = (np.arange(2000) + 0.5) / 2000

    def log_light(of, band, reflectance):
        z, back = of * depth, of * (2 - depth)
        into, out = (np.exp(-a * z) + reflectance * np.exp(-a * back) for a in (laser, band))
        return np.log(np.mean(into * out))

    def change(of):
        both = (mean + 1e-4, mean)
        two, one = (log_light(of, q - laser, R) - log_light(of, p - laser, R) for R in both)
        return two - one

    of_four = change(4.0)
    return np.vectorize(change, otypes=[float])(film) / of_four
