"""Linkages of the tests."""

from scenes.four_bar import draw_linkage, solver

__all__ = ["draw_linkage", "solver"]
