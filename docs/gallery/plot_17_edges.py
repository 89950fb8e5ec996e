"""
Edges, lobes and undercuts of a bushing
=======================================

A straight bushing presses hardest at its ends, where its sharp edge meets the bent pin. Lobes move
the pressure inward, and an undercut of its faces makes a lip that follows the pin. Farzaneh (2002),
chapter 3, has 2340, 756 and 543 MPa for the three, from finite elements of 4 mm. The thesis at hand
lacks its figures 3-4 to 3-10; the points are those of its text.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

import erlif
from erlif.joint.models import EdgeJoint, Undercut, prepare_joint, solve_joint
from erlif.models import contact

joint = EdgeJoint(0.03336, 0.03359, 0.0533, length=0.2373, pin_length=0.3508)
pound, steel = 4.4482, 109.9e9
mesh = {"growth": 1.6, "largest_cell": 8e-3, "harmonics": [0, 1, 2, 5, 14, 40, 110]}
fine = {"smallest_cell": 0.1e-3, **mesh}

# undercuts under 100,000 lbf on the ends of the pin; D2 is 8 mm
straight = prepare_joint(joint, **fine)
found = {}
for depth, lip in [(5, 9.3), (10, 9.3), (20, 9.3), (30, 9.3), (20, 5), (20, 7), (20, 11)]:
    cut = replace(joint, undercut=Undercut(depth * 1e-3, 8e-3, lip * 1e-3))
    body = prepare_joint(cut, pin=straight.pin, **fine)
    found[depth, lip] = solve_joint(body, load=100e3 * pound, patch=0.5e-3, around=256)
found[0, 9.3] = solve_joint(straight, load=100e3 * pound, patch=0.5e-3, around=256)

# lobes of 200 mm radius at 60 mm from the middle, their crest at the 33.59 mm of appendix B
crest = replace(joint, bushing_radius=joint.bushing_radius + 0.2375e-3)
near = {"smallest_cell": 0.4e-3, "refine": [0.06], "load_span": (0.0, 0.1754)}
near = mesh | near | {"largest_cell": 20e-3}
shape = {"lobes": [0.06], "lobe_height": 0.2375e-3, "around": 256}
lobed = prepare_joint(crest, **near)
loads = np.array([5e3, 10e3, 20e3, 30e3, 40e3])
pressed = [solve_joint(lobed, load=load * pound, **shape) for load in loads]
radius = contact.conformal_radius(joint.pin_radius, bushing_radius=joint.bushing_radius)
hertz = contact.hertz_ellipse(
    loads * pound / 2, radius=radius, radius_across=0.2, contact_modulus=steel
)

fig, ((profile, lobe), (deep, thick)) = plt.subplots(2, 2, figsize=(8.5, 7), layout="constrained")
line = contact.hertz_line(100e3 * pound / joint.length, radius=radius, contact_modulus=steel)
ends = {"straight": found[0, 9.3], "undercut": found[20, 9.3]}
erlif.joint.plots.axial_pressure(ends, hertz=line.pressure, ax=profile)

lobe.plot(loads, hertz.pressure / 1e6, "--", label="Hertz")
lobe.plot(loads, [one.peak_pressure / 1e6 for one in pressed], label="cell of 0.4 mm")
lobe.plot(loads, [one.patch_pressure / 1e6 for one in pressed], label="mean over 4 mm")
lobe.plot(10e3, 756, "ko", mfc="none", label="thesis, if 10,000 lbf in total")
lobe.plot(40e3, 756, "ko", label="thesis, if on a quarter model")
lobe.set(xlabel="load on the pin [lbf]", ylabel="pressure on the lobe [MPa]", ylim=(0, None))
lobe.legend()

depths, lips = [0, 5, 10, 20, 30], [5, 7, 9.3, 11]
for ax, values, chosen, text in (
    (deep, depths, [(depth, 9.3) for depth in depths], "depth D1 [mm], D3 = 9.3 mm"),
    (thick, lips, [(20, lip) for lip in lips], "lip D3 [mm], D1 = 20 mm"),
):
    for name, label in (("peak", "cell of 0.1 mm"), ("patch", "mean over 0.5 mm")):
        pressures = [float(found[cut][f"{name}_pressure"]) / 1e6 for cut in chosen]
        ax.plot(values, pressures, "o-", markersize=3, label=label)
    ax.set(xlabel=text, ylabel="largest pressure [MPa]", ylim=(0, None))
deep.plot([0, 20], [2340, 543], "ko", label="thesis")
thick.plot(9.3, 543, "ko", label="thesis")
deep.legend()
plt.show()

# %%
# The pressure on a lobe is that of the thesis if the 10,000 lbf act on the quarter of the joint
# that its mesh covers, 40,000 lbf on the pin. At the sharp edge the pressure is infinite in theory:
# that of a cell grows as the cells shrink, a mean over a length does not.

print(f"lobe, 40,000 lbf: {float(pressed[-1].patch_pressure) / 1e6:.0f} MPa over 4 mm")
for name, one in ends.items():
    print(f"{name}: {float(one.patch_pressure) / 1e6:.0f} MPa over 0.5 mm")

# %%
# Section 3.1 scales the joint to acrylic: 1/75 of moduli and load are 1/75 of the pressure.

soft = replace(crest, youngs_modulus=200e9 / 75, pin_youngs_modulus=200e9 / 75)
model = solve_joint(prepare_joint(soft, **near), load=loads[-1] * pound / 75, **shape)
print(f"steel over acrylic: {float(pressed[-1].peak_pressure / model.peak_pressure):.4f}")
