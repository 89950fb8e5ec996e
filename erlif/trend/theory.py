"""Film thickness predicted by lubrication theory for each trigger."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import ConfigError
from erlif.core.products import require
from erlif.core.variables import FILM
from erlif.models.contact import conformal_radius, contact_modulus
from erlif.models.film import dowson_higginson_film, film_parameter, line_contact_film
from erlif.models.oil import vogel_viscosity

_ZERO_CELSIUS = 273.15


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


def predict_film(triggers: xr.Dataset, joint: LubricatedJoint) -> xr.Dataset:
    """Film thickness expected at the speed and load of each trigger.

    Parameters
    ----------
    triggers : xarray.Dataset
        sliding_speed [m s-1] and load [N]; temperature [degree_Celsius] where the viscosity follows
        Vogel's law; film_min [um] for the film parameter; dim trigger.
    joint : LubricatedJoint

    Returns
    -------
    xarray.Dataset
        film_hamrock_dowson, the 2.65 line-contact formula [um]; film_theory, the film of the
        governing regime [um], with regimes and limits as attributes; film_parameter [1] where
        roughness and film_min are given.

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
    contact = {
        "load_per_length": triggers["joint_load"].values / joint.length,
        "viscosity": viscosity_at(triggers, joint.viscosity),
        "pressure_viscosity": joint.pressure_viscosity,
        "radius": joint.radius,
        "contact_modulus": contact_modulus(
            joint.pin.youngs_modulus,
            poisson_1=joint.pin.poissons_ratio,
            youngs_2=joint.bushing.youngs_modulus,
            poisson_2=joint.bushing.poissons_ratio,
        ),
    }

    # one surface moves, the other rests: the entrainment speed is half the sliding speed
    speed = triggers.sliding_speed.values / 2
    theory = line_contact_film(speed, stroke=joint.stroke, **contact)
    formula = dowson_higginson_film(speed, **contact)

    # film_theory is named after the regime of most triggers
    regimes, count = np.unique(np.asarray(theory.regime), return_counts=True)
    chosen = str(regimes[np.argmax(count)])
    gV, gE = float(np.median(theory.gV)), float(np.median(theory.gE))
    reason = (
        "the largest of the four line-contact asymptotes governs; "
        f"gV = {gV:.3g}, gE = {gE:.3g} (medians)"
    )
    film_theory = FILM["film_theory"].fill(
        1e6 * np.asarray(theory.film),
        long_name=f"steady line-contact film, {chosen} regime",
        regime=chosen,
        reason=reason,
        notes="\n".join(theory.notes),
    )
    regime = np.broadcast_to(np.asarray(theory.regime, dtype=str), speed.shape)
    predicted = xr.Dataset(
        {
            "film_hamrock_dowson": FILM["film_hamrock_dowson"].fill(1e6 * np.asarray(formula)),
            "film_theory": film_theory,
            "film_regime": FILM["film_regime"].fill(regime),
        }
    )

    if "film_min" in triggers:
        sides = joint.pin.roughness, joint.bushing.roughness
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
