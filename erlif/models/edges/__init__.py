"""Pressure at the edges and lobes of a bearing, bodies elastic, without friction."""

from erlif.models.edges.ends import edge_exponent, lundberg_profile
from erlif.models.edges.half_space import solve_contact
from erlif.models.edges.joint import (
    Joint,
    Undercut,
    prepare_joint,
    search_undercut,
    section_stress,
    solve_joint,
)
from erlif.models.edges.stress import subsurface_stress

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
