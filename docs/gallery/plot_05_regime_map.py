"""
Regime map of the line contact
==============================

Four asymptotes describe the film of a steady line contact. The largest of them names the regime,
and a smooth curve through them gives the film. In the variables of Moes, the viscosity parameter
:math:`g_V` and the elasticity parameter :math:`g_E`, each regime is an area of the map. The points
are one acrylic and three steel joints of the same geometry at the same speed.
"""

import matplotlib.pyplot as plt
import numpy as np

from erlif.models.contact import conformal_radius, contact_modulus
from erlif.models.film import line_contact_film

radius = conformal_radius(0.03336, bushing_radius=0.03359)
acrylic = contact_modulus(2.7e9, poisson_1=0.37, youngs_2=2.7e9, poisson_2=0.37)
steel = contact_modulus(200e9, poisson_1=0.3, youngs_2=200e9, poisson_2=0.3)
LBF = 4.4482216152605  # N
LENGTH = 0.237  # m
SPEED = 0.0842 / 2  # mean of the two surface speeds [m/s]

joints = {
    "acrylic, 50 lbf": (acrylic, 50 * LBF),
    "acrylic, 1333 lbf": (acrylic, 1333 * LBF),
    "steel, 8 klbf": (steel, 8e3 * LBF),
    "steel, 100 klbf": (steel, 1e5 * LBF),
}

# %%
# In dimensionless form, with :math:`H = (h/R) U^{-1/2}`, each asymptote depends on the two
# parameters alone; the largest is found on a grid of them.

g_v, g_e = np.meshgrid(np.logspace(-3.5, 4.5, 400), np.logspace(-1.5, 2, 400))
asymptotes = np.stack(
    [
        4.895 / g_e,
        1.666 * g_v ** (2 / 3) / g_e,
        3.10 * g_e**-0.2,
        2.65 * g_v**0.54 * g_e**-0.94,
    ]
)
names = ["isoviscous-rigid", "piezoviscous-rigid", "isoviscous-elastic", "piezoviscous-elastic"]
governing = asymptotes.argmax(axis=0)

fig, ax = plt.subplots(figsize=(6.5, 5), layout="constrained")
colours = ["#dbe9f6", "#e6f5d0", "#fde0c5", "#ead1dc"]
ax.contourf(g_v, g_e, governing, levels=np.arange(5) - 0.5, colors=colours)
for k, name in enumerate(names):
    inside = governing == k
    place = 10 ** np.log10(g_v[inside]).mean(), 10 ** np.log10(g_e[inside]).mean()
    ax.annotate(name.replace("-", "-\n"), place, ha="center", fontsize=9, color="0.35")

for name, (modulus, load) in joints.items():
    found = line_contact_film(
        SPEED,
        load_per_length=load / LENGTH,
        viscosity=0.12,
        pressure_viscosity=20e-9,
        radius=radius,
        contact_modulus=modulus,
    )
    print(f"{name:18s} {found.regime:21s} {float(found.film) * 1e6:7.2f} um")
    ax.plot(found.gV, found.gE, "o", color="black", markersize=5)
    label = f"{name}\n{float(found.film) * 1e6:.3g} µm"
    ax.annotate(label, (found.gV, found.gE), (6, 4), textcoords="offset points", fontsize=8)
ax.set(xscale="log", yscale="log", xlabel="viscosity parameter $g_V$")
ax.set_ylabel("elasticity parameter $g_E$")
plt.show()

# %%
# The acrylic joint of the optical tests is isoviscous and rigid. The line-contact formula with
# the factor 2.65, which belongs to the piezoviscous-elastic regime, is low by a factor of 67
# there. All four asymptotes assume steady motion.
