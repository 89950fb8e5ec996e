"""Design of a crank-rocker: links for a wanted motion, what the motion costs, what the links bear.

After Farzaneh (2002), appendix A. Lengths are distances of joint centres in m, angles in rad,
counted as in `erlif.models.mechanism.CrankRocker`.
"""

from erlif.models.linkage.design import LinkageDesign, measure_linkage
from erlif.models.linkage.measures import grashof_class
from erlif.models.linkage.motor import DrivePower, choose_motor, drive_power
from erlif.models.linkage.strength import (
    beam_bending_stress,
    fatigue_safety,
    hole_stress,
    open_hole_concentration,
    pin_hole_concentration,
    thread_stress_area,
)
from erlif.models.linkage.synthesis import Synthesis, synthesise_crank_rocker
from erlif.models.linkage.tolerance import Sensitivity, link_sensitivity

__all__ = [
    "DrivePower",
    "LinkageDesign",
    "Sensitivity",
    "Synthesis",
    "beam_bending_stress",
    "choose_motor",
    "drive_power",
    "fatigue_safety",
    "grashof_class",
    "hole_stress",
    "link_sensitivity",
    "measure_linkage",
    "open_hole_concentration",
    "pin_hole_concentration",
    "synthesise_crank_rocker",
    "thread_stress_area",
]
