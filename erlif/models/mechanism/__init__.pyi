from .crank_rocker import ROOT_TOLERANCE, CrankRocker, crank_for_swing
from .reach import DEAD_POINT_TOLERANCE, TURN
from .slider_crank import SliderCrank

__all__ = [
    "DEAD_POINT_TOLERANCE",
    "ROOT_TOLERANCE",
    "TURN",
    "CrankRocker",
    "SliderCrank",
    "crank_for_swing",
]
