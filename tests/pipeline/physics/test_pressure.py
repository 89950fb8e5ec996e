"""The pressure of a film: of the virtual rig's own pin, and of films that have none."""

import importlib
import re
from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest
import xarray as xr
from scenes.film import with_settings
from scenes.kept import kept_orbit, name_of

import erlif
from erlif.core.errors import ConfigError, ErlifError, ModelError
from erlif.pipeline.physics.pressure import pressure_from_film, state_balance, weigh_loads
from erlif.prediction import pressure
from erlif.rig.film import crank_at, cycle_time, rocker_speed
from erlif.rig.journal import follow_pin
from erlif.rig.settings import RigSettings
from erlif.show.plots import example_film

RIG = RigSettings(film="reynolds", tilt=0.0, load_swing=0.0)
RANDOM = np.diag([4.5e-3, 4.7e-2, 1.4e-3, 1.5e-2]) ** 2  # um, um/mm
SHARED = np.diag([5e-3, 3e-2, 1e-4, 1e-3]) ** 2


@cache
def _follow(count, changes):
    """Displacement of the pin over a cycle [um]; each orbit is followed once."""
    rig = replace(RIG, **dict(changes))
    follow = partial(follow_pin, np.arange(count) * cycle_time(rig) / count, rig)
    # cavities take seconds
    guided = rig.sideways == "guided"
    return 1e6 * (kept_orbit(f"{name_of(rig)}, {count} steps", follow) if guided else follow())


def make_film(count=10, noise=1.0, seed=0, **changes):
    """The film of a pin as the rig follows it, without maps."""
    example = example_film()
    rig = replace(RIG, **changes)
    rng = np.random.default_rng(seed)
    time = np.arange(count) * cycle_time(rig) / count
    crank = crank_at(time, rig)
    position = np.zeros((count, 4))
    position[:, :2] = _follow(count, tuple(changes.items()))
    random = noise**2 * RANDOM
    position += rng.multivariate_normal(np.zeros(4), random, count)
    position += rng.multivariate_normal(np.zeros(4), SHARED)
    cov = ("trigger", "parameter", "parameter_other")
    speed = np.asarray(rocker_speed(crank, rig))
    return xr.Dataset(
        {
            "pin_displacement": (("trigger", "axis"), position[:, :2]),
            "pin_tilt": (("trigger", "axis"), position[:, 2:]),
            "pin_position_cov": (cov, np.tile(random + SHARED, (count, 1, 1))),
            "pin_position_cov_random": (cov, np.tile(random, (count, 1, 1))),
            "pin_position_gradient": (
                ("trigger", "parameter", "calibration_parameter"),
                np.zeros((count, 4, 3)),
            ),
            "crank_angle": ("trigger", np.degrees(crank) % 360),
            "encoder_angle": ("trigger", np.zeros(count)),
            "stroke": ("trigger", np.sign(speed)),
            "joint_load": ("trigger", np.full(count, rig.load)),
        },
        {"trigger": np.arange(count), "x": example.x, "y": example.y},
        example.attrs,
    )


@pytest.fixture(scope="module")
def found():
    return erlif.pressure_from_film(make_film())


def test_the_pressure_carries_the_load_of_the_rig(found):
    """Films of 6 um under 222 N; a long film under pure squeeze has a peak of 79 kPa."""
    assert found.pressure_measured.values.all()
    off = (found.load_from_pressure - 222.411) / found.load_from_pressure_std
    assert np.abs(off).max() < 3.5
    assert float((found.peak_pressure / found.peak_of_load).median()) == pytest.approx(1, abs=0.1)
    assert "measured at 10 of 10 triggers" in found.attrs["statement"]
    assert "forbids" not in found.attrs["statement"]
    assert "the load is balanced" in found.attrs["balance"]


def test_the_map_lies_on_the_image_and_has_its_peak_where_it_is_named(found):
    assert found.pressure.dims == ("trigger", "y", "x")
    assert found.pressure.attrs["units"] == "kPa"
    middle = found.pressure.isel(y=found.sizes["y"] // 2)
    place = found.x.values[middle.values.argmax(axis=1)]
    np.testing.assert_allclose(place, found.peak_place, atol=0.3)  # the grid is 0.34 mm apart


def test_the_rate_of_the_film_is_that_of_the_rig(found):
    """The free pin swings past the load line, from which the film grows and falls with it."""
    start = np.arange(10) * cycle_time(RIG) / 10
    moved = follow_pin(start + 1e-4, RIG) - follow_pin(start, RIG)
    off = (found.film_rate + 1e6 * moved[:, 0] / 1e-4) / found.film_rate_std
    assert np.abs(off).max() < 3.5


def test_an_image_turned_by_a_quarter_has_the_same_pressure(found):
    film = make_film()
    turned = film.drop_vars(["x", "y"]).assign_coords(x=film.y.values, y=film.x.values)
    turned = with_settings(turned, ('x_axis = "sliding"', 'x_axis = "axial"'))
    other = pressure_from_film(turned)
    np.testing.assert_allclose(other.peak_pressure, found.peak_pressure)
    np.testing.assert_allclose(
        other.pressure.transpose("trigger", "x", "y").values, found.pressure.values
    )


def test_oil_of_another_viscosity_leaves_the_load_unbalanced():
    """The load that a film of given motion carries is proportional to the viscosity."""
    film = make_film()
    film = with_settings(film, ('viscosity = "0.12 Pa s"', 'viscosity = "0.24 Pa s"'))
    balance = pressure_from_film(film).attrs["balance"]
    assert "balanced" not in balance
    needed = [float(one) for one in re.findall(r"would have to be (\S+) times", balance)]
    assert needed == pytest.approx([2.0, 0.5], rel=0.08)  # load and viscosity; two of 4 %
    assert "the load or its unit" in balance
    assert "the viscosity of the oil in the gap" in balance
    assert "clearance and length in [joint]" in balance


def correlated(error, correlation):
    """Covariance of loads of one correlation."""
    same = correlation + (1 - correlation) * np.eye(len(error))
    return same * np.outer(error, error)


def state(load, error, mount="", correlation=1.0):
    """The balance of triggers of given loads under 200 N, each in newtons."""
    count = len(load)
    settings = example_film().attrs["settings"].split("[prediction]")[0] + mount
    found = xr.Dataset(
        {
            "pressure_measured": ("trigger", np.ones(count)),
            "load_from_pressure": ("trigger", np.array(load, float)),
            "load_from_pressure_std": ("trigger", np.array(error, float)),
            "load_cov": (("trigger", "trigger_other"), correlated(error, correlation)),
            "joint_load": ("trigger", np.full(count, 200.0)),
        },
        attrs={
            "settings": settings,
            "settings_stated": "prediction.sideways" if mount else "run.name",
        },
    )
    return state_balance(found)


def share_found(off, correlation, count):
    """Share of recordings of 40 triggers, known to 4 %, whose load counts as not balanced."""
    cov = correlated(np.full(40, 0.04), correlation)
    ratios = np.random.default_rng(5).multivariate_normal(1 + off, cov, count)
    tests = [weigh_loads(ratio, cov) for ratio in ratios]
    return np.mean([one.shifted or one.differs or one.off.any() for one in tests])


@pytest.mark.parametrize("correlation", [0.0, 0.5, 0.99])
def test_a_balanced_load_is_called_so_in_19_of_20_recordings(correlation):
    """0.05, and twice its error."""
    assert share_found(np.zeros(40), correlation, 400) < 0.075


@pytest.mark.parametrize(
    ("off", "correlation"),
    [
        (np.full(40, 0.048), 0.0),  # all by 1.2 standard deviations, each of which looks harmless
        (np.full(40, 0.2), 0.99),  # all by five, with one common error
        (0.24 * (np.arange(40) == 7), 0.5),  # one by six
        (0.16 * np.linspace(-1, 1, 40), 0.5),  # a slope of four at the ends
    ],
)
def test_a_load_that_is_off_is_found(off, correlation):
    assert share_found(off, correlation, 100) > 0.9


@pytest.mark.parametrize("sign", [-1, 1])
def test_a_load_is_balanced_only_within_its_error_above_and_below(sign):
    even = np.tile([-1.0, 1.0], 20)
    assert "the load is balanced" in state(200 + even, np.full(40, 4.0))
    off = state(200 + sign * 10 + even, np.full(40, 4.0))  # 2.5 standard deviations at each
    assert "balanced" not in off
    assert f"carries {100 + sign * 5:.1f} ± 2.0 % of the load" in off


def test_one_trigger_of_a_wrong_load_is_named_however_small_its_error():
    """A negative load of a small error neither stands for the others nor counts as balanced."""
    load, error = np.full(40, 200.0), np.full(40, 8.0)
    load[6], error[6] = -212.0, 5.0
    text = state(load, error)
    assert "carries 100.0 ± 4.0 % of the load" in text
    assert "at 1 of 40 triggers (6)" in text
    assert "balanced" not in text
    assert "viscosity" not in text  # it changes all triggers alike


def test_the_mount_is_named_as_stated_or_as_assumed():
    load, error = np.full(9, 400.0), np.full(9, 5.0)
    assert "free sideways is assumed, as [prediction] states no mount" in state(load, error)
    stated = state(load, error, mount='[prediction]\nsideways = "guided"\n')
    assert "pin guided in [prediction]" in stated
    stated = state(load, error, mount='[prediction]\nsideways = "free"\n')
    assert "pin free sideways in [prediction]" in stated


def test_the_errors_of_viscosity_and_clearance_are_named_or_missed(found):
    film, plain = make_film(), found
    assert "viscosity_std in [oil] and clearance_std in [joint]" in plain.attrs["given"]
    assert "One per cent more viscosity changes the peak by +1 %" in plain.attrs["given"]
    oil, joint = '[oil]\nviscosity_std = "0.012 Pa s"', '[joint]\nclearance_std = "1 um"'
    known = pressure_from_film(with_settings(film, ("[oil]", oil), ("[joint]", joint)))
    assert known.attrs["given"].startswith(
        "The errors hold those of viscosity ± 0.012 Pa s ([oil]) and clearance ± 1 um ([joint])."
    )
    assert (known.peak_std_settings > 0.1 * known.peak_pressure * 0.99).all()
    assert (known.peak_pressure_std > plain.peak_pressure_std).all()


def upright(noise):
    """A film with noise in the displacement alone."""
    film = make_film(noise=noise)
    film["pin_tilt"] = 0 * film.pin_tilt
    for name in ("pin_position_cov", "pin_position_cov_random"):
        film[name][:, 2:, :] = 0.0
        film[name][:, :, 2:] = 0.0
        for k in (2, 3):
            film[name][:, k, k] = 1e-10
    return film


def test_noise_that_hides_the_rate_is_stated_with_the_light_it_needs(found):
    """The peak that 1/50 of the noise shows is hidden, and light brings it back."""
    result = pressure_from_film(upright(50.0))
    refused = result.pressure_measured.values == 0
    assert refused.any()
    assert np.isnan(result.pressure.values[refused]).all()
    assert (result.peak_pressure_std.values[refused] > 0.4 * found.peak_pressure[refused]).all()
    statement = result.attrs["statement"]
    assert "No pressure is known at" in statement

    # light brings the standard deviation to half the peak, and more light below it
    factor = float(re.search(r"It needs at least (\S+) times the light", statement)[1])
    lit, bright = (pressure_from_film(upright(50.0 / np.sqrt(n * factor))) for n in (1, 4))
    share = float((lit.peak_pressure_std / found.peak_pressure)[refused].median())
    assert share == pytest.approx(0.5, rel=0.25)
    assert bright.pressure_measured.values[refused].mean() > 0.5
    off = (bright.peak_pressure - found.peak_pressure) / bright.peak_pressure_std
    assert float(np.abs(off).max()) < 3.5
    assert "No pressure is known" not in found.attrs["statement"]


def test_a_tilt_that_closes_the_gap_outside_the_image_is_stated():
    film = make_film(count=6)
    film["pin_tilt"] = film.pin_tilt + 0.2  # um/mm: 24 um at the ends of the joint
    result = pressure_from_film(film)
    assert not result.pressure_measured.values.any()
    assert "closes within the error of its tilt" in result.attrs["statement"]
    assert result.attrs["balance"] == "No load to compare with."


def test_cavities_in_a_part_of_a_turn_are_stated():
    """A guided pin, whose film ruptures; the recording ends after half a stroke more than one."""
    film = make_film(count=12, sideways="guided", elapsed=1.5, load=2000.0)
    found = pressure_from_film(film.isel(trigger=slice(0, 7)))
    assert not found.pressure_measured.values.any()
    assert "no trigger was recorded over 5 % or more of a turn" in found.attrs["statement"]


@pytest.mark.slow
def test_a_gap_at_a_dead_point_is_crossed_by_the_motion_of_a_guided_pin(monkeypatch):
    """Triggers at marks of the rocker, which rests there, leave out a tenth of a turn."""
    module = importlib.import_module("erlif.pipeline.physics.pressure")
    find = module.find_pressures
    monkeypatch.setattr(module, "find_pressures", partial(find, cells=(96, 8)))
    film = make_film(count=40, sideways="guided", elapsed=6.0, load=2000.0)
    gap = film.isel(trigger=np.r_[0:16, 20:40]).assign_coords(trigger=np.arange(36))
    found = pressure_from_film(gap)
    assert found.pressure_measured.values.sum() >= 31
    pull = ((found.load_from_pressure - 2000.0) / found.load_from_pressure_std).values
    pull = np.abs(pull[np.isfinite(pull)])
    assert np.mean(pull < 1) > 0.6
    assert np.mean(pull < 1.96) > 0.9
    # which takes a load, and a gap of 15 % of a turn at most, on whatever cells
    monkeypatch.setattr(module, "find_pressures", partial(find, cells=(64, 4)))
    few = gap.isel(trigger=slice(None, None, 3))
    for other in (few.drop_vars("joint_load"), few.isel(trigger=slice(0, 9))):
        refused = pressure_from_film(other)
        assert not refused.pressure_measured.values.any()
        assert "no trigger was recorded over 5 % or more of a turn" in refused.attrs["statement"]
        assert "marks of the rocker" in refused.attrs["statement"]


def test_a_film_that_no_oil_follows_is_flagged(coarse_pressure):
    """It rises by its thickness in a turn: a turn before, pin and bushing overlap."""
    film = make_film(count=26)
    rising = 224.0 - np.linspace(0.0, 6.0, 26)
    film["pin_displacement"][:] = np.stack([rising, 0 * rising], axis=1)
    found = pressure_from_film(film)
    assert not found.pressure_solved.values.any()
    assert "At 26 triggers (0, 1, 2, 3, 4, 5, 6, 7, ...) no oil can follow" in found.statement


def test_a_trigger_without_a_solution_leaves_the_others_theirs(coarse_pressure, monkeypatch):
    film = make_film(count=7)
    solve, calls = pressure.solve_pin_motion, []

    def solve_all_but_one(journal, position, *others, **options):
        calls.append(position[0])
        if position[0] == calls[0]:
            raise ModelError("The pressure did not converge.")
        return solve(journal, position, *others, **options)

    monkeypatch.setattr(pressure, "solve_pin_motion", solve_all_but_one)
    found = pressure_from_film(film)
    assert found.pressure_solved.values.tolist() == [0, 1, 1, 1, 1, 1, 1]
    assert found.pressure_measured.values[1:].any()
    assert "At 1 triggers (0) no oil can follow" in found.statement


def test_triggers_without_a_position_have_no_pressure():
    film = make_film(count=7)
    film["pin_displacement"][3] = np.nan
    result = pressure_from_film(film)
    assert result.pressure_measured.values.tolist() == [1, 1, 1, 0, 1, 1, 1]
    assert np.isnan(result.peak_pressure.values[3])


def test_films_of_other_joints_are_refused(tmp_path):
    film = make_film()
    with pytest.raises(ConfigError, match="Expected the position of the pin in the film"):
        pressure_from_film(film.drop_vars("pin_displacement"))
    with pytest.raises(ModelError, match="5 or more triggers with a position of the pin, got 4"):
        pressure_from_film(make_film(count=4))
    with pytest.raises(ErlifError, match="does not exist"):
        pressure_from_film(tmp_path / "film.nc")


def test_a_film_at_rest_is_named_so_and_not_solved(monkeypatch):
    """At one place within its noise; its wedge would have cavities, of which a part is recorded."""
    film = make_film()
    noise = np.sqrt(np.diagonal(film.pin_position_cov_random.values, axis1=1, axis2=2))
    shaken = noise * np.random.default_rng(2).normal(size=noise.shape)
    film["pin_displacement"] = 0 * film.pin_displacement + [224.0, 0.0] + shaken[:, :2]
    monkeypatch.setattr("erlif.prediction.pressure.solve_pin_motion", None)
    result = pressure_from_film(film.isel(trigger=slice(7)))
    assert not result.pressure_measured.values.any()
    assert result.attrs["statement"].startswith("The film is at rest within its errors")
