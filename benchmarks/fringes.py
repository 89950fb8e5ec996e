"""Interference of the light in a film: how far it changes the ratio, by wall and film.

``python benchmarks/fringes.py`` prints the rms of the logarithm of the ratio about its smooth
course, in %, for films of 1 to 8 um. Laser and emission of each depth interfere with what the wall
returns of them (Lambacher and Fromherz 1996), and the emission with what the window returns of
that. The oil has a refractive index of 1.48, the dyes and filters are those of the virtual rig,
the laser is coherent, and the wall is flat over a pixel.
"""

from __future__ import annotations

import numpy as np

from erlif.core.arrays import Array
from erlif.rig.dyes import BANDS, LASER, absorption, emission, transmission

INDEX = 1.48
WALLS = {"acrylic, 1.49": (1.49, 1.49), "glass, 1.52": (1.52, 1.52), "metal, 50 %": (None, 1.52)}
FILMS = 1.0, 2.0, 3.0, 5.0, 8.0
METAL = 0.5**0.5  # amplitude
AROUND = np.arange(-0.4, 0.4, 0.012)  # um: two fringes to either side, 0.2 um apart


def returned(index: float | None) -> float:
    """Amplitude that a surface returns."""
    return METAL if index is None else abs(index - INDEX) / (index + INDEX)


def light(film: float, band: float, wall: float, window: float) -> float:
    """Light of a film [um] behind the filter of a band [nm]."""
    wavelength = np.arange(band - 12, band + 12, 0.05)
    depth = np.linspace(0, film, max(200, int(60 * film)))
    waves = 2e3 * np.pi * INDEX / wavelength
    into, out = absorption(np.asarray(LASER)), absorption(wavelength)

    def interfering(rate: Array, wave: Array) -> Array:
        there, back = (np.exp(-np.outer(way, rate) / 2) for way in (depth, 2 * film - depth))
        beat = np.cos(2 * np.outer(film - depth, wave))
        return np.asarray(there**2 + (wall * back) ** 2 + 2 * wall * there * back * beat)

    laser = interfering(np.atleast_1d(into), np.atleast_1d(2e3 * np.pi * INDEX / LASER))
    again = wall * window * np.exp(-out * film)
    between = 1 / (1 + again**2 - 2 * again * np.cos(2 * waves * film))
    leaving = np.trapezoid(laser * interfering(out, waves), depth, axis=0) * between
    return float(np.trapezoid(transmission(wavelength, band) * emission(wavelength) * leaving))


def main() -> None:
    """Print the table."""
    print(f"{'wall and window':16s}" + "".join(f"{film:8.0f} um" for film in FILMS))
    for name, (wall, window) in WALLS.items():
        sides, row = (returned(wall), returned(window)), []
        for film in FILMS:
            films = film + AROUND
            ratio = [np.log(light(h, BANDS[1], *sides) / light(h, BANDS[0], *sides)) for h in films]
            rest = ratio - np.polyval(np.polyfit(AROUND, ratio, 4), AROUND)
            # without the ends, which the polynomial follows
            row.append(100 * rest[5:-5].std())
        print(f"{name:16s}" + "".join(f"{one:11.3f}" for one in row))


if __name__ == "__main__":
    main()
