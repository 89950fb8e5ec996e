"""Wear of the slider-crank joint by its own forces: tables of the source, first order."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.models.mechanism import SliderCrank
from erlif.models.reaction import SliderCrankBodies
from erlif.models.wear import (
    coupled_wear,
)

PTFE = 2200.0  # kg/m3, assumed by no source but needed to turn worn mass into volume


MUKRAS = SliderCrank(crank=0.0762, coupler=0.2032)


def mukras_wear(*, preload=68.354, cycles=32_000, width=8.468e-3, **options):
    bodies = SliderCrankBodies(
        rod_mass=0.8175,
        rod_inertia=5500e-6,
        slider_mass=5.5487,
        spring_stiffness=525.4,
        spring_preload=preload,
    )
    return coupled_wear(
        options.pop("linkage", MUKRAS),
        crank_speed=np.pi,
        bodies=bodies,
        bushing_radius=9.535e-3,
        bushing_width=width,
        specific_wear=5.05e-13,
        cycles=cycles,
        **options,
    )


def grams(wear):
    return wear.volume[-1] * PTFE * 1e3


def test_worn_mass_and_depth_of_mukras():
    """Mukras et al. (2008), Table 4: 0.2336 g, 0.6575 mm, with preload and width fitted."""
    found = mukras_wear(coupled=False)
    npt.assert_allclose(grams(found), 0.2336, rtol=1e-4)
    npt.assert_allclose(found.depth[-1] * 1e3, 0.6575, rtol=1e-4)


def test_wear_relaxes_the_spring():
    """To first order the force falls by the stiffness times the clearance."""
    coupled, alone = (
        mukras_wear(cycles=95_000, extrapolation=100),
        mukras_wear(cycles=95_000, coupled=False),
    )
    loss = 1 - coupled.volume[-1] / alone.volume[-1]
    mean_force = alone.volume[-1] / (5.05e-13 * 9.535e-3 * 2 * np.pi * 95_000)
    npt.assert_allclose(loss, 525.4 * alone.depth[-1] / 2 / mean_force, rtol=0.1)
    assert np.all(np.diff(coupled.greatest_force) < 0)
    assert np.ptp(alone.greatest_force) == 0
    npt.assert_allclose(
        coupled.greatest_force[0] - coupled.greatest_force[-1], 525.4 * coupled.depth[-1], rtol=0.02
    )


def test_extrapolation_converges_to_first_order():
    exact = mukras_wear(extrapolation=50).volume[-1]
    errors = [mukras_wear(extrapolation=n).volume[-1] - exact for n in (2000, 4000, 8000)]
    npt.assert_allclose(np.divide(errors[1:], errors[:-1]), 2, rtol=0.1)
    found = mukras_wear(cycles=1001, extrapolation=500)
    npt.assert_array_equal(found.cycles, [0, 500, 1000, 1001])


def test_too_long_a_step_is_refused():
    with pytest.raises(ModelError, match="extrapolation must be smaller"):
        mukras_wear(cycles=10**7, extrapolation=10**6)
