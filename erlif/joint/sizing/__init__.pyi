from .assessment import Assessment, assess_joint
from .design import BearingDesign
from .heat import FRICTION
from .joint import DIMENSIONS, Dimensions, Joint, Lock, dimensions_of
from .materials import Material, read_materials
from .practice import round_up
from .sensitivity import Sensitivity, Substitute, sensitivities, substitutes
from .size import size_joint
from .state import JointState
from .steps import ROUNDING, Step

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
