"""Four regimes of the film of a contact: the one that governs, and the limits of the choice.

The bodies stay rigid or are elastic, and the oil keeps its viscosity or thickens by the law of
Barus. Johnson (1970); Hamrock and Dowson (1979).
"""

from dataclasses import dataclass

import numpy as np

from erlif.models.arguments import Values, require_not_negative, require_single
from erlif.models.contact.roots import like

# The four asymptotes of a contact, in the order of `ContactFilm`.
FILM_REGIMES = (
    "isoviscous-rigid",
    "piezoviscous-rigid",
    "isoviscous-elastic",
    "piezoviscous-elastic",
)

# Pressure above which the law of Barus makes mineral oils too stiff. [Pa]
BARUS_LIMIT = 0.5e9

# Share of the largest asymptote from which a second one lies at a border of the regime map.
BORDER = 0.9


@dataclass(frozen=True)
class ContactFilm:
    """Film of a line or elliptical contact, the four regimes it comes from, and its limits.

    All film thicknesses are in m; gV and gE are dimensionless.

    Attributes
    ----------
    film : Values
        Minimum film thickness. [m]
    central : Values
        Film thickness at the centre of the contact. [m]
    error : Values
        Relative standard deviation of the minimum, that of the formula alone. [1]
    regime : Values
        Name of the regime with the largest film, from `FILM_REGIMES`; empty where the film is NaN.
    isoviscous_rigid, piezoviscous_rigid : Values
        Minimum film thickness of rigid bodies in oil of constant viscosity, and of Barus. [m]
    isoviscous_elastic, piezoviscous_elastic : Values
        Minimum film thickness of elastic bodies in the same two oils. [m]
    gV : Values
        Viscosity parameter. [1]
    gE : Values
        Elasticity parameter. [1]
    notes : tuple[str, ...]
        Limits of the formulas, to be stated beside the film thickness.
    """

    film: Values
    central: Values
    error: Values
    regime: Values
    isoviscous_rigid: Values
    piezoviscous_rigid: Values
    isoviscous_elastic: Values
    piezoviscous_elastic: Values
    gV: Values  # noqa: N815
    gE: Values  # noqa: N815
    notes: tuple[str, ...]


def largest(asymptotes: tuple[Values, ...]) -> Values:
    """The largest of four films, written for DataArrays as well. [m]"""
    rigid, viscous, elastic, both = asymptotes
    return np.maximum(np.maximum(rigid, viscous), np.maximum(elastic, both))


def govern(
    asymptotes: tuple[Values, ...], formula_name: str, pressure: Values, errors: tuple[float, ...]
) -> tuple[Values, Values, tuple[str, ...]]:
    """Name of the largest of the four asymptotes and its error of four, and notes on the choice.

    The name is empty and the error NaN where the film is NaN. `pressure` is that of the dry
    contact. [Pa] Ties, and the zero film of a standstill, belong to the first asymptote. Written
    with products because these broadcast over DataArrays as over floats.
    """
    rigid, viscous, elastic, both = asymptotes
    film = largest(asymptotes)
    governing = (film != rigid) * (
        1 + (film != viscous) * (1 + (film != elastic) * (1 + (film != both) * 1))
    )

    notes: tuple[str, ...] = (
        "The film formulas assume steady motion, one temperature, smooth surfaces and a flooded "
        "inlet.",
    )
    if np.any(np.less(governing, 3)):
        notes += (
            f"{formula_name} (piezoviscous-elastic) does not hold where another regime governs.",
        )
    # near a border two effects act together and neither asymptote holds alone
    close = sum((asymptote > BORDER * film) * 1 for asymptote in asymptotes)
    if np.any(np.greater(close, 1)):
        notes += (
            f"Two or more asymptotes lie within {100 * (1 - BORDER):.0f} %: the contact lies near "
            "a border of the regime map.",
        )
    if np.any(np.greater(pressure, BARUS_LIMIT)):
        notes += ("The Hertz pressure exceeds 0.5 GPa, above which the law of Barus is too stiff.",)
    place = np.asarray(governing)
    regime = like(governing, np.asarray([*FILM_REGIMES, ""])[place])
    return regime, like(governing, np.asarray([*errors, np.nan])[place]), notes


def note_motion(
    entrainment_speed: Values, half_width: Values, stroke: float | None
) -> tuple[str, ...]:
    if stroke is not None and not np.all(np.isposinf(stroke)):
        require_single(stroke=stroke)
        require_not_negative(stroke=stroke)

    notes = []
    # speeds of both signs, or a standstill
    if np.any(np.less_equal(entrainment_speed, 0)) and np.any(
        np.greater_equal(entrainment_speed, 0)
    ):
        notes.append(
            "Entrainment reverses: the steady formulas give zero film there, while a real film is "
            "maintained by squeeze and depends on the acceleration."
        )

    # the half width first, since a film that misses the centre does not cross either
    if stroke is None:
        notes.append("No stroke given: whether the motion sweeps the contact was not checked.")
    elif np.any(np.greater(half_width, stroke)):
        widest = float(np.nanmax(np.asarray(half_width)))
        notes.append(
            f"The stroke of {stroke * 1e3:.3g} mm is less than the contact half width of "
            f"{widest * 1e3:.3g} mm: oil entrained at the inlet never reaches the centre."
        )
    elif np.any(np.greater(2 * half_width, stroke)):
        widest = float(np.nanmax(np.asarray(2 * half_width)))
        notes.append(
            f"The stroke of {stroke * 1e3:.3g} mm is less than the contact width of "
            f"{widest * 1e3:.3g} mm: oil entrained at the inlet never crosses the contact."
        )
    return tuple(notes)
