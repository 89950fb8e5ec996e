"""Pressure at the edges and lobes of a bearing, bodies elastic, without friction."""

from erlif.models.edges.ends import edge_exponent, lundberg_profile
from erlif.models.edges.half_space import solve_contact
from erlif.models.edges.stress import subsurface_stress

__all__ = ["edge_exponent", "lundberg_profile", "solve_contact", "subsurface_stress"]
