"""Film thickness by lubrication theory, against values recomputed by hand."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.core.errors import ConfigError
from erlif.trend import LubricatedJoint, Solid, VogelLaw, predict_film

ACRYLIC = Solid(2.7e9, 0.37, 0.2e-6)
STEEL = Solid(200e9, 0.3)  # E* = 109.8901 GPa
POUND = 4.4482216  # N
SPEED = 0.0842  # m/s, sliding speed of the joint


def joint(solid=ACRYLIC, **changes):
    values = {"viscosity": 0.12, "pressure_viscosity": 20e-9, **changes}
    return LubricatedJoint(33.36e-3, 33.59e-3, 0.237, solid, solid, **values)


def at(speed, load, **more):
    variables = {"sliding_speed": speed, "joint_load": load, **more}
    return xr.Dataset(
        {name: ("trigger", np.atleast_1d(value)) for name, value in variables.items()}
    )


# film in um: 2.65 by hand; the minimum by tests/oracles/line_contact.py, of which the curve is
# within 0.3 % for both
@pytest.mark.parametrize(
    ("pounds", "theory", "hamrock_dowson", "regime"),
    [(50, 128.45, 1.92, "isoviscous-rigid"), (1333, 8.525, 1.25, "isoviscous-elastic")],
)
def test_theory_of_the_acrylic_joint(pounds, theory, hamrock_dowson, regime):
    predicted = predict_film(at(SPEED, pounds * POUND), joint())
    npt.assert_allclose(predicted.film_theory, theory, rtol=3e-3)
    npt.assert_allclose(predicted.film_hamrock_dowson, hamrock_dowson, rtol=4e-3)
    assert predicted.film_theory.attrs["regime"] == regime


def test_film_is_named_after_the_regime_of_most_triggers():
    loads = [50 * POUND, 1333 * POUND, 1333 * POUND]
    predicted = predict_film(at([SPEED] * 3, loads), joint())
    assert predicted.film_theory.attrs["regime"] == "isoviscous-elastic"
    assert predicted.film_regime.values.tolist() == [
        "isoviscous-rigid",
        "isoviscous-elastic",
        "isoviscous-elastic",
    ]


def test_contact_wider_than_the_stroke_has_a_note():
    """100 klbf on steel: 20.6 mm of contact, 7.11 mm of entrained stroke."""
    contact = predict_film(at(SPEED, 444.8e3), joint(STEEL, stroke=7.11e-3))
    assert "stroke" in contact.film_theory.attrs["notes"]
    swept = predict_film(at(SPEED, 444.8e3), joint(STEEL))
    assert "stroke" not in swept.film_theory.attrs["notes"]


def test_film_parameter_is_film_over_combined_roughness():
    """Noise may leave the fitted minimum below zero, where the parameter is zero."""
    predicted = predict_film(at([0.08] * 2, [222.0] * 2, film_min=[1.0, -0.1]), joint())
    npt.assert_allclose(predicted.film_parameter, [1.0 / (0.2 * np.sqrt(2)), 0.0])
    for solid, more in ((Solid(2.7e9, 0.37), {"film_min": 1.0}), (ACRYLIC, {})):
        assert "film_parameter" not in predict_film(at(0.08, 222.0, **more), joint(solid))


VOGEL = VogelLaw(0.0001, 900.0, -100.0)


def test_viscosity_by_vogels_law_follows_the_temperature():
    """The film of hardly loaded bodies is proportional to viscosity: 25 and 40 degC."""
    predicted = predict_film(
        at([SPEED] * 2, [0.2224] * 2, temperature=[25.0, 40.0]), joint(viscosity=VOGEL)
    )
    cold, warm = predicted.film_theory.values
    npt.assert_allclose(cold / warm, np.exp(900 / 125 - 900 / 140), rtol=1e-6)
    with pytest.raises(ConfigError, match="temperature_C"):
        predict_film(at(SPEED, 222.4), joint(viscosity=VOGEL))
