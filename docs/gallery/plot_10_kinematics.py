"""
Encoder log and linkage
=======================

The encoder gives an angle for each frame. The linkage turns it into crank angle and exact rocker
speed. The outward stroke (angle rising) has a positive speed, the return stroke a negative one.
"""

import matplotlib.pyplot as plt
from sample import FILM

import erlif

film = erlif.open_film(FILM)

fig, (speed, thickness) = plt.subplots(2, figsize=(6.5, 6.5), layout="constrained")
erlif.plots.speed_against_angle(film, ax=speed)
erlif.plots.film_over_cycle(film, ax=thickness)
plt.show()

# %%
# The speed is not the one of the simple rule, crank speed times crank over rocker:

rule = 114 / 60 * 2 * 3.141592653589793 * 5.5 / 26
print(
    f"rule {rule:.4f} rad/s; exact, at the triggers: "
    f"{float(film.rocker_speed.min()):.4f} to {float(film.rocker_speed.max()):.4f} rad/s"
)
