"""Integrals over the arc of contact against the indentation integrated by quadrature."""

import numpy as np
import numpy.testing as npt
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from erlif.models.contact import winkler_contact, winkler_load
from erlif.models.contact.arc import rubbed_by_arc, supported_by_arc

CASES = [(0.3, 0.99), (0.9, 0.9), (1.2, 0.5), (np.pi / 2, 0.3), (np.pi / 2, 0.999)]


def indentation(angle, eccentricity, fit):
    """Of the shaft, over the bushing radius; Colbert et al. (2009), B6."""
    return fit - np.sqrt(1 - (eccentricity * np.sin(angle)) ** 2) + eccentricity * np.cos(angle)


@pytest.mark.parametrize(("half_angle", "fit"), CASES)
def test_integrals_are_those_of_the_indentation(half_angle, fit):
    e = brentq(lambda trial: indentation(half_angle, trial, fit), 0.0, 1.0, xtol=1e-15)
    options = {"epsabs": 0, "epsrel": 1e-12}
    for found, weight in ((supported_by_arc, np.cos), (rubbed_by_arc, np.ones_like)):

        def weighed(angle, weight=weight):
            return indentation(angle, e, fit) * weight(angle)

        true = 2 * fit * quad(weighed, 0, half_angle, **options)[0]
        npt.assert_allclose(found(np.array([half_angle]), fit=np.array([fit])), true, rtol=1e-9)


@pytest.mark.parametrize("clearance", [1e-6, 1e-3, 0.1])
def test_narrow_arcs_have_the_parabola_of_hertz(clearance):
    """For a narrow arc the indentation is e (A^2 - t^2)(1 - e)/2 with e = 1 - fit."""
    half_angle = 1e-4
    fit, e = 1 - clearance, clearance
    both = 2 * fit * e * (1 - e) * half_angle**3 / 3
    for found in (supported_by_arc, rubbed_by_arc):
        npt.assert_allclose(found(np.array([half_angle]), fit=np.array([fit])), both, rtol=2e-8)


def test_contacts_are_found_again():
    rng = np.random.default_rng(0)
    half_angle = rng.uniform(1e-3, np.pi / 2, 10**5)
    shaft = 0.01 * (1 - 10 ** rng.uniform(-6, -0.3, half_angle.size))
    case = {"shaft_radius": shaft, "bushing_radius": 0.01, "thickness": 1e-3, "modulus": 1e9}
    found = winkler_contact(winkler_load(half_angle, **case), **case)
    npt.assert_allclose(found.half_angle, half_angle, rtol=1e-12)
