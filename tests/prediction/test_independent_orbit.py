"""The fit on orbits of the virtual rig, whose solver shares no code with the models."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.kept import kept_orbit, name_of
from scenes.orbits import STATED

from erlif.core.errors import ConfigError
from erlif.models import Motion, solve_journal
from erlif.models.reynolds import Journal
from erlif.prediction import FrameMotion, GivenErrors, MeasuredMotion, fit_motion
from erlif.rig import RigSettings
from erlif.rig.cavitation import follow_cavitated
from erlif.rig.film import bore_height, crank_at, rocker_angle, rocker_range
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


SHORT = Journal(0.03336, 0.03359, 0.03, 0.12)
BORES = {
    "lobes": {"lobes": (-4.0, 4.5), "load": 30.0, "elapsed": 2.1, "sideways": "guided"},
    "roughness": {"roughness": 1.0, "rough": True, "load": 90.0, "elapsed": 4.1},
}
"""Films of 12 to 4 um and 6 to 4 um."""
MODELS = {
    "lobes": {
        "axial_shape": 1e-6
        * bore_height(RigSettings(lobes=BORES["lobes"]["lobes"]), np.linspace(-15, 15, 4001))
    },
    "roughness": {"roughness": np.sqrt(2) * 1e-6},
}


def follow_bore(name):
    """Place of the pin over a turn of the crank. [m]"""
    rig = RigSettings(film="reynolds", tilt=0.0, length=30.0, load_swing=0.0, **BORES[name])
    found = kept_orbit(name_of(rig), lambda: follow_pin(TIME, rig))
    angle = rocker_angle(crank_at(TIME, rig), rig) - np.mean(rocker_range(rig))
    crank = 2 * np.pi * TIME / TIME[-1]
    motion = Motion(TIME, angle=angle, load=rig.load)
    return found, FrameMotion(motion, np.arange(TIME.size), crank, 0.12)


@pytest.mark.slow
@pytest.mark.parametrize("name", BORES)
def test_viscosity_is_found_on_a_bore_with_lobes_or_roughness(name):
    """With noise of 20 nm along the load and 100 nm aside; a smooth joint, of which the films are
    not, would have another viscosity. A liner is in tests/pipeline/physics/test_bore.py."""
    place, moved = follow_bore(name)
    joint, noise = replace(SHORT, **MODELS[name]), np.array([2e-8, 1e-7])
    seen = place + noise * np.random.default_rng(1).normal(size=place.shape)
    covariance = np.diag(noise**2) * np.ones((TIME.size, 1, 1))
    measured = MeasuredMotion(seen, covariance, np.zeros((TIME.size, 2, 0)))
    held = BORES[name].get("sideways", "free")
    options = {"sideways": held, "profiles": False, "given": GivenErrors(load_line=0.0)}
    found = fit_motion(measured, joint, moved, **options)
    viscosity = found.estimates["viscosity"]
    assert abs(viscosity.value - 0.12) < 2 * viscosity.std < 0.05 * 0.12
    assert found.inflation < 1.5
    if name == "roughness":
        plain = fit_motion(measured, SHORT, moved, **options)
        off = plain.estimates["viscosity"]
        assert abs(off.value - 0.12) > 4 * off.std


def test_positions_on_a_liner_are_refused():
    exact = MeasuredMotion(
        np.full((9, 2), 1e-4), np.eye(2) * np.ones((9, 1, 1)), np.zeros((9, 2, 0))
    )
    motion = Motion(np.arange(9.0), angle=np.zeros(9), load=1.0)
    moved = FrameMotion(motion, np.arange(9), np.zeros(9), 0.12)
    with pytest.raises(ConfigError, match="yield is part of the positions"):
        fit_motion(exact, replace(SHORT, foundation=1e12), moved)
