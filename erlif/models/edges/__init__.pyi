from .ends import (
    edge_exponent,
    lundberg_profile,
)
from .half_space import solve_contact, subsurface_stress
from .joint import (
    Joint,
    Undercut,
    prepare_joint,
    search_undercut,
    section_stress,
    solve_joint,
)

__all__ = [
    "Joint",
    "Undercut",
    "edge_exponent",
    "lundberg_profile",
    "prepare_joint",
    "search_undercut",
    "section_stress",
    "solve_contact",
    "solve_joint",
    "subsurface_stress",
]
