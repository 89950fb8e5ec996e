"""
Reading film.nc in plain xarray
===============================

``film.nc`` is a netCDF-4 file that follows the CF conventions. xarray reads it without erlif.
"""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from sample import FILM

film = xr.open_dataset(FILM, engine="h5netcdf")
frames = xr.open_dataset(FILM, engine="h5netcdf", group="frames")

# %%
# Coordinates are in mm, thickness in um. A thickness is NaN exactly where ``flags`` is not 0, so
# a mean over the map needs no mask. Bits are named by the attributes of ``flags``.

flags = film.flags
meanings = dict(zip(flags.flag_meanings.split(), np.atleast_1d(flags.flag_masks), strict=True))
for name, bit in meanings.items():
    print(f"{name:18s} {float(((flags & bit) != 0).mean()):7.2%} of the pixels")

# %%
# A profile along the sliding direction, averaged over a strip 2 mm high, with the standard error
# of the mean from the random part. Pixels share some noise after interpolation, so the true
# error is slightly larger; ``erlif.show.plots.sliding_profile`` accounts for it.

strip = film.isel(trigger=13).sel(y=slice(6, 8))
mean = strip.thickness.mean("y")
valid = strip.thickness.notnull()
error = np.sqrt((strip.thickness_std**2).where(valid).sum("y")) / valid.sum("y")

fig, ax = plt.subplots(figsize=(6.5, 4), layout="constrained")
ax.fill_between(film.x, mean - error, mean + error, alpha=0.4, linewidth=0)
ax.plot(film.x, mean, linewidth=0.8)
ax.set(xlabel="x [mm]", ylabel="film thickness [µm]")
ax.set_title(f"{frames.sizes['frame']} frames; encoder at {float(strip.encoder_angle):.1f}°")
plt.show()
