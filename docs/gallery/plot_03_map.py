"""
A map and its uncertainty
=========================

The film at one trigger, the standard deviation of a single pixel, and the part of it that all
pixels share. Pixels without a thickness are drawn in the colour of their flag.
"""

import matplotlib.pyplot as plt
from sample import FILM

import erlif

film = erlif.open_film(FILM)
trigger = 13
chosen = film.isel(trigger=trigger)
extent = (float(film.x[0]), float(film.x[-1]), float(film.y[-1]), float(film.y[0]))

fig, (top, left, right) = plt.subplots(3, figsize=(5.2, 10.5), layout="constrained")
erlif.plots.thickness_map(film, trigger=trigger, ax=top)
for ax, name, title in (
    (left, "thickness_std", "random part, single pixel [µm]"),
    (right, "thickness_std_shared", "shared part [µm]"),
):
    values = chosen[name]
    image = ax.imshow(values, extent=extent, cmap="cividis", vmax=float(values.quantile(0.99)))
    ax.set(title=title, xlabel="x [mm]", ylabel="y [mm]")
    fig.colorbar(image, ax=ax)
plt.show()

# %%
# The random part grows with the film, because the curve flattens and less light of camera 1
# leaves it. It shrinks in a mean over pixels or cycles. The shared part is smaller by more than
# a factor of ten, but no average reduces it.

region = chosen.sel(x=slice(4, 15), y=slice(2, 13))
mean, std = float(chosen.film_mean), float(chosen.film_mean_std)
print(f"mean film of the region: {mean:.3f} ± {std:.3f} um")
print(f"typical pixel:           {float(region.thickness_std.median()):.3f} um random")
print(f"                         {float(region.thickness_std_shared.median()):.3f} um shared")
