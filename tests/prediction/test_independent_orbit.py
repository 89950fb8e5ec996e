"""The fit on orbits of the virtual rig, whose solver shares no code with the models."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.orbits import STATED

from erlif.models import Motion, solve_journal
from erlif.prediction import FrameMotion, MeasuredMotion, fit_motion
from erlif.rig import RigSettings
from erlif.rig.cavitation import follow_cavitated
from erlif.rig.film import crank_at, rocker_angle, rocker_range
from erlif.rig.journal import follow_pin, load_at
from erlif.rig.orbit import RigidBearing

TIME = np.linspace(0.0, 60 / 114, 51)
NOISE = np.array([1e-9, 1e-8])  # m, of the exact positions


def fit(rig, **options):
    """Fit to the exact positions of the rig over one turn of the crank."""
    place = follow_pin(TIME, rig)
    measured = MeasuredMotion(
        place, np.diag(NOISE**2) * np.ones((TIME.size, 1, 1)), np.zeros((TIME.size, 2, 0))
    )
    angle = rocker_angle(crank_at(TIME, rig), rig) - np.mean(rocker_range(rig))
    motion = Motion(TIME, angle=angle, load=load_at(TIME, rig))
    moved = FrameMotion(motion, np.arange(TIME.size), 0 * TIME, 0.12)
    found = fit_motion(measured, STATED, moved, **options)
    return place, found.estimates


@pytest.mark.parametrize(("viscosity", "elapsed"), [(0.1, 20.0), (0.31, 30.0)])
def test_viscosity_and_start_of_the_independent_orbit_are_found(viscosity, elapsed):
    rig = RigSettings(film="reynolds", tilt=0.0, viscosity=viscosity, elapsed=elapsed)
    place, found = fit(rig)
    npt.assert_allclose(found["viscosity"].value, viscosity, rtol=1e-3)
    film = 230e-6 - np.hypot(*place[0])
    npt.assert_allclose(found["start_film"].value, film, rtol=1e-4)
    npt.assert_allclose(found["load_line"].value, 0, atol=2e-5)


def test_cavities_carry_a_guided_pin_in_both_solvers():
    """Finite volumes with first-order steps, and projected over-relaxation with second-order ones.

    Half a per cent is what refined steps and cells of the finite volumes would still change.
    """
    rig = RigSettings()
    start = (230e-6 - 18.5e-6, 0.0)
    time = np.linspace(0.0, 60 / 114, 201)
    middle = np.mean(rocker_range(rig))
    place = follow_cavitated(
        RigidBearing(np.sqrt(0.03336 * 0.03359), 0.23e-3, 0.237, 0.12),
        time,
        load=lambda _: 222.411,
        angle=lambda moment: float(rocker_angle(crank_at(np.asarray(moment), rig), rig) - middle),
        step=time[-1] / 100,
        stiffness=np.inf,
        start=start,
    )
    motion = Motion(time, angle=rocker_angle(crank_at(time, rig), rig) - middle, load=222.411)
    found = solve_journal(STATED, motion, start=start, sideways="guided", cells=(192, 16))
    independent = 230e-6 - place[:, 0]
    npt.assert_allclose(found.film_min, independent, rtol=5e-3)
    assert np.ptp(independent) > 2e-6  # thin after each reversal, thick between
