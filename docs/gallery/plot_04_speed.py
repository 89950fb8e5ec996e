"""
Film against speed
==================

Mean and minimum film thickness against rocker speed over load, on logarithmic axes, with the
fitted powers. The two strokes have different symbols.
"""

import matplotlib.pyplot as plt
from sample import FILM

import erlif

film = erlif.open_film(FILM)

fig, ax = plt.subplots(figsize=(6, 4.5), layout="constrained")
erlif.plots.film_against_speed(film, ax=ax)
plt.show()

# %%
# The joint of the sample oscillates, and squeeze carries its load: the film falls with the time
# since loading and does not follow the speed. Steady motion would give an exponent near 1.

print(f"exponent: {float(film.speed_exponent):.3f} ± {float(film.speed_exponent_std):.3f}")
