"""Pressure of a moving pin against the series solution of the virtual rig and closed forms."""

from dataclasses import fields, replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.pin import follow_true_pin

from erlif.models.reynolds import Journal
from erlif.prediction.pin_film import OverlapError, follow_cavities, solve_pin_motion
from erlif.prediction.pin_motion import PinMotion, find_pin_motion
from erlif.prediction.pressure import find_pressures

JOINT = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)
PLACE = np.linspace(-0.012, 0.012, 25)
NOISE = np.diag([4.5e-9, 4.7e-8, 1.4e-6, 1.5e-5]) ** 2
"""Of a position of the sample: 4.5 nm, 47 nm, 1.4 nm/mm and 15 nm/mm."""


ONCE = ("period", "recorded", "otherwise")
"""Fields of a motion that are not of each trigger."""

EVERY = slice(1, None, 3)
"""Moments at which the pressure is found, at the ends of the cycle and within it."""


def move(pin, cov, error=0.0):
    """Motion of a pin from its positions with an error."""
    cov = np.broadcast_to(cov, (pin.time.size, 4, 4))
    return find_pin_motion(pin.time, pin.angle, pin.turning, pin.position + error, random_cov=cov)


def find(pin, cov, error=0.0, cells=(192, 12)):
    motion = move(pin, cov, error)
    by_trigger = [one.name for one in fields(motion) if one.name not in ONCE]
    some = {name: getattr(motion, name)[EVERY] for name in by_trigger}
    motion = PinMotion(**{**some, "noise_scale": motion.noise_scale})
    return find_pressures(
        JOINT,
        motion,
        viscosity=np.full(motion.turning.size, 0.12),
        place=PLACE,
        axial=np.array([-0.006, 0.0, 0.006]),
        cells=cells,
    )


def test_peak_place_and_load_lie_within_their_errors(free_pin):
    """Twelve runs with the noise of the sample; moments of a run are correlated.

    The load is even in the tilt, which is 0: a tilt t adds L'' t^2/2, and the stated error, with
    the derivative at the measured tilt, is L'' |t| s. Where this part is all, 95 % of the loads
    lie within one standard deviation, which is reached at a tilt of 2 s.
    """
    pulls = {"peak": [], "place": [], "load": [], "side": []}
    for seed in range(12):
        noise = np.random.default_rng(seed).multivariate_normal(np.zeros(4), NOISE, 12)
        found = find(free_pin, NOISE, noise)
        assert found.pressure_measured.values.all()
        for name, variable, truth in (
            ("peak", "peak_pressure", free_pin.peak[EVERY]),
            ("place", "peak_place", free_pin.place[EVERY]),
            ("load", "load_from_pressure", free_pin.rig.load),
            ("side", "side_from_pressure", 0.0),
        ):
            pulls[name].append((found[variable] - truth) / found[f"{variable}_std"])
    for name, pull in pulls.items():
        inside = np.abs(pull) < 1, np.abs(pull) < 1.96
        assert 0.55 < inside[0].mean() < (0.95 if name == "load" else 0.82), name
        assert inside[1].mean() > 0.90, name


def test_a_gap_that_closes_outside_the_image_has_no_pressure(free_pin):
    tilted = free_pin.position + np.array([0, 0, 1e-4, 0])  # 12 um at the ends
    with pytest.raises(OverlapError, match="overlap by 5"):
        solve_pin_motion(JOINT, tilted[0], free_pin.rate[0], 0.0)
    found = find(replace(free_pin, position=tilted), NOISE)
    assert not found.pressure_measured.values.any()
    assert np.isnan(found.peak_pressure_std.values).all()


@pytest.fixture(scope="module")
def guided_pin():
    """Films of 9 to 16 um under 2 kN; the wedge alone would carry several times the load."""
    return follow_true_pin(24, sideways="guided", elapsed=1.5, load=2000.0)


def find_guided(pin, noise):
    """Pressure with noise in the displacements; derivatives with tilts cost as much again."""
    cov = np.diag([4e-9, 5e-8, 1e-12, 1e-12]) ** 2
    error = np.random.default_rng(0).multivariate_normal(np.zeros(4), cov, 24)
    motion = move(pin, cov, noise * error)
    uncertain = np.tile([1, 1, 0, 0], 2)[:, None] * (noise > 0)
    return find_pressures(
        JOINT,
        replace(motion, random_root=uncertain * motion.random_root),
        viscosity=np.full(24, 0.12),
        place=PLACE,
        axial=np.zeros(1),
        cells=(128, 8),
    )


def test_the_cavities_of_a_guided_pin_are_followed(guided_pin):
    """Where one cavity closes and another opens the film falls by steps: no pressure there."""
    found = find_guided(guided_pin, 0.0)
    known = found.pressure_measured.values == 1
    assert known.sum() >= 8
    assert (found.cavity.values[known] > 0.05).all()
    npt.assert_allclose(found.load_from_pressure[known], 2000.0, rtol=0.03)
    npt.assert_array_equal(known, found.cavity_change.values <= 0.4)
    assert np.isnan(found.load_from_pressure.values[~known]).all()

    # the motion is exact: the error is that of cells and cavities, largest beside a kink
    beside = known & (np.roll(~known, 1) | np.roll(~known, -1))
    error = (found.load_from_pressure_std / found.load_from_pressure).values
    cells = 0.005 * (24 / 8) ** 2
    assert (error[known] > cells).all()
    assert np.median(error[known & ~beside]) < 1.2 * cells
    assert error[beside].max() > 1.2 * cells


def test_the_load_of_a_guided_pin_with_noise_lies_within_its_error(guided_pin):
    found = find_guided(guided_pin, 1.0)
    pull = ((found.load_from_pressure - 2000.0) / found.load_from_pressure_std).values
    pull = np.abs(pull[np.isfinite(pull)])
    assert pull.size >= 8
    assert (pull < 1.96).mean() > 0.85
    assert pull.max() < 4


def test_cavities_from_before_a_recording_leave_no_pressure(guided_pin):
    """Half a turn after loading the film is full; a turn like the recorded one has cavities."""
    motion = move(guided_pin, 1e-6 * NOISE)
    turn, another = (
        follow_cavities(JOINT, motion, sinking=sinking, cells=(128, 8)) for sinking in (1.0, 2.0)
    )
    assert turn[0].max() > 0.1 > another[0].max()
    npt.assert_allclose(turn[12:], another[12:], atol=0.02)  # of this recording alone


def test_viscosity_and_clearance_are_part_of_the_error(free_pin):
    """Without cavities the pressure of a given motion is proportional to the viscosity."""
    still = PinMotion(
        free_pin.time[:1],
        free_pin.angle[:1],
        free_pin.position[:1],
        free_pin.rate[:1],
        free_pin.turning[:1],
        *np.zeros((2, 1, 8, 1)),
        np.ones(4),
    )

    def at(joint, position=still.position, **errors):
        return find_pressures(
            joint,
            replace(still, position=position),
            viscosity=np.array([0.12]),
            place=PLACE,
            axial=np.zeros(1),
            cells=(192, 8),
            **errors,
        ).isel(trigger=0)

    plain, wide = at(JOINT), at(JOINT, settings_std=(0.05, 0.02))
    assert float(plain.peak_by_viscosity) == pytest.approx(1, abs=1e-3)
    cells = 0.005 * (24 / 8) ** 2  # second order, 0.5 % of 24 cells over the length
    assert float(plain.peak_pressure_std / plain.peak_pressure) == pytest.approx(cells, rel=1e-3)
    by_clearance = 0.02 * float(plain.peak_by_clearance)
    share = float(wide.peak_std_settings / wide.peak_pressure)
    assert share == pytest.approx(np.hypot(0.05, by_clearance), rel=1e-6)

    # a joint of 1 % more clearance whose film in the image is the same, in the mean of squares
    wider = 0.01 * JOINT.clearance
    seen = np.cos(PLACE / JOINT.radius)
    moved = still.position + np.array([wider * seen.sum() / (seen @ seen), 0, 0, 0])
    other = at(replace(JOINT, bushing_radius=JOINT.bushing_radius + wider), moved)
    change = float(other.peak_pressure / plain.peak_pressure) - 1
    assert 0.01 * float(plain.peak_by_clearance) == pytest.approx(change, abs=0.01)


def test_the_load_line_divides_the_force_and_not_the_peak(free_pin):
    motion = move(free_pin, 1e-8 * NOISE)
    by_trigger = {f.name for f in fields(motion)} - {"noise_scale", *ONCE}
    one = {name: getattr(motion, name)[:1] for name in by_trigger}
    found = find_pressures(
        JOINT,
        PinMotion(**one, noise_scale=motion.noise_scale),
        viscosity=np.array([0.12]),
        place=PLACE,
        axial=np.zeros(1),
        load_line_std=1e-3,
        cells=(192, 24),
    )
    force = 1e-3 / JOINT.radius * found.load_from_pressure  # of a small angle
    assert float(found.side_from_pressure_std[0]) == pytest.approx(float(force[0]), rel=0.02)
    share = found.peak_pressure_std / found.peak_pressure  # of the cells alone
    assert float(share[0]) == pytest.approx(0.005 * (384 / 192) ** 2, rel=0.01)
