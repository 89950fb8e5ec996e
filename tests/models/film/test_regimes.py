"""The regime that governs, and the limits that are stated beside a film."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.pin_joint import ACRYLIC, LBF, LENGTH, MAP, thesis_case

from erlif.models.film import line_contact_film


@pytest.mark.parametrize(("modulus", "load", "gE", "gV", "films", "regime"), MAP)
def test_regime_map_of_the_joint(modulus, load, gE, gV, films, regime):
    found = line_contact_film(0.0421, **thesis_case(load * LBF, contact_modulus=modulus))
    asymptotes = (
        found.isoviscous_rigid,
        found.piezoviscous_rigid,
        found.isoviscous_elastic,
        found.piezoviscous_elastic,
    )
    npt.assert_allclose(
        np.array(asymptotes) * 1e6, films, rtol=8e-3
    )  # half of the last printed digit
    npt.assert_allclose(found.gE, gE, rtol=5e-3)
    npt.assert_allclose(
        found.gV, gV, rtol=0.03 if gV == 0.0017 else 5e-3
    )  # two digits printed there
    assert found.regime == regime


@pytest.mark.parametrize(
    ("speed", "load", "words", "noted"),
    [  # a stroke does not sweep the contact from 11.9, and the half of it from 47.7 klbf on
        (0.0421, 11.7e3, "stroke of", False),
        (0.0421, 12.1e3, "never crosses", True),
        (0.0421, 47.4e3, "never crosses", True),
        (0.0421, 48.0e3, "never reaches", True),
        # half width of 100 klbf; Farzaneh (2002), section 3.2
        (0.0421, [np.nan, 1e5], "half width of 10.3 mm", True),
        (np.linspace(-0.04, 0.04, 5), 1e5, "reverses", True),
        (0.04, 1e5, "reverses", False),
        # Hertz 1.16 GPa
        (0.04, 1e7, "0.5 GPa", True),
        (0.04, 1e5, "0.5 GPa", False),
    ],
)
def test_notes_say_what_the_film_does_not_count(speed, load, words, noted):
    case = thesis_case(np.multiply(load, LBF))
    notes = line_contact_film(speed, **case, stroke=7.11e-3).notes
    assert any(words in note for note in notes) == noted
    (without,) = (note for note in line_contact_film(0.04, **case).notes if "stroke" in note)
    assert "No stroke given" in without


def test_regimes_broadcast_and_keep_coordinates():
    load = [50 * LBF / LENGTH, 1333 * LBF / LENGTH, np.nan]
    acrylic = thesis_case(1.0, contact_modulus=ACRYLIC)
    loads = xr.DataArray(load, dims="load", coords={"load": [50, 1333, 0]})
    found = line_contact_film(0.0421, **acrylic | {"load_per_length": loads})
    assert isinstance(found.film, xr.DataArray)
    names = ["isoviscous-elastic", "isoviscous-rigid", ""]
    assert list(found.regime.sel(load=[1333, 50, 0]).values) == names
    assert np.isnan(found.film[2])
