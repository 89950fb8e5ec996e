"""
The torque of a bushing
=======================

Torque over load and shaft radius is not the friction coefficient: friction acts along the whole arc
of contact, and only the pressure along the line of load carries. A tight or worn bushing takes up
to 4/pi of the torque of a loose one, an interference more (Colbert et al. 2009, figures B1 and 8).
"""

import matplotlib.pyplot as plt
import numpy as np

from erlif.joint.models.friction import STEADY_WEAR_TORQUE_RATIO
from erlif.joint.models.running_in import run_in_bushing
from erlif.models.contact import winkler_contact, winkler_load

# %%
# The chart: torque ratio over clearance and load. Half angles and clearances span it, and each pair
# has one load and one ratio.

fit = np.geomspace(10, 1e4, 60)  # shaft radius over clearance
half_angle = np.radians(np.linspace(3, 90, 60))[:, None]
case = {"shaft_radius": 1.0, "bushing_radius": 1 + 1 / fit, "thickness": 0.1, "modulus": 1e9}
load = winkler_load(half_angle, **case)
ratio = winkler_contact(load * (1 - 1e-12), **case).torque_ratio
group = load * 0.1 / (1e9 * case["bushing_radius"] ** 2)

fig, chart = plt.subplots(figsize=(5, 3.8), layout="constrained")
lines = chart.contour(
    np.broadcast_to(fit, ratio.shape), group, ratio, np.arange(1.02, 1.28, 0.04), cmap="cividis"
)
fig.colorbar(lines, ax=chart, label="torque ratio", format="%.2f")
chart.set(
    xscale="log",
    yscale="log",
    ylim=(1e-6, 1),
    xlabel="shaft radius over clearance",
    ylabel="load group $F t / (E' R_b^2 w)$",
)
plt.show()

# %%
# Running-in: a PTFE bushing of 10 mm with a clearance, and one with an interference, both in
# diameter, as their walls wear. The interference is the one that takes 1.6 times the torque of a
# loose bushing here.

fig, running = plt.subplots(figsize=(5, 3.8), layout="constrained")
distance = np.concatenate([[0.0], np.geomspace(0.01, 150, 60)])
for play, label in ((350e-6, "clearance 350 µm"), (-22e-6, "interference 22 µm")):
    found = run_in_bushing(
        400.0,
        shaft_radius=5e-3,
        bushing_radius=5e-3 + play / 2,
        width=10e-3,
        thickness=3e-3,
        modulus=5e8,
        specific_wear=5e-13,
        sliding_distance=distance,
        cells=360,
    )
    found.torque_ratio.plot(ax=running, label=label)
running.axhline(STEADY_WEAR_TORQUE_RATIO, color="0.4", linestyle="--", label="4/π")
running.set(xlabel="sliding distance [m]", ylabel="torque ratio", ylim=(1, 1.7))
running.legend()

plt.show()
