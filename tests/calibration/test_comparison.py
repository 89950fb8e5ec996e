"""Drift between two calibrations: found where K, p or q changed, and by chance as seldom as is claimed."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import (
    PITCH,
    SHAPE,
    K,
    Q,
    calibrate,
    calibrate_wedge,
    image,
    log_ratio,
    wedge_profile,
)
from scipy.stats import binom

import erlif
from erlif.calibration import Profile, compare_calibrations
from erlif.core.errors import CalibrationError


def pair(rng, *, shared, **later):
    """One fixture photographed twice, with the CMM's readings of then or new ones."""
    profile = wedge_profile(rng)
    earlier = calibrate_wedge(rng, profile=profile)
    return calibrate_wedge(rng, profile=profile if shared else None, **later), earlier


@pytest.mark.slow
@pytest.mark.parametrize("shared", [False, True])
def test_false_alarms_are_as_seldom_as_claimed(shared):
    """A hundred fixtures photographed twice: one in a hundred is called significant, half have a probability below a half."""
    rng = np.random.default_rng(1)
    found = [compare_calibrations(*pair(rng, shared=shared)) for _ in range(100)]
    assert sum(each.significant for each in found) <= binom.ppf(0.999, 100, 0.01)
    assert sum(each.drifted for each in found) <= 5
    below = sum(each.probability < 0.5 for each in found)
    assert abs(below - 50) < 3.3 * 5
    pulls = np.array([(each.difference / each.difference_std)[[10, 30, 50]] for each in found])
    npt.assert_allclose(pulls.std(axis=0), 1, atol=0.25)


@pytest.mark.parametrize("shared", [False, True])
@pytest.mark.parametrize(("later", "bends"), [({"k": 1.01 * K}, False), ({"q": 1.03 * Q}, True)])
def test_changed_parameters_are_found_and_told_apart(shared, later, bends):
    rng = np.random.default_rng(2)
    for _ in range(5):
        found = compare_calibrations(*pair(rng, shared=shared, **later))
        assert found.drifted
        assert found.bends == bends
        assert ("p or q changed" if bends else "K changed") in found.verdict
        assert found.verdict.startswith("drifted")
        true = log_ratio(found.thickness, **later) - log_ratio(found.thickness)
        assert np.all(np.abs(found.difference - true) < 5 * found.difference_std)
        middle = np.searchsorted(found.thickness, 5.0)
        # the same ratio read twice: by then's curve 5 um, by now's the film that has this ratio
        film = found.thickness[middle]
        grid = np.linspace(2, 9, 20001)
        now = np.interp(log_ratio(film), log_ratio(grid, **later), grid)
        npt.assert_allclose(
            found.film_change[middle], now - film, atol=0.05 * abs(now - film) + 0.05
        )


def test_the_same_cmm_readings_make_the_check_sharper():
    """The photographs' noise is a tenth of what the CMM's leaves, so a change of K by 0.05 % is seen at all only with shared readings."""
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


def test_a_calibration_has_not_drifted_from_itself():
    calibration = calibrate_wedge(np.random.default_rng(4))
    found = compare_calibrations(calibration, calibration)
    assert found.probability == 1
    assert not found.drifted
    npt.assert_array_equal(found.film_change, 0)


def test_departures_are_compared_too():
    rng = np.random.default_rng(5)
    earlier, same, other = (
        calibrate_wedge(rng, noise=0.05, background=background)
        for background in (0.01, 0.01, 0.012)
    )
    assert earlier.departure is not None
    assert not compare_calibrations(same, earlier).drifted
    assert compare_calibrations(other, earlier).drifted


def test_calibrations_without_a_film_in_common_are_refused():
    calibration = calibrate_wedge(np.random.default_rng(6))
    with pytest.raises(CalibrationError, match="share a range"):
        compare_calibrations(replace(calibration, thickness_range=(40.0, 90.0)), calibration)
    with pytest.raises(CalibrationError, match="bands"):
        compare_calibrations(replace(calibration, bands=(560.0, 610.0)), calibration)


def test_calibrate_says_whether_it_drifted_from_the_one_named_and_from_the_one_replaced(
    lab, command, tmp_path
):
    stored = erlif.open_calibration(lab.fixture / "calibration.nc")
    other = erlif.save_calibration(
        replace(
            stored,
            ratio_at_zero=0.98 * stored.ratio_at_zero,
            curve=stored.curve[["curve_thickness"]],
        ),
        tmp_path / "other.nc",
    )
    said = command("calibrate", lab.fixture, "--overwrite", "--against", other).stdout
    against, replaced = (
        next(line for line in said.splitlines() if line.startswith(start))
        for start in ("against " + str(other), "against the one replaced")
    )
    assert ": drifted from virtual wedge" in against
    assert ": not drifted from virtual wedge" in replaced


def test_a_calibration_to_compare_with_must_be_one(lab, refused):
    assert "does not exist" in refused(
        "calibrate", lab.fixture, "--overwrite", "--against", lab.fixture / "none.nc"
    )


def test_a_calibration_of_other_bands_is_refused_before_the_work(
    lab, refused, monkeypatch, tmp_path
):
    """Not only at the end of it, with everything thrown away."""
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
    said = command("calibrate", lab.fixture, "-o", written, "--against", other).stdout
    (line,) = (line for line in said.splitlines() if line.startswith(f"against {other}"))
    assert "not compared" in line
    assert "share a range of films" in line
    assert f"written: {written}" in said
    npt.assert_array_equal(erlif.open_calibration(written).parameters, stored.parameters)


def with_hash(calibration, digest, *, places=True):
    """As the file of a fixture directory keeps it; `places` are missing in those written before they were recorded."""
    curve = calibration.curve if places else calibration.curve.drop_vars("curve_x")
    return replace(
        calibration,
        curve=curve,
        input_hashes={"fixture.toml": "f", "wedge.csv": digest, "dark.tif": "d"},
    )


def test_readings_are_not_said_to_differ_where_that_is_not_known():
    calibration, earlier = pair(np.random.default_rng(7), shared=True)
    found = compare_calibrations(
        calibration, replace(earlier, curve=earlier.curve.drop_vars("curve_x"))
    )
    assert not found.same_profile
    assert (
        "whether both rest on the same CMM readings is not recorded; they were taken as independent"
        in found.verdict
    )
    assert "differ and" not in found.verdict
    found = compare_calibrations(with_hash(calibration, "a"), with_hash(earlier, "b", places=False))
    assert "the CMM readings differ" in found.verdict
    found = compare_calibrations(with_hash(calibration, "a"), with_hash(earlier, "a", places=False))
    assert (
        "both rest on the same CMM readings, but not on the same points of them; they were taken as independent"
        in found.verdict
    )
    apart = compare_calibrations(*pair(np.random.default_rng(7), shared=False))
    npt.assert_allclose(found.difference_std, apart.difference_std, rtol=0.5)


def test_readings_are_recognised_through_a_hash_and_to_rounding():
    calibration, earlier = pair(np.random.default_rng(8), shared=True)
    rounded = replace(earlier, curve=earlier.curve.assign(curve_x=earlier.curve.curve_x + 1e-9))
    for one, other in (
        (calibration, rounded),
        (with_hash(calibration, "a"), with_hash(rounded, "a")),
    ):
        found = compare_calibrations(one, other)
        assert found.same_profile
        assert "both rest on the same CMM readings, whose error cancels" in found.verdict


def test_a_dense_profile_is_thinned_alike_wherever_each_photograph_was_laid():
    """Two photographs of a wavy ramp, laid on its profile anew: their pitches come out differently, the readings are the same."""
    rng = np.random.default_rng(9)

    def wave(x):
        return 9 + 0.4 * (x - 9) + 2.5 * np.sin(x)

    x = np.arange(0, SHAPE[1] * PITCH, 0.02)
    profile = Profile(x, wave(x) + rng.normal(0, 0.05, x.size), np.full(x.size, 0.05))
    ratio = log_ratio(wave(PITCH * np.arange(SHAPE[1])))
    one, other = (calibrate(image(rng, ratio, noise=0.01), profile, align=True) for _ in range(2))
    assert one.pose.pose.pixel_pitch != other.pose.pose.pixel_pitch
    assert compare_calibrations(one, other).same_profile
