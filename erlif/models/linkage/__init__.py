"""Design of a crank-rocker: links for a wanted motion, what the motion costs, what the links bear.

After Farzaneh (2002), appendix A. Lengths are distances of joint centres in m, angles in rad,
counted as in `erlif.models.mechanism.CrankRocker`.
"""

from erlif.models.linkage.design import LinkageDesign, measure_linkage
from erlif.models.linkage.measures import grashof_class
from erlif.models.linkage.synthesis import Synthesis, synthesise_crank_rocker

__all__ = [
    "LinkageDesign",
    "Synthesis",
    "grashof_class",
    "measure_linkage",
    "synthesise_crank_rocker",
]
