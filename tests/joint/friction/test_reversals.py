"""Apparent friction of torque logs with reversals, against logs of known friction."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scipy.signal import lfilter

from erlif.core.errors import EnduranceError
from erlif.joint.friction import analyse_friction, describe_friction
from erlif.joint.friction.reversals import spread_of_line

RADIUS, LOAD = 0.005, 400.0
TIME = np.arange(0.0, 600.0, 0.1)


def make_log(
    rng, *, drift=0.0, offset=0.04, offset_drift=0.0, noise=0.01, slow=0.0, gain=1.0, interval=0.1
):
    """A reversal each 10 s, a ramp of 0.3 s at each, white noise, and friction that wanders."""
    time = np.arange(0.0, 600.0, interval)
    phase = (time % 20.0) / 10.0
    sense = np.clip(np.minimum(phase, 1 - phase) * 33, 0, 1) * (phase < 1)
    back = phase - 1
    sense -= np.clip(np.minimum(back, 1 - back) * 33, 0, 1) * (phase >= 1)
    true = 0.12 + drift * (time / time[-1] - 0.5)
    if slow > 0:
        kept = np.exp(-interval / 30.0)
        start = rng.normal()
        steps = np.sqrt(1 - kept**2) * rng.normal(size=time.size)
        true = true + slow * lfilter([1], [1, -kept], steps, zi=[kept * start])[0]
    ratio = sense * true + offset + offset_drift * (time / time[-1] - 0.5)
    ratio = ratio + noise * rng.normal(size=time.size)
    cells = np.array([np.full(time.size, 0.6 * LOAD), np.full(time.size, 0.8 * LOAD)])
    return xr.Dataset(
        {"cells": (("cell", "time"), cells), "torque": ("time", gain * ratio * LOAD * RADIUS)},
        {"time": time},
    )


def analysed(log=None, seed=0, *, torque=None, speed=None, torque_std=0.0, **log_options):
    """Friction of a log, by default one of `make_log`; a ratio of torques may replace its own."""
    log = make_log(np.random.default_rng(seed), **log_options) if log is None else log
    if torque is not None:
        log = log.assign(torque=("time", np.asarray(torque) * LOAD * RADIUS))
    given = {"speed": speed, "torque_std": torque_std}
    return analyse_friction(log, shaft_radius=RADIUS, vector=True, **given)


def test_friction_and_offset_are_found():
    found = analysed(noise=0.0, speed=0.01)
    npt.assert_allclose(found.pairs.friction, 0.12, rtol=1e-9)
    npt.assert_allclose(found.pairs.offset, 0.04, rtol=1e-9)
    npt.assert_allclose(found.pairs["load"], LOAD)
    assert found.pairs.sizes["time"] == 30
    npt.assert_allclose(found.pairs.sliding_distance[0], 0.1, rtol=0.02)


def test_intervals_cover_friction_that_wanders_over_several_pairs():
    """Mean and trend of 30 logs, gain of the torque 1 %; bounds of a binomial share."""
    rng = np.random.default_rng(5)
    size, inside = 30, []
    for _ in range(size):
        log = make_log(rng, slow=0.004, drift=0.01, gain=1 + 0.01 * rng.normal(), interval=1.0)
        found = analysed(log, torque_std=0.01)
        mean, trend = abs(found.friction - 0.12), abs(found.trend - 0.01 * 29 / 30)
        inside.append(
            [
                mean < found.friction_std,
                trend < found.trend_std,
                mean < found.friction_interval[1] - found.friction,
                trend < found.trend_interval[1] - found.trend,
            ]
        )
    for share, held in zip((0.683, 0.683, 0.95, 0.95), np.mean(inside, axis=0), strict=True):
        assert abs(held - share) < 3 * np.sqrt(share * (1 - share) / size)


@pytest.mark.parametrize("memory", [0.0, 1.0, 10.0, 30.0, 50.0, 100.0])
def test_intervals_hold_their_share_at_any_correlation(memory):
    """Means and changes of 30 pairs of 20 s; three standard deviations of a binomial share."""
    rng = np.random.default_rng(9)
    size, time = 300, 20.0 * np.arange(30)
    kept = np.exp(-1 / memory) if memory else 0.0
    start = kept * rng.normal(size=(size, 1))
    steps = np.sqrt(1 - kept**2) * rng.normal(size=(size, 600))
    wander = lfilter([1], [1, -kept], steps, axis=1, zi=start)[0]
    series = wander.reshape(size, 30, 20).mean(axis=2) + 0.2 * rng.normal(size=(size, 30))
    away = (time - time.mean()) / time[-1]
    inside = []
    for values in series:
        mean, change = spread_of_line(time, values)
        trend = away @ values / (away @ away)
        errors = np.abs([values.mean(), trend, values.mean(), trend])
        inside.append(errors < [mean.std, change.std, mean.wide, change.wide])
    shares = np.array([0.683, 0.683, 0.95, 0.95])
    bounds = 3 * np.sqrt(shares * (1 - shares) / size)
    assert np.all(np.abs(np.mean(inside, axis=0) - shares) < bounds)


def test_a_log_too_short_for_its_correlation_says_so():
    """Friction that swings once in the log, against one that does not; and a log of six pairs."""
    swing = 0.02 * np.sin(2 * np.pi * TIME / 600.0)
    sense = np.where(TIME % 20.0 < 10.0, 1, -1)
    noise = 0.01 * np.random.default_rng(3).normal(size=TIME.size)
    wandering = analysed(torque=sense * (0.12 + swing) + noise)
    steady = analysed(torque=sense * 0.12 + noise)
    assert wandering.independent < 4 < 15 < steady.independent
    for found, told in ((wandering, True), (steady, False)):
        assert (
            any("hardly determines the mean" in line for line in describe_friction(found)) == told
        )
    short = analysed(make_log(np.random.default_rng(3)).sel(time=slice(0, 120)))
    assert any("fewer than 15 pairs" in line for line in describe_friction(short))


def test_a_torque_without_a_level_is_warned_of():
    """The means of eighths of the inner 80 to 86 % of a sine, their range over their mean."""
    noise = np.random.default_rng(4).normal(size=TIME.size)
    sine = analysed(torque=0.12 * np.sin(2 * np.pi * TIME / 20) + 0.01 * noise)
    assert any("the torque varies by" in line for line in describe_friction(sine))
    bounds = []
    for cut in (0.1, 0.07):
        ends = np.pi * np.linspace(cut, 1 - cut, 9)
        course = -np.diff(np.cos(ends)) / np.diff(ends)
        bounds.append(np.ptp(course) / course.mean())
    assert bounds[0] < sine.variation < 1.05 * bounds[1]
    for scatter in (0.0, 0.01, 0.05):
        square = analysed(torque=0.12 * np.where(TIME % 20 < 10, 1, -1) + scatter * noise)
        assert not any("varies by" in line for line in describe_friction(square))


def test_the_std_has_two_digits_and_both_sizes_of_the_shaft_are_stated():
    first, _, shaft, *_ = describe_friction(analysed(noise=0.001))
    mean, std = first.split(": ")[1].split(" (")[0].split(" ± ")
    assert len(std.lstrip("0.")) == 2
    assert len(mean) == len(std)
    assert shaft == "  shaft: radius 5 mm, diameter 10 mm"


@pytest.mark.parametrize("change", [-0.04, 0.04])
def test_an_offset_that_drifts_cancels(change):
    found = analysed(noise=0.0, offset_drift=change, drift=0.01)
    npt.assert_allclose(found.friction, 0.12, rtol=1e-4)
    npt.assert_allclose(found.trend, 0.01 * 29 / 30, rtol=2e-3)


def test_error_of_a_pair_is_that_of_its_noise():
    found = analysed(seed=2, noise=0.02)
    npt.assert_allclose(found.pairs.friction_std.median(), 0.02 / np.sqrt(2 * 80), rtol=0.15)
    npt.assert_allclose(found.pairs.friction.std(), 0.02 / np.sqrt(2 * 80), rtol=0.4)


def test_the_budget_adds_up():
    stds = {"torque_std": 0.01, "load_std": 0.02, "radius_std": 0.003}
    log = make_log(np.random.default_rng(2))
    found = analyse_friction(log, shaft_radius=RADIUS, vector=True, **stds)
    assert list(found.budget) == ["scatter", "torque", "load", "shaft radius"]
    npt.assert_allclose(found.friction_std, np.linalg.norm(list(found.budget.values())))
    npt.assert_allclose(found.budget["load"], 0.02 * found.friction)


def test_a_torque_without_its_sign_is_pointed_out():
    """The size of the torque, as some instruments log it, or an offset above the friction."""
    log = make_log(np.random.default_rng(0), offset=0.0)
    above = make_log(np.random.default_rng(0), offset=0.2)
    npt.assert_allclose(analysed(above).friction, 0.12, rtol=0.01)
    for one, told in ((log, False), (log.assign(torque=abs(log.torque)), True), (above, True)):
        lines = describe_friction(analysed(one))
        assert any("torque with its sign" in line for line in lines) == told


@pytest.mark.parametrize("kept", [0.0, 0.5])
@pytest.mark.parametrize("share", [0.15, 0.4])
def test_dwell_at_the_reversals_is_left_out(share, kept):
    """The motor rests for a share of each stretch; the torque keeps a part of its size."""
    rng = np.random.default_rng(7)
    time = np.arange(0.0, 600.0, 0.1)
    rests = time % 10.0 >= 10.0 * (1 - share)
    ratio = 0.12 * np.where(time % 20.0 < 10.0, 1, -1) * np.where(rests, kept, 1.0)
    noisy = ratio + 0.02 + 0.01 * rng.normal(size=time.size)
    found = analysed(torque=noisy, speed=0.01)
    assert found.friction == pytest.approx(0.12, abs=4 * found.friction_std)
    assert found.friction_std < 0.001
    assert float(found.pairs.dwell.median()) == pytest.approx(20 * share, abs=0.3)
    assert f"dwell left out: {10 * share:.3g} s" in "\n".join(describe_friction(found))
    # 59 of 60 stretches lie before the middle of the last pair
    travelled = 0.01 * 590 * (1 - share)
    assert float(found.pairs.sliding_distance[-1]) == pytest.approx(travelled, rel=0.01)


def test_a_torque_that_follows_a_smooth_speed_has_no_dwell():
    found = analysed(torque=0.12 * np.sin(2 * np.pi * TIME / 20))
    assert float(found.pairs.dwell.max()) == 0
    # mean of a sine over the middle 80 % of half a period
    npt.assert_allclose(found.friction, 0.12 * np.cos(0.1 * np.pi) / (0.4 * np.pi), rtol=0.01)


def test_a_short_return_stroke_counts():
    """Fifty seconds forward and two back: 4 % of the log."""
    found = analysed(torque=0.12 * np.where(TIME % 52 < 50, 1, -1) + 0.02)
    npt.assert_allclose(found.friction, 0.12, rtol=1e-9)
    npt.assert_allclose(found.pairs.offset, 0.02, rtol=1e-9)


def test_friction_that_falls_to_a_seventh_is_followed():
    found = analysed(torque=0.2 * np.exp(-TIME / 300) * np.where(TIME % 20 < 10, 1, -1))
    assert found.pairs.sizes["time"] == 30
    npt.assert_allclose(found.pairs.friction, 0.2 * np.exp(-found.pairs.time / 300), rtol=0.02)


def noise(kept):
    """White or correlated noise."""
    return 0.01 * lfilter([1], [1, -kept], np.random.default_rng(1).normal(size=TIME.size))


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"torque": np.ones(6000)}, "reverses at least three times"),
        ({"torque": np.full(6000, np.nan)}, "reverses at least three times"),
        # about zero and about the torque of one direction
        ({"torque": noise(0.0)}, "as noise does"),
        ({"torque": 0.12 + noise(0.9)}, "as noise does"),
        ({"cells": np.where((TIME > 100) & (TIME < 110), 0.0, LOAD)}, "load above 0"),
    ],
    ids=["constant", "missing", "white noise", "noise about a level", "unloaded"],
)
def test_logs_without_friction_are_refused(columns, message):
    log = make_log(np.random.default_rng(0))
    for name, values in columns.items():
        log[name] = log[name] * 0 + xr.DataArray(values, {"time": TIME})
    with pytest.raises(EnduranceError, match=message):
        analysed(log)


def test_a_force_needs_its_arm():
    log = make_log(np.random.default_rng(0)).rename(torque="arm_force")
    with pytest.raises(EnduranceError, match="--arm"):
        analyse_friction(log, shaft_radius=RADIUS)
    found = analyse_friction(log, shaft_radius=RADIUS, arm=0.5, vector=True)
    npt.assert_allclose(found.friction, 0.06, rtol=0.01)


def make_series(rng, *, size, kept):
    """Stationary series of variance 1 whose neighbours have the correlation `kept`."""
    steps = np.sqrt(1 - kept**2) * rng.normal(size=size)
    return lfilter([1], [1, -kept], steps, zi=[kept * rng.normal()])[0]


@pytest.mark.parametrize(("size", "kept"), [(12, 0.5), (30, 0.5), (100, 0.8)])
def test_intervals_cover_correlated_series_of_several_lengths(size, kept):
    """80 series: never less than a binomial share allows, nor half as wide again as the errors."""
    rng = np.random.default_rng(8)
    time = np.arange(size, dtype=float)
    away = time - time.mean()
    errors, widths = [], []
    for _ in range(80):
        values = make_series(rng, size=size, kept=kept) + away / size
        change = away @ values / (away @ away) * (size - 1)
        errors.append([values.mean(), change - (size - 1) / size])
        widths.append([[one.std, one.wide] for one in spread_of_line(time, values)])
    errors, widths = np.array(errors), np.array(widths)
    held = np.mean(abs(errors)[..., None] < widths, axis=0)
    for share, both in zip((0.683, 0.95), held.T, strict=True):
        assert np.all(both > share - 3 * np.sqrt(share * (1 - share) / 80))
    assert np.all(np.median(widths[..., 0], axis=0) < 1.5 * errors.std(axis=0))


def test_many_values_without_correlation_have_the_standard_error():
    """In the mean of 60 series; Student's factor and what they leave open of a correlation add."""
    rng, time = np.random.default_rng(2), np.arange(2000.0)
    found = [spread_of_line(time, rng.normal(size=2000)) for _ in range(60)]
    for size, ofs in zip((2000**-0.5, (12 / 2000) ** 0.5), zip(*found, strict=True), strict=True):
        assert 1.0 < np.mean([one.std for one in ofs]) / size < 1.2
        assert 1.0 < np.mean([one.wide for one in ofs]) / (1.96 * size) < 1.3


def test_two_values_have_students_factor():
    """Without correlation: one degree of freedom, tan(0.683 pi/2) times the standard error."""
    mean, change = spread_of_line(np.array([0.0, 1.0]), np.array([1.0, 3.0]))
    assert mean.std > np.tan(0.682689 * np.pi / 2)
    assert np.isnan(change.std)
    assert np.isnan(change.wide)
