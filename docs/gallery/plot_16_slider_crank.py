"""
Slider-crank with a worn joint
==============================

The force in a joint with clearance at 25 rad/s, where the rod is in compression for half of a turn
(figure 6); the wear of the bushing at half a turn per second after the 21,400 and 32,000 cycles of
figures 14b and 13b, with a pin that moves in the worn bushing and with one that lengthens the rod;
and the error of the extrapolation against a run with a factor of 125, with its bound (Mukras et al.
2008; preload and width are fitted, as the source states neither).
"""

from dataclasses import replace
from functools import cache

import matplotlib.pyplot as plt
import numpy as np

import erlif
from erlif.joint.models.reaction import SliderCrankBodies
from erlif.joint.models.slider_dynamics import ContactLaw, simulate_slider_crank
from erlif.joint.models.slider_wear import WearingJoint, bound_extrapolation, wear_slider_crank
from erlif.models import contact
from erlif.models.mechanism import SliderCrank

linkage = SliderCrank(crank=0.0762, coupler=0.2032)
bodies = SliderCrankBodies(
    rod_mass=0.8175,
    rod_inertia=5500e-6,
    slider_mass=5.5487,
    spring_stiffness=525.4,
    pin_radius=9.525e-3,
)
pair = contact.contact_modulus(206.8e9, poisson_1=0.29, youngs_2=0.139e9, poisson_2=0.38)


def turn(clearance):
    law = None
    if clearance:
        stiffness = contact.impact_stiffness(
            9.525e-3, bushing_radius=9.525e-3 + clearance, contact_modulus=pair
        )
        law = ContactLaw(stiffness, restitution=0.8)
    joint = replace(linkage, clearance=clearance)
    motion = {"crank_speed": 25.0, "duration": 2 * np.pi / 25, "tolerance": 1e-7}
    return simulate_slider_crank(joint, bodies=bodies, contact=law, **motion)


forces = {"perfect": turn(0.0), "0.1 mm": turn(1e-4), "0.5 mm": turn(5e-4)}


@cache
def wear(extrapolation, law=None):
    wall = contact.winkler_modulus(0.139e9, poisson=0.38)
    return wear_slider_crank(
        replace(linkage, clearance=10e-6),
        crank_speed=np.pi,
        bodies=replace(bodies, spring_preload=46.317),
        joint=WearingJoint(8.551e-3, thickness=3e-3, modulus=wall, specific_wear=5.05e-13),
        cycles=32_000,
        extrapolation=extrapolation,
        steps_per_cycle=36,
        cells=180,
        contact=law,
    )


stiffness = contact.impact_stiffness(9.525e-3, bushing_radius=9.535e-3, contact_modulus=pair)
general = wear(21_400, ContactLaw(stiffness, restitution=0.8))
simplified = wear(21_400)
error = bound_extrapolation(4000, wear=wear)

fig, axes = plt.subplots(3, figsize=(5, 8.5), layout="constrained")
erlif.joint.plots.joint_force(forces, ax=axes[0])
erlif.joint.plots.joint_wear(general, ax=axes[1])
for k in (1, 2):
    depth = 1e3 * simplified.depth[k, ::6]
    axes[1].plot(np.degrees(depth.angle), depth, "k.", markersize=2, label="rod lengthened")
axes[1].legend(*[part[:3] for part in axes[1].get_legend_handles_labels()])
erlif.joint.plots.extrapolation_error(error, fine=wear(125).isel(cycle=-1), ax=axes[2])
plt.show()

# %%
# Worn mass of both joints and the error at the smallest factor:

for name, worn in (("pin that moves", general), ("rod lengthened", simplified)):
    test_2, test_1 = 2200e3 * worn.worn_volume.values[1:]
    print(f"{name}: {test_1:.4f} g and {test_2:.4f} g; tables 4 and 5: 0.2336 g and 0.1589 g")
print(f"bound: {100 * float(error.worn_volume_bound[-1] / error.worn_volume[-1]):.3f} %")
