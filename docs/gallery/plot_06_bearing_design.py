"""
Bearing design: which limit governs
===================================

``assess_joint`` checks a pin joint step by step after Strand (2005). Here the diameter of the pin
varies. Each line is the part of a limit that is used, 1 over 1 plus its margin; above 1 the limit
is exceeded.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

from erlif.joint.sizing import Joint, assess_joint, read_materials

materials = read_materials()
joint = Joint(
    force=1e5,  # N
    safety=2.0,
    pin=materials["42CrMo4 QT"],
    bushing=materials["CuSn12Ni2"],
    seat=materials["S355"],
    housing=materials["S355"],
    bushing_width=0.1,  # m
    wall=0.005,
    seat_width=0.04,
    housing_diameter=0.2,
    lateral_play=0.02,
)

diameters = np.linspace(0.025, 0.09, 60)
assessments = [assess_joint(replace(joint, pin_diameter=d, play=2e-3 * d)) for d in diameters]

fig, ax = plt.subplots(figsize=(6.5, 4.5), layout="constrained")
for step in assessments[-1].limits[:-1]:  # the slope of the bent pin is far below
    used = [1 / (1 + assessment.step(step.key).margin) for assessment in assessments]
    ax.plot(1e3 * diameters, used, label=f"{step.title} ({step.equation})")
ax.axhline(1, color="black", linewidth=0.8, linestyle="--")
ax.set(xlabel="pin diameter [mm]", ylabel="part of the limit that is used", yscale="log")
ax.set(ylim=(0.03, 10))
ax.legend(fontsize=8)
plt.show()

# %%
# The thinnest pin that meets all limits is that of ``size_joint``; the least one of the figure is

print(f"{1e3 * next(d for d, one in zip(diameters, assessments, strict=True) if one.sound):.0f} mm")
