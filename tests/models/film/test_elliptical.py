"""Films of points and ellipses: limits of the fits, and what they tend to."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.pin_joint import STEEL

from erlif.core.errors import RangeWarning
from erlif.models.film import elliptical_contact_film, hamrock_dowson_film

BALL = {
    "load": 100.0,
    "viscosity": 0.05,
    "pressure_viscosity": 2e-8,
    "radius_along": 0.01,
    "radius_across": 0.02,
    "contact_modulus": STEEL,
}


@pytest.mark.filterwarnings("ignore::erlif.core.errors.RangeWarning")  # a line is k = infinity
def test_hamrock_dowson_tends_to_its_line_contact_form():
    def films(across):
        return hamrock_dowson_film(1.0, **BALL | {"radius_across": across})

    minimum, central = films(0.01)
    far_minimum, far_central = films(1e4)
    G, U, W = 2e-8 * 2 * STEEL, 0.05 / (2 * STEEL * 0.01), 100 / (2 * STEEL * 1e-4)
    npt.assert_allclose(far_minimum, 0.01 * 3.63 * U**0.68 * G**0.49 * W**-0.073)
    npt.assert_allclose(far_central, 0.01 * 2.69 * U**0.67 * G**0.53 * W**-0.067)
    assert minimum < central
    assert minimum < far_minimum


@pytest.mark.parametrize(("along", "across", "k"), [(4.87, 0.2, "0.133"), (0.01, 0.3, "9.08")])
def test_hamrock_dowson_warns_outside_its_fit(along, across, k):
    """k = 1.03 (Ry/Rx)^0.64; the first is the lobed bushing of Farzaneh (2002)."""
    case = {**BALL, "radius_along": along, "radius_across": across}
    with pytest.warns(RangeWarning, match=rf"k = 1 to 8; k = {k}") as record:
        hamrock_dowson_film(1.0, **case)
    assert record[0].filename == __file__


def test_regimes_of_an_ellipse_broadcast_and_keep_coordinates():
    """A soft ball under loads that make it rigid and elastic; no film at a standstill."""
    rubber = BALL | {"contact_modulus": 5e6}
    loads = xr.DataArray([1e-5, 1.0, np.nan], dims="load", coords={"load": [0, 1, 2]})
    found = elliptical_contact_film(0.1, **rubber | {"load": loads})
    assert found.regime.values.tolist() == ["isoviscous-rigid", "isoviscous-elastic", ""]
    npt.assert_array_equal(found.film["load"], [0, 1, 2])
    npt.assert_array_equal(found.film[1], found.isoviscous_elastic[1])
    npt.assert_array_equal(
        found.central[0], found.film[0]
    )  # rigid bodies are nearest at the centre
    assert found.central[1] > 1.2 * found.film[1]
    assert np.isnan(found.film[2])
    assert elliptical_contact_film(0.0, **BALL).film == 0


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("across", "noted"), [(0.2, True), (0.01, False), (0.16, False)])
def test_an_ellipse_outside_the_fit_has_a_note(across, noted):
    """k = 1.03 (Ry/Rx)^0.64 is 0.133 for a lobe of the thesis, 1.03 for a ball, 6 for a barrel."""
    along = 4.87 if noted else 0.01
    found = elliptical_contact_film(
        1.0, **BALL | {"radius_along": along, "radius_across": across}, stroke=np.inf
    )
    assert any("k = 0.133 here" in note for note in found.notes) == noted


def test_the_elastic_film_of_an_ellipse_is_that_of_1977():
    hard = BALL | {"radius_across": 0.03}
    found, formula = elliptical_contact_film(0.1, **hard), hamrock_dowson_film(0.1, **hard)
    assert found.piezoviscous_elastic == formula.minimum
    assert found.regime == "piezoviscous-elastic"
    assert (found.film, found.central) == formula
