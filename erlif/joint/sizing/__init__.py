"""A pin joint as the guide designs it: Strand (2005), chapter 2, from load and motion to sizes."""

from erlif.joint.sizing.assessment import Assessment, assess_joint
from erlif.joint.sizing.heat import FRICTION
from erlif.joint.sizing.joint import DIMENSIONS, Dimensions, Joint, Lock, dimensions_of
from erlif.joint.sizing.materials import Material, read_materials
from erlif.joint.sizing.outcome import BearingDesign
from erlif.joint.sizing.practice import round_up
from erlif.joint.sizing.sensitivity import Sensitivity, Substitute, sensitivities, substitutes
from erlif.joint.sizing.size import size_joint
from erlif.joint.sizing.state import JointState
from erlif.joint.sizing.steps import ROUNDING, Step

__all__ = [
    "DIMENSIONS",
    "FRICTION",
    "ROUNDING",
    "Assessment",
    "BearingDesign",
    "Dimensions",
    "Joint",
    "JointState",
    "Lock",
    "Material",
    "Sensitivity",
    "Step",
    "Substitute",
    "assess_joint",
    "dimensions_of",
    "read_materials",
    "round_up",
    "sensitivities",
    "size_joint",
    "substitutes",
]
