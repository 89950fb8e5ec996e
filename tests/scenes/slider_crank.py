"""The slider-crank of Mukras et al. (2008), Tables 1 to 3; they do not state the preload."""

import numpy as np

from erlif.joint.models.reaction import SliderCrankBodies
from erlif.joint.models.slider_dynamics import ContactLaw
from erlif.models.mechanism import SliderCrank

MASSES = {"rod_mass": 0.8175, "rod_inertia": 5500e-6, "slider_mass": 5.5487}
SPRUNG = MASSES | {"spring_stiffness": 525.4}
BODIES = SPRUNG | {"spring_preload": 68.354}
RUBBED = SliderCrankBodies(**BODIES, friction=0.15, pin_radius=9.525e-3)
CRANK_INERTIA = 204e-6 + 0.4045 * 0.0381**2  # Table 1
PTFE = ContactLaw(stiffness=6.523e8)  # eqs. 12 and 13 with the moduli of Table 2 in GPa


def linkage(clearance=0.0):
    return SliderCrank(crank=0.0762, coupler=0.2032, clearance=clearance)


def slowed(_time, angle):
    """Torque on the crank."""
    return 2.0 + np.sin(angle)
