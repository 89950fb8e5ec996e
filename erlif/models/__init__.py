"""Theory of the joint: SI numbers in, SI numbers out.

Every formula takes floats, lists, numpy arrays or xarray DataArrays, broadcasts, and returns the
same kind: a float for floats. Angles are in radians, temperatures in kelvin. A value at which an
equation has no meaning (a negative modulus, an infinite load, a bushing smaller than its pin, an
angle outside the motion of the linkage) raises `erlif.core.errors.ModelError` with the name of the
argument; a value that is probably in another unit (a modulus in GPa) warns with
`erlif.core.errors.UnitWarning`. NaN stands for a missing value and is passed on.

The four sources are cited by author:

- Farzaneh (2002): Failure Analysis and Design of a Heavily Loaded Pin Joint, MSc thesis, MIT.
- Strand (2005): Design, Testing and Analysis of Journal Bearings for Construction Equipment,
  thesis, KTH Stockholm.
- Mukras et al. (2008): Modeling a Slider-Crank Mechanism With Joint Wear, SAE International.
- Colbert et al. (2009): Edges, clearances, and wear: little things that make big differences in
  bushing friction, Wear.

Where a source is misprinted, the function holds the corrected form and its note quotes the print;
docs/sources.md compares each published number with the one computed here.

>>> import erlif
>>> erlif.models.film.lubrication_regimes(1.52)
('partial',)
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__all__ = [
    "Groove",
    "Joint",
    "Journal",
    "Motion",
    "Mount",
    "Undercut",
    "arguments",
    "bearing",
    "clearance_fit",
    "contact",
    "crank_motion",
    "edge_exponent",
    "edges",
    "film",
    "fluorescence",
    "friction",
    "journal_coefficients",
    "linkage",
    "lobe_shape",
    "lundberg_profile",
    "mechanism",
    "oil",
    "oil_fit",
    "pin_shape",
    "prepare_joint",
    "reaction",
    "reynolds",
    "roller_shape",
    "running_in",
    "search_undercut",
    "section_stress",
    "slider",
    "slider_dynamics",
    "slider_wear",
    "solve_contact",
    "solve_film",
    "solve_joint",
    "solve_journal",
    "sources",
    "steady_journal",
    "subsurface_stress",
    "wear",
    "winkler_arc",
]

_REYNOLDS = frozenset(
    [
        "Groove",
        "Journal",
        "Motion",
        "Mount",
        "crank_motion",
        "journal_coefficients",
        "lobe_shape",
        "pin_shape",
        "roller_shape",
        "solve_film",
        "solve_journal",
        "steady_journal",
    ]
)
"""Names of `erlif.models.reynolds` that are names of the models too."""

_EDGES = frozenset(
    [
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
)
"""Names of `erlif.models.edges` that are names of the models too."""

if TYPE_CHECKING:
    from erlif.models import (
        arguments,
        bearing,
        clearance_fit,
        contact,
        edges,
        film,
        fluorescence,
        friction,
        linkage,
        mechanism,
        oil,
        oil_fit,
        reaction,
        reynolds,
        running_in,
        slider,
        slider_dynamics,
        slider_wear,
        sources,
        wear,
        winkler_arc,
    )
    from erlif.models.edges import (
        Joint,
        Undercut,
        edge_exponent,
        lundberg_profile,
        prepare_joint,
        search_undercut,
        section_stress,
        solve_contact,
        solve_joint,
        subsurface_stress,
    )
    from erlif.models.reynolds import (
        Groove,
        Journal,
        Motion,
        Mount,
        crank_motion,
        journal_coefficients,
        lobe_shape,
        pin_shape,
        roller_shape,
        solve_film,
        solve_journal,
        steady_journal,
    )


def __getattr__(name: str) -> Any:
    """Load a module when it is first used, so that ``import erlif`` stays quick."""
    if name in _REYNOLDS:
        return getattr(import_module("erlif.models.reynolds"), name)
    if name in _EDGES:
        return getattr(import_module("erlif.models.edges"), name)
    if name in __all__:
        return import_module(f"erlif.models.{name}")
    raise AttributeError(f"module 'erlif.models' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
