"""
Orbit of the pin
================

The position of the pin in its bushing at every trigger, found from the gap that its map shows. The
ellipses are one standard deviation of the error: filled, the random one of each trigger; dashed,
with the errors of surfaces and calibration that all triggers share.
"""

import matplotlib.pyplot as plt
import numpy as np
from sample import FILM

import erlif

film = erlif.open_film(FILM)

fig, (orbit, closest, curvature) = plt.subplots(3, figsize=(6, 9), layout="constrained")
erlif.plots.pin_orbit(film, ax=orbit)
erlif.plots.closest_film(film, ax=closest)
erlif.plots.gap_curvature(film, ax=curvature)
plt.show()

# %%
# The covariance keeps the parts apart. The mean over all triggers has less random error, but the
# errors of surfaces and calibration stay as they are:

covariance = erlif.trend.pin_covariance(film)
one = np.sqrt(film.pin_position_cov.values[0, 0, 0])
mean = np.sqrt(covariance[::4, ::4].mean())
print(f"displacement towards the load: {1e3 * one:.1f} nm at one trigger, {1e3 * mean:.1f} nm mean")
