"""The linkages that move the joint: encoder angle to position, speed, acceleration and back.

The crank-rocker is the rig of Farzaneh (2002), appendix A.2, the slider-crank that of Mukras et al.
(2008); the positions, their time derivatives and the inverse maps are exact.
"""

from erlif.models.mechanism.crank_rocker import ROOT_TOLERANCE, CrankRocker, crank_for_swing
from erlif.models.mechanism.reach import DEAD_POINT_TOLERANCE, TURN
from erlif.models.mechanism.slider_crank import SliderCrank

__all__ = [
    "DEAD_POINT_TOLERANCE",
    "ROOT_TOLERANCE",
    "TURN",
    "CrankRocker",
    "SliderCrank",
    "crank_for_swing",
]
