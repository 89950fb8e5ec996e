"""Film thickness predicted by lubrication theory for each trigger."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import ConfigError
from erlif.core.products import require
from erlif.core.variables import FILM
from erlif.models.contact import conformal_radius, contact_modulus
from erlif.models.film import (
    DOWSON_HIGGINSON_ERROR,
    FILM_REGIMES,
    HAMROCK_DOWSON_ELLIPTICAL,
    HAMROCK_DOWSON_LINE,
    ContactFilm,
    elliptical_contact_film,
    film_parameter,
    line_contact_film,
)
from erlif.models.oil import vogel_viscosity

_ZERO_CELSIUS = 273.15


# Name, formula and source of film_hamrock_dowson.
_LINE = {
    "long_name": HAMROCK_DOWSON_LINE,
    "formula": "h/R = 2.65 G^0.54 U^0.7 W^-0.13",
    "source": "Dowson and Higginson (1966), often quoted as Hamrock-Dowson",
}
_ELLIPTICAL = {
    "long_name": HAMROCK_DOWSON_ELLIPTICAL,
    "formula": "h/Rx = 3.63 U^0.68 G^0.49 W^-0.073 (1 - exp(-0.68 k))",
    "source": "Hamrock and Dowson (1977)",
}
# Error of the central film of soft ellipses beyond that of the minimum (docs/theory/film.md). [1]
_SOFT_CENTRE = 0.1

_ERROR_SOURCE = (
    "relative standard deviation against solutions of Reynolds' equation and the elastic "
    "half-space, docs/theory/film.md; infinite outside the regime of the formula"
)


@dataclass(frozen=True)
class Solid:
    """One side of the joint.

    Attributes
    ----------
    youngs_modulus : float
        Young's modulus. [Pa]
    poissons_ratio : float
        Poisson's ratio. [1]
    roughness : float | None
        rms roughness; None where it is not known. [m]
    """

    youngs_modulus: float
    poissons_ratio: float
    roughness: float | None = None


@dataclass(frozen=True)
class VogelLaw:
    """Viscosity a exp(b / (T - c)).

    Attributes
    ----------
    a : float
        [Pa s]
    b : float
        [K]
    c : float
        [degC]
    """

    a: float
    b: float
    c: float


@dataclass(frozen=True)
class LubricatedContact:
    """Two bodies that touch along a line, or in a point or ellipse, and their oil.

    Attributes
    ----------
    radius : float
        Reduced radius along the motion. [m]
    radius_across : float or None
        Reduced radius across it; None for a line contact. [m]
    length : float or None
        Loaded length of a line contact; None for another. [m]
    body, counterbody : Solid
    viscosity : float or VogelLaw
        Dynamic viscosity [Pa s], or its law with temperature.
    pressure_viscosity : float
        Barus coefficient. [1/Pa]
    stroke : float
        Travel of the entrained oil in half a cycle. [m]
    entrainment : float
        Mean of both surface speeds over that of the faster one: half where one rests. [1]
    """

    radius: float
    radius_across: float | None
    length: float | None
    body: Solid
    counterbody: Solid
    viscosity: float | VogelLaw
    pressure_viscosity: float
    stroke: float = math.inf
    entrainment: float = 0.5

    @property
    def sliding(self) -> float:
        """Difference of both surface speeds over the faster one: 1 where one rests. [1]"""
        return 2 * (1 - self.entrainment)

    def films(self, speed: Array, load: Array, viscosity: Array) -> ContactFilm:
        """Films at surface speeds [m/s], loads [N] and viscosities [Pa s] of one shape."""
        shared: dict[str, Any] = {
            "viscosity": viscosity,
            "pressure_viscosity": self.pressure_viscosity,
            "contact_modulus": contact_modulus(
                self.body.youngs_modulus,
                poisson_1=self.body.poissons_ratio,
                youngs_2=self.counterbody.youngs_modulus,
                poisson_2=self.counterbody.poissons_ratio,
            ),
            "stroke": self.stroke,
        }
        mean = speed * self.entrainment
        if self.length is not None:
            line = load / self.length
            return line_contact_film(mean, load_per_length=line, radius=self.radius, **shared)
        radii = {"radius_along": self.radius, "radius_across": self.radius_across}
        return elliptical_contact_film(mean, load=load, **radii, **shared)


@dataclass(frozen=True)
class LubricatedJoint:
    """The loaded joint and its oil.

    Attributes
    ----------
    pin_radius : float
        Radius of the pin. [m]
    bushing_radius : float
        Radius of the bore. [m]
    length : float
        Loaded length along the axis. [m]
    pin : Solid
        Material of the pin.
    bushing : Solid
        Material of the bushing.
    viscosity : float | VogelLaw
        Dynamic viscosity [Pa s], or its law with temperature.
    pressure_viscosity : float
        Barus coefficient. [1/Pa]
    stroke : float
        Travel of the entrained oil in half a cycle. [m]
    """

    pin_radius: float
    bushing_radius: float
    length: float
    pin: Solid
    bushing: Solid
    viscosity: float | VogelLaw
    pressure_viscosity: float
    stroke: float = math.inf

    @property
    def radius(self) -> float:
        """Conformal radius of pin and bushing. [m]"""
        return float(conformal_radius(self.pin_radius, bushing_radius=self.bushing_radius))

    @property
    def contact(self) -> LubricatedContact:
        """The line contact of pin and bushing."""
        oil = self.viscosity, self.pressure_viscosity
        bodies = self.pin, self.bushing
        return LubricatedContact(self.radius, None, self.length, *bodies, *oil, self.stroke)


def predict_film(triggers: xr.Dataset, contact: LubricatedContact | LubricatedJoint) -> xr.Dataset:
    """Film thickness expected at the speed and load of each trigger.

    Parameters
    ----------
    triggers : xarray.Dataset
        sliding_speed [m s-1] and load [N]; temperature [degree_Celsius] where the viscosity follows
        Vogel's law; film_min [um] for the film parameter; dim trigger.
    contact : LubricatedContact or LubricatedJoint

    Returns
    -------
    xarray.Dataset
        film_hamrock_dowson, the piezoviscous-elastic minimum film [um], its formula and source as
        attributes; film_theory and film_theory_central, the minimum and central film over all
        regimes [um], with regime and limits as attributes; film_regime; film_parameter [1] where
        roughness and film_min are given. The films have formula_error [1], the relative standard
        deviation of the formula in the regime of most triggers, and its source.

    Raises
    ------
    ConfigError
        If Vogel's law has no temperature.
    ErlifError
        If speed or load is missing.

    Examples
    --------
    >>> acrylic = Solid(2.7e9, 0.37)
    >>> joint = LubricatedJoint(33.36e-3, 33.59e-3, 0.237, acrylic, acrylic, 0.12, 12.4e-9)
    >>> speed, load = ("trigger", [0.0842]), ("trigger", [222.4])
    >>> at = xr.Dataset({"sliding_speed": speed, "joint_load": load})
    >>> predict_film(at, joint).film_theory.attrs["regime"]
    'isoviscous-rigid'
    """
    require(triggers, "sliding_speed", "joint_load")
    if isinstance(contact, LubricatedJoint):
        contact = contact.contact
    viscosity = viscosity_at(triggers, contact.viscosity)
    speed = triggers.sliding_speed.values
    theory = contact.films(speed, triggers["joint_load"].values, viscosity)
    known: Any = theory.error
    if contact.length is not None:
        shape, formula, known = "line", _LINE, DOWSON_HIGGINSON_ERROR
        choice = (
            "curve of Moes through the four regimes of a line contact (Venner and Lubrecht 2000), "
            "within 8 %; the largest asymptote names the regime"
        )
    else:
        shape, formula = "elliptical", _ELLIPTICAL
        choice = "the largest film of the four regimes of an ellipse (Hamrock and Dowson 1979)"

    # film_theory is named after the regime of most triggers
    regime = np.broadcast_to(np.asarray(theory.regime, dtype=str), speed.shape)
    regimes, count = np.unique(regime, return_counts=True)
    chosen = str(regimes[np.argmax(count)])
    gV, gE = float(np.median(theory.gV)), float(np.median(theory.gE))
    film_theory = FILM["film_theory"].fill(
        1e6 * np.asarray(theory.film),
        long_name=f"steady {shape}-contact film, {chosen} regime",
        regime=chosen,
        reason=f"{choice}; gV = {gV:.3g}, gE = {gE:.3g} (medians)",
        notes="\n".join(theory.notes),
    )
    hard = 1e6 * np.asarray(theory.piezoviscous_elastic)
    film_formula = FILM["film_hamrock_dowson"].fill(hard, **formula)
    film_central = FILM["film_theory_central"].fill(1e6 * np.asarray(theory.central))

    # the formula holds in its regime alone; the centre of soft ellipses is known less well
    _, _, soft, holds = (regime == one for one in FILM_REGIMES)
    own = np.where(holds, known, np.inf)
    of_centre = np.hypot(theory.error, _SOFT_CENTRE * (soft & (contact.length is None)))
    errors = ((film_formula, own), (film_theory, theory.error), (film_central, of_centre))
    for one, error in errors:
        finite = np.asarray(error)[~np.isnan(error)]
        one.attrs["formula_error"] = float(np.median(finite)) if finite.size else np.nan
        one.attrs["formula_error_source"] = _ERROR_SOURCE
    predicted = xr.Dataset(
        {
            "film_hamrock_dowson": film_formula,
            "film_theory": film_theory,
            "film_theory_central": film_central,
            "film_regime": FILM["film_regime"].fill(regime),
        }
    )

    if "film_min" in triggers:
        sides = contact.body.roughness, contact.counterbody.roughness
        predicted = predicted.assign(compare_with_roughness(triggers.film_min, *sides))
    return predicted


def compare_with_roughness(
    film_min: xr.DataArray, one: float | None, other: float | None
) -> xr.Dataset:
    """Minimum film thickness over the combined roughness of both surfaces.

    Parameters
    ----------
    film_min : xarray.DataArray
        Minimum film thickness, dim trigger. [um]
    one, other : float or None
        rms roughness of the two surfaces; None where it is not known. [m]

    Returns
    -------
    xarray.Dataset
        film_parameter (trigger), Lambda [1]; empty unless both are known.

    Examples
    --------
    0.3 and 0.4 um combine to 0.5 um:

    >>> film_min = xr.DataArray([1.0], dims="trigger")
    >>> compare_with_roughness(film_min, 0.3e-6, 0.4e-6).film_parameter.values.round(6)
    array([2.])
    """
    if one is None or other is None:
        return xr.Dataset()
    film = np.maximum(film_min.values, 0.0) * 1e-6
    ratio = film_parameter(film, roughness_a=one, roughness_b=other)
    return xr.Dataset({"film_parameter": FILM["film_parameter"].fill(np.asarray(ratio))})


def viscosity_at(conditions: xr.Dataset, viscosity: float | VogelLaw) -> Array:
    """Dynamic viscosity of each trigger or frame.

    Parameters
    ----------
    conditions : xarray.Dataset
        With one dim; temperature [degree_Celsius] on it where the viscosity follows Vogel's law.
    viscosity : float or VogelLaw
        [Pa s]

    Returns
    -------
    array
        On the dim of `conditions`. [Pa s]

    Raises
    ------
    ConfigError
        If Vogel's law has no temperature.

    Examples
    --------
    >>> viscosity_at(xr.Dataset({"joint_load": ("trigger", [220.0, 230.0])}), 0.12)
    array([0.12, 0.12])
    """
    if not isinstance(viscosity, VogelLaw):
        return np.full(next(iter(conditions.sizes.values())), viscosity)
    if "temperature" not in conditions:
        raise ConfigError(
            "Expected a column temperature_C in the encoder log, because [oil] gives the viscosity "
            'by Vogel\'s law; there is none. Log the temperature, or give viscosity = "0.12 Pa s".'
        )
    kelvin = conditions.temperature.values + _ZERO_CELSIUS
    return np.asarray(
        vogel_viscosity(kelvin, a=viscosity.a, b=viscosity.b, c=viscosity.c + _ZERO_CELSIUS)
    )
