"""
Measured and predicted film
===========================

The minimum film of every trigger beside the one that the transient Reynolds equation gives over
the motion of the frames, once its start is fitted. Below it is the film of the same joint from the
same start with a pin that cannot move sideways.
"""

import shutil
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
from sample import FILM, RUN

import erlif

film = erlif.open_film(FILM)
frames = erlif.open_film(FILM, group="frames").load()
start = float(film.film_predicted_min.attrs["start_film"])

# a run directory with another assumption in run.toml
with tempfile.TemporaryDirectory() as scratch:
    other = Path(scratch) / "guided"
    shutil.copytree(RUN, other, ignore=shutil.ignore_patterns("*.nc"))
    settings = (other / "run.toml").read_text()
    guided = f'sideways = "guided"\nstart_film = "{start:.4f} um"'
    (other / "run.toml").write_text(settings.replace('sideways = "free"', guided))
    lifted = erlif.predict(other)

fig, (compared, assumed) = plt.subplots(2, figsize=(6, 7), layout="constrained")
erlif.plots.film_over_run(film, frames, ax=compared)
assumed.plot(frames.elapsed_cycles, frames.film_predicted_min, label="pin free sideways")
assumed.plot(frames.elapsed_cycles, lifted.film_predicted_min, label="pin guided")
assumed.set(xlabel="turns of the crank [1]", ylabel="minimum film thickness [µm]")
assumed.legend()
plt.show()

# %%
# The free pin sinks by some hundredths of its film in a turn; a guided one is lifted. Neither film
# follows the speed:

speed = film.rocker_speed.values
for name in ("film_min", "film_predicted_min", "film_theory"):
    values = film[name].values
    print(f"{name}: {erlif.trend.correlate(values, 0 * values, speed).rank:+.2f}")
