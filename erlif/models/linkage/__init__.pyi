from .design import (
    LinkageDesign,
    Sensitivity,
    link_sensitivity,
    measure_linkage,
)
from .measures import (
    grashof_class,
)
from .motor import (
    DrivePower,
    choose_motor,
    drive_power,
)
from .strength import (
    beam_bending_stress,
    fatigue_safety,
    hole_stress,
    open_hole_concentration,
    pin_hole_concentration,
    thread_stress_area,
)
from .synthesis import (
    Synthesis,
    synthesise_crank_rocker,
)

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
