"""Film thickness predicted by lubrication theory for each trigger."""

from __future__ import annotations

import numpy as np
import xarray as xr

from erlif.core.errors import ConfigError
from erlif.core.products import require
from erlif.kinematics import entrained_stroke
from erlif.models.contact import conformal_radius, contact_modulus
from erlif.models.film import dowson_higginson_film, film_parameter, line_contact_film
from erlif.models.oil import vogel_viscosity
from erlif.settings import RunSettings


def predict_film(triggers: xr.Dataset, settings: RunSettings) -> xr.Dataset:
    """Film that theory expects at the speed and load of each trigger.

    Parameters
    ----------
    triggers : xarray.Dataset
        sliding_speed [m s-1], load [N], and temperature [degree_Celsius] where the oil follows Vogel's law; dim trigger.
    settings : RunSettings

    Returns
    -------
    xarray.Dataset
        film_hamrock_dowson, the 2.65 line-contact formula [um]; film_theory, what the regime map selects [um], with its regimes and
        limits as attributes; film_parameter [1] where roughness is given.
    """
    require(triggers, "sliding_speed", "load")
    joint, oil = settings.joint, settings.oil
    radius = conformal_radius(joint.pin_radius, bushing_radius=joint.bushing_radius)
    modulus = contact_modulus(
        joint.pin.youngs_modulus,
        poisson_1=joint.pin.poissons_ratio,
        youngs_2=joint.bushing.youngs_modulus,
        poisson_2=joint.bushing.poissons_ratio,
    )
    if oil.vogel is not None:
        if "temperature" not in triggers:
            raise ConfigError(
                "Expected a column temperature_C in the encoder log, because [oil] gives the viscosity by Vogel's law; there is none. Log the "
                'temperature, or give viscosity = "0.12 Pa s".'
            )
        viscosity = np.asarray(
            vogel_viscosity(
                triggers.temperature.values + 273.15,
                a=oil.vogel.a,
                b=oil.vogel.b,
                c=oil.vogel.c + 273.15,
            )
        )
    else:
        viscosity = np.full(triggers.sizes["trigger"], oil.viscosity)
    contact = {
        "load_per_length": triggers["load"].values / joint.length,
        "viscosity": viscosity,
        "pressure_viscosity": oil.pressure_viscosity,
        "radius": radius,
        "contact_modulus": modulus,
    }
    speed = (
        triggers.sliding_speed.values / 2
    )  # the bushing surface rests: entrainment is half the sliding speed
    theory = line_contact_film(speed, stroke=entrained_stroke(settings), **contact)
    regimes, count = np.unique(np.asarray(theory.regime), return_counts=True)
    chosen = str(regimes[np.argmax(count)])
    predicted = xr.Dataset(
        {
            "film_hamrock_dowson": (
                "trigger",
                1e6 * np.asarray(dowson_higginson_film(speed, **contact)),
                {"units": "um", "long_name": "line-contact formula, 2.65 G^0.54 U^0.7 W^-0.13"},
            ),
            "film_theory": (
                "trigger",
                1e6 * np.asarray(theory.film),
                {
                    "units": "um",
                    "long_name": f"steady line-contact film, {chosen} regime",
                    "regime": chosen,
                    "regimes_by_trigger": " ".join(str(name) for name in np.asarray(theory.regime)),
                    "reason": "the largest of the four line-contact asymptotes governs; "
                    f"gV = {float(np.median(theory.gV)):.3g}, gE = {float(np.median(theory.gE)):.3g} (medians)",
                    "notes": "\n".join(theory.notes),
                },
            ),
        }
    )
    if (
        joint.pin.roughness is not None
        and joint.bushing.roughness is not None
        and "film_min" in triggers
    ):
        film = np.maximum(triggers.film_min.values, 0.0) * 1e-6
        ratio = film_parameter(
            film, roughness_a=joint.pin.roughness, roughness_b=joint.bushing.roughness
        )
        predicted["film_parameter"] = (
            "trigger",
            ratio,
            {"units": "1", "long_name": "least film over roughness, Lambda"},
        )
    return predicted
