"""
Bearing design: which limit governs
===================================

``design_report`` compares a pin joint with every limit of Strand (2005). Here the diameter of the
pin varies; the largest utilisation decides, and above 1 the limit is broken.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

from erlif.models.bearing import JointDesign, design_report

joint = JointDesign(
    load=1e5,  # N
    pin_diameter=0.08,  # m
    bushing_width=0.1,
    seat_width=0.04,
    play=0.16e-3,
    housing_bore=0.09,
    housing_diameter=0.2,
    pin_yield=600e6,  # Pa
    bushing_yield=300e6,
    housing_yield=350e6,
    bushing_hardness=1.2e9,
    seat_hardness=1.2e9,
    youngs_modulus=206e9,
    safety=2.0,
    lateral_play=0.02,
)

diameters = np.linspace(0.025, 0.09, 60)
reports = [
    design_report(replace(joint, pin_diameter=d, play=2e-3 * d, housing_bore=d + 0.01))
    for d in diameters
]

fig, ax = plt.subplots(figsize=(6.5, 4.5), layout="constrained")
for name in [check.name for check in reports[-1].checks if not check.recommended]:
    used = [
        next(check.utilisation for check in report.checks if check.name == name)
        for report in reports
    ]
    ax.plot(1e3 * diameters, used, label=name)
ax.axhline(1, color="black", linewidth=0.8, linestyle="--")
ax.set(xlabel="pin diameter [mm]", ylabel="utilisation", yscale="log", ylim=(0.03, 4))
ax.legend(fontsize=8)
plt.show()

# %%
# The report of the joint as drawn:

print(design_report(joint).as_text())
