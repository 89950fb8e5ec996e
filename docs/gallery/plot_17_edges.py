"""
Edges of a bushing
==================

A straight bushing presses hardest at its ends, where its sharp edge meets the bent pin. An undercut
of its faces makes a lip that follows the pin (Farzaneh 2002, chapter 3). The joint of the thesis
under 100,000 lbf on the ends of its pin; Hertz's line contact has neither ends nor bending.
"""

from dataclasses import replace

import matplotlib.pyplot as plt

import erlif
from erlif.models import Joint, Undercut, contact, prepare_joint, solve_joint

joint = Joint(0.03336, 0.03359, 0.0533, length=0.2373, pin_length=0.3508)
load = 444.8e3
cells = {"smallest_cell": 1e-3, "largest_cell": 5e-3}
straight = prepare_joint(joint, **cells)
cut = replace(joint, undercut=Undercut(depth=0.020, width=0.008, lip=0.0093))
undercut = prepare_joint(cut, pin=straight.pin, **cells)
found = {
    "straight": solve_joint(straight, load=load),
    "undercut": solve_joint(undercut, load=load),
}
radius = contact.conformal_radius(joint.pin_radius, bushing_radius=joint.bushing_radius)
hertz = contact.hertz_line(load / joint.length, radius=radius, contact_modulus=109.9e9)

fig, (profile, pressure) = plt.subplots(2, figsize=(6, 6.5), layout="constrained")
erlif.plots.axial_pressure(found, hertz=hertz.pressure, ax=profile)
erlif.plots.contact_pressure_map(found["undercut"], ax=pressure)
plt.show()

# %%
# At the sharp edge the pressure is infinite in theory: that of a cell grows as the cells shrink,
# a mean over a length does not.

for name, one in found.items():
    print(f"{name}: {float(one.patch_pressure) / 1e6:.0f} MPa over 4 mm")
