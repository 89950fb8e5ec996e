"""Powers of the duty parameter of runs whose film follows one."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest

from erlif.review.comparison.exponent import duty_parameters, fit_runs


def with_film(record, film, **changes):
    value = dict.fromkeys(record.value, film)
    return replace(record, value=value, **changes)


def test_runs_of_one_law_at_two_loads_have_one_power(record):
    """0.6 of viscosity times speed over load, whatever the load of a run."""
    runs = []
    for load in (111.0, 222.0):
        duty = record.viscosity * record.speed / load
        runs.append(with_film(record, 800 * duty**0.6, load=np.full(6, load)))
    duties, unit, _ = duty_parameters(runs)
    assert unit == "Pa s rad s-1 N-1"
    for name in ("film_min", "film_mean"):
        fits = fit_runs(runs, duties, name)
        npt.assert_allclose([one.value for one in fits], 0.6, atol=2e-3)
        assert fits[-1].triggers == sum(one.triggers for one in fits[:-1])
        assert np.exp(fits[-1].log_scale) == pytest.approx(800, rel=0.02)


def test_without_a_viscosity_the_duty_parameter_is_speed_over_load(record):
    values, unit, meaning = duty_parameters([record, replace(record, viscosity=None)])
    npt.assert_allclose(values[0], record.speed / record.load)
    assert (unit, meaning) == ("rad s-1 N-1", "|rocker_speed| over load")
    assert duty_parameters([record, replace(record, load=None)])[0] == []
    assert duty_parameters([record, replace(record, speed_name="")])[0] == []


def test_triggers_without_speed_or_load_are_left_out(record):
    nothing = np.arange(6) != 2
    speed = np.where(nothing, record.speed, np.nan)
    without = replace(record, speed=speed)
    duties, *_ = duty_parameters([record, without])
    one, other, joint = fit_runs([record, without], duties, "film_min")
    assert (one.triggers, other.triggers, joint.triggers) == (6, 5, 11)
    npt.assert_allclose([other.value, joint.value], 0.6, atol=1e-6)

    for nothing in ({"speed": np.zeros(6)}, {"load": np.zeros(6)}):
        still = replace(record, **nothing)
        duties, *_ = duty_parameters([record, still])
        fits = fit_runs([record, still], duties, "film_min")
        assert np.isnan(fits[1].value)
        assert fits[2].triggers == 6


def test_the_error_of_a_calibration_is_that_of_all_its_runs(record):
    """Two runs determine the power no better than one where the shared error dominates."""
    duties, *_ = duty_parameters([record, record])
    quiet = replace(record, own_std={name: np.full(6, 1e-5) for name in record.value})
    one, _, joint = fit_runs([quiet, quiet], duties, "film_mean")
    apart = fit_runs([quiet, replace(quiet, calibration_key="b")], duties, "film_mean")[-1]
    assert apart.std < 0.8 * joint.std
    assert joint.std == pytest.approx(one.std, rel=0.3)
