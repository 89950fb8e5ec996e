"""Drift between two calibrations: found where K, p or q changed, by chance as rarely as stated."""

import re
from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.fixture import (
    K,
    Q,
    autoregression,
    calibrate_wedge,
    log_ratio,
    wedge_profile,
    with_systematics,
)
from scenes.terminal import unwrapped
from scipy.stats import binom, norm

import erlif
from erlif.calibration import Calibration, compare_calibrations
from erlif.core.errors import CalibrationError


def pair(rng, *, shared, **later):
    """One fixture photographed twice, with the same CMM readings or new ones."""
    profile = wedge_profile(rng)
    earlier = calibrate_wedge(rng, profile=profile)
    return calibrate_wedge(rng, profile=profile if shared else None, **later), earlier


@pytest.mark.parametrize("shared", [False, True])
@pytest.mark.parametrize(("later", "bends"), [({"k": 1.01 * K}, False), ({"q": 1.03 * Q}, True)])
def test_changed_parameters_are_found_and_distinguished(shared, later, bends):
    rng = np.random.default_rng(2)
    for _ in range(3):
        found = compare_calibrations(*pair(rng, shared=shared, **later))
        assert found.drifted
        assert found.bends == bends
        assert ("p or q changed" if bends else "K changed") in found.verdict
        assert found.verdict.startswith("drifted")
        stated = re.findall(r"([+-][\d.]+) um at ([\d.]+) um", found.verdict)
        assert [float(at) for _, at in stated] == [1, 3, 8]
        changes = np.interp([1, 3, 8], found.thickness, found.film_change)
        npt.assert_allclose([float(change) for change, _ in stated], changes, atol=6e-4)
        true = log_ratio(found.thickness, **later) - log_ratio(found.thickness)
        assert np.all(np.abs(found.difference - true) < 5 * found.difference_std)
        middle = np.searchsorted(found.thickness, 5.0)
        # the same ratio gives 5 um by the earlier curve and another film by the later one
        film = found.thickness[middle]
        grid = np.linspace(2, 9, 20001)
        now = np.interp(log_ratio(film), log_ratio(grid, **later), grid)
        npt.assert_allclose(
            found.film_change[middle], now - film, atol=0.05 * abs(now - film) + 0.05
        )


def test_the_same_cmm_readings_make_the_check_sharper():
    """The noise of the photographs is a tenth of the CMM's share of the error.

    A change of K by 0.05 % is found only with shared readings.
    """
    rng = np.random.default_rng(3)
    apart, together = (compare_calibrations(*pair(rng, shared=shared)) for shared in (False, True))
    assert together.same_profile
    assert not apart.same_profile
    film = np.searchsorted(apart.thickness, 3.0)
    assert together.difference_std[film] < apart.difference_std[film] / 3
    seen = compare_calibrations(*pair(rng, shared=True, k=1.0005 * K))
    assert seen.drifted
    uncertain = replace(seen, own_std=10 * seen.own_std)
    assert uncertain.significant
    assert not uncertain.drifted
    assert "measurably" in uncertain.verdict


def test_position_and_size_of_one_fixture_are_no_drift():
    """Known to 0.05 um and 0.5 %, in both calibrations alike."""
    calibration, earlier = pair(np.random.default_rng(9), shared=True)
    both = [
        with_systematics(each, position=0.05, size=0.005).calibration
        for each in (calibration, earlier)
    ]
    found, expected = compare_calibrations(*both), compare_calibrations(calibration, earlier)
    assert found.paired
    assert found.probability == expected.probability
    npt.assert_array_equal(found.difference_std, expected.difference_std)


def test_correlated_noise_is_no_drift_and_hides_none():
    """Noise of 0.1 % whose neighbours are correlated by 0.8, on the readings of one fixture.

    The variance of its mean is (1 + r)/(1 - r) = 9 times that of independent noise. Without this
    factor most of the changes by chance are significant at 1 %; with one degree of freedom a
    change of K by 1 % is not.
    """
    rng = np.random.default_rng(7)
    earlier = calibrate_wedge(rng)
    count = earlier.curve.curve_ratio.size
    noise = [np.exp(1e-3 * autoregression(rng, 0.8, count)) for _ in range(40)]

    def compare(factor):
        curve = earlier.curve.assign(curve_ratio=earlier.curve.curve_ratio * factor)
        return compare_calibrations(replace(earlier, curve=curve), earlier)

    by_chance = [compare(factor) for factor in noise]
    assert all(each.paired for each in by_chance)
    assert sum(each.significant for each in by_chance) <= binom.ppf(0.999, 40, 0.05)
    assert all(compare(1.01 * factor).probability < 1e-6 for factor in noise[:8])
    assert not any(compare(1.01 * factor).bends for factor in noise[:5])


def test_departures_are_compared_too():
    rng = np.random.default_rng(5)
    earlier, same, other = (
        calibrate_wedge(rng, noise=0.05, background=background)
        for background in (0.01, 0.01, 0.012)
    )
    assert earlier.departure is not None
    assert not compare_calibrations(same, earlier).drifted
    assert compare_calibrations(other, earlier).drifted


@pytest.mark.parametrize("factor", [1.5, 3.0, 20.0])
def test_points_that_changed_beyond_all_others_leave_finite_changes(factor):
    """A spline has pieces that rest on the thinnest points alone."""
    earlier = calibrate_wedge(np.random.default_rng(5), noise=0.05, background=0.012)
    thin = np.where(earlier.curve.curve_thickness < 1.5, factor, 1.0)
    curve = earlier.curve.assign(curve_ratio=earlier.curve.curve_ratio * thin)
    found = compare_calibrations(earlier, replace(earlier, curve=curve))
    assert np.abs(found.difference).max() < 2 * np.log(factor)
    npt.assert_allclose(found.difference[found.thickness > 4], 0, atol=0.02)


def test_calibrations_without_a_film_in_common_are_refused():
    calibration = calibrate_wedge(np.random.default_rng(6))
    with pytest.raises(CalibrationError, match="share a range"):
        compare_calibrations(replace(calibration, thickness_range=(40.0, 90.0)), calibration)
    with pytest.raises(CalibrationError, match="bands"):
        compare_calibrations(replace(calibration, bands=(560.0, 610.0)), calibration)


def test_calibrate_reports_drift_from_the_named_and_from_the_replaced_calibration(
    lab, command, tmp_path
):
    stored = erlif.open_calibration(lab.fixture / "calibration.nc")
    changed = {"ratio_at_zero": 0.98 * stored.ratio_at_zero}
    changed["curve"] = stored.curve.drop_vars("curve_x")
    other = erlif.save_calibration(replace(stored, **changed), tmp_path / "other.nc")
    output = unwrapped(command("calibrate", lab.fixture, "--overwrite", "--against", other).stdout)
    against, replaced = (
        next(line for line in output.splitlines() if line.startswith(start))
        for start in ("against " + str(other), "against the one replaced")
    )
    assert ": drifted from virtual wedge" in against
    assert ": not drifted from virtual wedge" in replaced


def test_a_calibration_of_other_bands_is_refused_before_the_work(
    lab, refused, monkeypatch, tmp_path
):
    """The refusal comes before the fixture is calibrated, not after."""
    stored = erlif.open_calibration(lab.fixture / "calibration.nc")
    other = erlif.save_calibration(replace(stored, bands=(560.0, 650.0)), tmp_path / "other.nc")
    monkeypatch.setattr(
        "erlif.pipeline.calibrate", lambda *_, **__: pytest.fail("the fixture was calibrated")
    )
    message = refused("calibrate", lab.fixture, "--overwrite", "--against", other)
    assert f"{other} is of 560 and 650 nm" in message
    assert "bands in fixture.toml" in message
    assert "of the run" not in message


def test_a_comparison_that_cannot_be_made_leaves_the_calibration_written(lab, command, tmp_path):
    stored = erlif.open_calibration(lab.fixture / "calibration.nc")
    other = erlif.save_calibration(
        replace(stored, thickness_range=(90.0, 120.0)), tmp_path / "other.nc"
    )
    written = tmp_path / "new.nc"
    output = unwrapped(command("calibrate", lab.fixture, "-o", written, "--against", other).stdout)
    (line,) = (line for line in output.splitlines() if line.startswith(f"against {other}"))
    assert "not compared" in line
    assert "share a range of films" in line
    assert f"written: {written}" in output
    npt.assert_array_equal(erlif.open_calibration(written).parameters, stored.parameters)


WEDGE_A = {"fixture.toml": "f", "wedge.csv": "a", "dark.tif": "d"}
WEDGE_B = WEDGE_A | {"wedge.csv": "b"}
GAP = {"fixture.toml": "f", "gap.dat": "g", "flat.txt": "t"}


def recorded(calibration, hashes=WEDGE_A, *, places=True, profile="wedge.csv"):
    """As the file of a fixture directory stores it; earlier versions lack the `places`."""
    curve = calibration.curve if places else calibration.curve.drop_vars("curve_x")
    return replace(calibration, curve=curve, input_hashes=hashes, profile_file=profile)


@pytest.mark.parametrize(
    ("new", "old", "same", "words"),
    [
        ({}, {}, True, "rest on the same CMM readings, whose error cancels"),
        ({"hashes": {}}, {"hashes": {}, "places": False}, None, "is not recorded; they were taken"),
        ({}, {"hashes": WEDGE_B, "places": False}, False, "the CMM readings differ"),
        ({}, {"places": False}, True, "CMM readings, but not on the same points of them"),
        # the name of the profile decides, whatever its suffix and whatever other tables exist
        ({"hashes": GAP, "profile": "gap.dat"}, {"hashes": GAP, "profile": "gap.dat"}, True, ""),
        (
            {"hashes": GAP, "profile": "gap.dat"},
            {"hashes": GAP | {"gap.dat": "h"}, "profile": "gap.dat"},
            False,
            "",
        ),
        ({"hashes": GAP, "profile": "gap.dat"}, {"hashes": GAP, "profile": "lost.csv"}, None, ""),
    ],
)
def test_readings_are_recognised_by_their_points_or_by_what_is_recorded(new, old, same, words):
    one, other = pair(np.random.default_rng(8), shared=True)
    if "profile" in new:
        new, old = new | {"places": False}, old | {"places": False}
    other = replace(other, curve=other.curve.assign(curve_x=other.curve.curve_x + 1e-9))
    found = compare_calibrations(recorded(one, **new), recorded(other, **old))
    assert found.same_profile is same
    assert words in found.verdict


def test_difference_of_known_curves_has_the_probability_of_chi_square():
    """Only K is uncertain: a change of ln K by z sqrt(2) s has the two-sided probability of z."""
    std = 0.01
    earlier = Calibration(
        K, 0.40, Q, np.diag([(K * std) ** 2, 0, 0]), (0.5, 10.0), (580.0, 610.0),
        xr.Dataset(), 1.0, "wedge",
    )  # fmt: skip
    for z in (0.5, 1.0, 2.5, 4.0):
        later = replace(
            earlier,
            ratio_at_zero=K * np.exp(z * np.sqrt(2) * std),
            covariance=earlier.covariance * np.exp(z * np.sqrt(2) * std) ** 2,
        )
        found = compare_calibrations(later, earlier)
        npt.assert_allclose(found.probability, 2 * norm.sf(z), rtol=1e-6)
        npt.assert_allclose(found.difference_std, np.sqrt(2) * std, rtol=1e-9)
        assert not found.bends


def test_a_change_that_rounds_to_nothing_has_no_numbers():
    one, _ = pair(np.random.default_rng(8), shared=True)
    verdict = compare_calibrations(one, one).verdict
    assert "measured films change by less than 1 nm" in verdict
    assert "-0.0" not in verdict
