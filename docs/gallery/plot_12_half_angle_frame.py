"""
A film that does not exist
==========================

The pin of an oscillating joint under a dead load sinks: no steady film carries it when it is free
to move sideways. Implicit time steps in the frame of the camera show a steady film nevertheless.
There the oil is entrained, and the numerical diffusion of each step leaves a part of the wedge that
the swing of the pin should cancel. In the frame that turns with half the bushing angle nothing is
entrained, the load swings instead, and fifty steps a cycle suffice.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp

from erlif.models import Journal, crank_motion, solve_journal
from erlif.models.mechanism import CrankRocker

RIG = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
SPEED = 114 * 2 * np.pi / 60  # rad/s
LOAD = 222.4  # N
CYCLES = 30

joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, long=True)


def film_of(steps, **options):
    """Cycles and minimum film thickness [um] with a number of steps a cycle."""
    motion = crank_motion(RIG, crank_speed=SPEED, load=LOAD, cycles=CYCLES, steps_per_cycle=steps)
    found = solve_journal(joint, motion, cells=(64, 1), compiled=False, **options)
    return found.time * SPEED / (2 * np.pi), found.film_min * 1e6


# %%
# The exact orbit of an infinitely long bearing without cavities is an ordinary differential
# equation (Booker 1965), here in the half-angle frame.

middle = np.mean(RIG.limits())
pull = LOAD / joint.squeeze_constant


def velocity(time, place):
    """Rate of the displacement over the clearance."""
    size = np.hypot(*place)
    along = np.asarray(place) / size if size else np.array([1.0, 0.0])
    across = np.array([-along[1], along[0]])
    turned = (RIG.rocker_angle(SPEED * time) - middle) / 2
    load = pull * np.array([np.cos(turned), -np.sin(turned)])
    root = np.sqrt(1 - size**2)
    return load @ along * root**3 * along + load @ across * (2 + size**2) * root / 2 * across


span = 0.0, CYCLES * 2 * np.pi / SPEED
orbit = solve_ivp(velocity, span, (0.0, 0.0), method="DOP853", rtol=1e-9, atol=1e-12)
exact = joint.clearance * (1 - np.hypot(*orbit.y)) * 1e6

# %%
# Steps in both frames beside it:

fig, ax = plt.subplots(figsize=(6.5, 4.2), layout="constrained")
for steps, colour in ((50, "#d55e00"), (100, "#e69f00")):
    cycle, film = film_of(steps, frame="laboratory")
    print(f"laboratory frame, {steps:3d} steps a cycle: {float(film[-1]):6.2f} um")
    ax.plot(cycle, film, color=colour, label=f"frame of the camera, {steps} steps a cycle")
cycle, film = film_of(50)
print(f"half-angle frame,  50 steps a cycle: {float(film[-1]):6.2f} um")
print(f"exact orbit:                         {exact[-1]:6.2f} um")
ax.plot(cycle, film, color="#0072b2", label="half-angle frame, 50 steps a cycle")
ax.plot(orbit.t * SPEED / (2 * np.pi), exact, "k:", label="exact orbit")
ax.set(xlabel="cycles since loading", ylabel="minimum film thickness [µm]", yscale="log")
ax.legend()
plt.show()
