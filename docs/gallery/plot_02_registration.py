"""
Registration: the map between the cameras
=========================================

The displacement is the position of an object point in camera 2 minus its position in camera 1,
in pixels. It is fixed by the optics. On top of it each frame has a drift, a small translation,
because the cameras vibrate.
"""

import matplotlib.pyplot as plt
from sample import FILM

import erlif

registration = erlif.open_film(FILM, group="registration")
frames = erlif.open_film(FILM, group="frames")

fig, panels = plt.subplot_mosaic(
    "xy;dd", figsize=(8, 5.2), height_ratios=(1.5, 1), layout="constrained"
)
erlif.plots.displacement_map(registration, component="x", ax=panels["x"])
erlif.plots.displacement_map(registration, component="y", ax=panels["y"])
erlif.plots.drift_of_frames(frames, ax=panels["d"])
plt.show()

# %%
# The group ``registration`` also holds the standard deviation of the displacement at every pixel.

std = registration.displacement_std
print(f"median standard deviation of the displacement: {float(std.median()):.4f} px")
