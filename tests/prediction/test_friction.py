"""Friction of a measured film, and its errors, against sums over the gap and draws."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.models.reynolds import Journal, Motion, solve_journal, steady_journal
from erlif.prediction import GivenErrors, find_friction

PIN = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)
U, W = 0.0842, 222.4
BOTH = ("trigger", "parameter", "parameter_other")
PLACE = (222.0, 24.0)


def film(place=PLACE, std=(0.0, 0.0), load=W, speed=U, *, tilt=0.0, cov=None, **more):
    """Film of one trigger; the standard deviations [um, um/mm] are those of the first numbers."""
    known = np.diag([*np.square(std), 0, 0, 0, 0][:4]) if cov is None else cov
    cov = np.asarray(known)[None]
    columns = {"sliding_speed": speed, "joint_load": load} | more
    return xr.Dataset(
        {
            "pin_displacement": (("trigger", "axis"), np.array([place])),
            "pin_tilt": (("trigger", "axis"), np.array([[tilt, 0.0]])),
            "pin_position_cov": (BOTH, cov),
            "pin_position_cov_random": (BOTH, cov / 4),
        }
        | {name: ("trigger", np.array([value], float)) for name, value in columns.items()}
    )


def friction(measured, pin=PIN, *, direction=1.0, viscosity=0.0, sideways="free", **errors):
    ones = np.ones(1)
    return find_friction(
        measured,
        pin,
        viscosity=0.12 * ones,
        direction=direction * ones,
        viscosity_std=viscosity,
        sideways=sideways,
        given=GivenErrors(**errors),
    )


def sum_over_gap(place=PLACE, *, clearance=230.0, load=W, side=0.0, tilt=0.0):
    """Torque by the sum over the gap, and half of the moment of the forces. [N m]"""
    angle = np.linspace(-np.pi, np.pi, 8001)
    z = np.linspace(-118.5, 118.5, 201)[:, None] if tilt else np.zeros((1, 1))
    ex, ey = np.array(place)
    gap = 1e-6 * (clearance - (ex + tilt * z) * np.cos(angle) - ey * np.sin(angle))
    thin = np.trapezoid(1 / gap, angle, axis=1).mean()
    return 0.12 * U * PIN.radius**2 * 0.237 * thin + (ey * load - ex * side) * 0.5e-6


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_torque_is_the_sum_over_the_gap_and_the_moment_of_the_load(direction):
    found = friction(film(), direction=direction)
    expected = sum_over_gap((222.0, direction * 24.0))
    npt.assert_allclose(found.friction_torque, expected, rtol=1e-6)
    npt.assert_allclose(found.friction_torque_pressure, direction * 12e-6 * W, rtol=1e-9)
    npt.assert_allclose(found.friction_coefficient, expected / (W * PIN.radius), rtol=1e-6)
    npt.assert_allclose(found.friction_power, expected * U / 0.03336, rtol=1e-6)
    npt.assert_allclose(found.hersey_number, 0.12 * U * 0.237 / W, rtol=1e-9)


def test_errors_of_the_position_are_those_of_draws():
    rng, std = np.random.default_rng(1), (0.05, 0.4)
    torques = [sum_over_gap(tuple(one)) for one in rng.normal(PLACE, std, (1000, 2))]
    found = friction(film(std=std))
    npt.assert_allclose(found.friction_torque_std.item(), np.std(torques), rtol=0.07)
    npt.assert_allclose(found.friction_torque_std_random, found.friction_torque_std / 2, rtol=1e-6)


def test_errors_of_given_numbers_are_finite_differences():
    shear = sum_over_gap(load=0.0)
    npt.assert_allclose(friction(film(), viscosity=0.03).friction_torque_std, 0.03 * shear, 1e-6)
    # a wider clearance moves the pin towards the thinnest film, which is measured
    away = np.array(PLACE) * (1 + 1 / np.hypot(*PLACE))
    wider = sum_over_gap(tuple(away), clearance=231.0) - sum_over_gap()
    found = friction(film(), clearance=1e-6).friction_torque_std
    npt.assert_allclose(found, abs(wider), rtol=0.02)


def draw_torques(place, tilt, cov):
    """Mean and scatter of the torques of true pins that may be behind a measured one, and the share
    that does not touch. Of a slice of the joint the sum over the gap is 2 pi / sqrt(c^2 - e^2).
    """
    drawn = np.random.default_rng(2).multivariate_normal([*place, tilt], cov, 4000)
    load, side, rise = drawn.T[..., None]
    z = 118.5 * (np.arange(-399, 400, 2) / 400)
    distance = np.hypot(load + rise * z, side)
    free = (distance[:, [0, -1]] < 230).all(axis=1)
    thin = (1 / np.sqrt(230**2 - distance[free] ** 2)).mean(axis=1)
    torques = 2e6 * np.pi * 0.12 * U * PIN.radius**2 * 0.237 * thin + side[free, 0] * 0.5e-6 * W
    return torques.mean(), torques.std(), free.mean()


@pytest.mark.parametrize(
    ("tilt", "tilt_std", "link"),
    [(0.0, 0.01, 0.0), (0.03, 0.004, 0.0), (0.03, 0.004, 0.8), (0.03, 0.004, -0.8), (0.02, 0.2, 0)],
)
def test_torque_of_a_tilted_pin_is_the_mean_of_those_that_may_be_behind_it(tilt, tilt_std, link):
    place, std = (222.0, 0.0), (0.1, 0.3, tilt_std)
    cov = np.diag(std) @ [[1, 0, link], [0, 1, 0], [link, 0, 1]] @ np.diag(std)
    mean, scatter, free = draw_torques(place, tilt, cov)
    assert (free < 0.5) == (tilt_std > 0.1)  # where contact alone limits the tilt
    whole = np.zeros((4, 4))
    whole[:3, :3] = cov
    found = friction(film(place, tilt=tilt, cov=whole))
    npt.assert_allclose(found.friction_torque, mean, rtol=0.004)
    npt.assert_allclose(found.friction_torque_std, scatter, rtol=0.08)


def test_load_and_viscosity_act_on_the_coefficient_as_on_the_torque():
    """Finite differences: the moment is in proportion to the load, a held wedge to the oil."""
    more = friction(film(load=1.01 * W)), friction(film(load=0.99 * W))
    for name in ("friction_torque", "friction_coefficient"):
        found = friction(film(), load=0.05)[f"{name}_std"].item()
        slope = (more[0][name].item() - more[1][name].item()) / 0.02
        npt.assert_allclose(found, 0.05 * abs(slope), rtol=1e-3)
    place = (100.0, 0.0)  # full: no cavities add to the error
    ones = np.ones(1)
    torques = [
        find_friction(
            film(place),
            PIN,
            viscosity=times * 0.12 * ones,
            direction=ones,
            sideways="guided",
            given=GivenErrors(),
        )
        for times in (1.01, 0.99)
    ]
    assert not torques[0].friction_void_share.any()
    slope = (torques[0].friction_torque - torques[1].friction_torque).item() / 0.02
    found = friction(film(place), viscosity=0.03, sideways="guided").friction_torque_std.item()
    npt.assert_allclose(found, 0.03 * slope, rtol=1e-3)


def test_spring_holds_a_pin_that_is_off_its_line():
    found = friction(film(), sideways=1e6)
    npt.assert_allclose(found.friction_torque, sum_over_gap(side=-24.0), rtol=1e-6)


@pytest.mark.parametrize("start", [60e-6, 10e-6])
def test_guided_pin_has_the_torque_of_its_solved_film(start):
    """The thick film is full, the thin one has cavities; torques over a turn, by the solver."""
    time = np.linspace(0, 2 * 0.5263, 201)
    angle = 0.106 * np.sin(2 * np.pi * time / 0.5263)
    place = (PIN.clearance - start, 0.0)
    solved = solve_journal(PIN, Motion(time, angle, W), start=place, sideways="guided")
    speed = np.diff(angle) / np.diff(time)
    ex = solved.displacement_load.values
    for k in np.flatnonzero(np.abs(speed) > 0.5)[60::5]:
        at, sense = 0.5e6 * (ex[k] + ex[k + 1]), np.sign(speed[k])
        measured = film((at, 0.0), speed=abs(speed[k]) * PIN.radius)
        found = friction(measured, direction=sense, sideways="guided")
        expected = sense * float(solved.friction_torque[k + 1])
        std = found.friction_torque_std.item()
        assert (std > 1e-6) == (start < 50e-6)
        assert abs(found.friction_torque.item() - expected) < max(2 * std, 2e-3 * expected)


def test_cavities_are_known_by_the_pressure_of_the_full_film():
    """The turning joint under 5 kN has cavities, whose oil the solver conserves."""
    for load, full in ((W, True), (5e3, False)):
        steady = steady_journal(PIN, speed=U / PIN.radius, load=load)
        place = tuple(1e6 * float(steady[f"displacement_{name}"]) for name in ("load", "side"))
        found = friction(film(place, load=load))
        assert (found.friction_void_share.item() == 0) == full
        off = found.friction_torque.item() - float(steady.friction_torque)
        assert abs(off) < max(
            found.friction_torque_std.item(), 1e-3 * float(steady.friction_torque)
        )


def test_logged_torque_of_either_sign_leaves_what_the_film_does_not_carry():
    whole = sum_over_gap() + 0.05
    for sign in (1, -1):
        found = friction(film(torque_logged=sign * whole), viscosity=0.01)
        npt.assert_allclose(found.torque_not_film, 0.05, rtol=1e-6)
    assert "torque_not_film" not in friction(film())


def test_a_pin_that_touches_has_no_friction_of_its_film():
    found = friction(film((230.1, 0.0)))
    assert np.isnan(found.friction_torque.item())
    assert np.isfinite(found.hersey_number.item())
