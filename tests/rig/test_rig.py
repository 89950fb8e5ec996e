"""The virtual rig against published linkage numbers, independent integration and the statistics it promises."""

import ast
import csv
import hashlib
import tomllib
from pathlib import Path

import numpy as np
import numpy.testing as npt
import pytest
import tifffile
import xarray as xr
from scipy.integrate import dblquad, quad
from scipy.optimize import least_squares

import erlif.rig.run
from erlif.core.errors import ModelError, OutputError
from erlif.rig import RigSettings, simulate
from erlif.rig.camera import displacement, seen_from_camera_2
from erlif.rig.dyes import LASER, absorption, band_signal, emission, tabulate_signal, transmission
from erlif.rig.film import (
    Bubbles,
    Gap,
    crank_angle,
    draw_marks,
    list_triggers,
    rocker_angle,
    rocker_range,
    rocker_speed,
)
from erlif.rig.run import Shot, build_setup, photograph
from erlif.rig.scene import Grains, draw_grains, mix_grains, speckle

SMALL = RigSettings(
    width=96, height=80, fixture_frames=3, dead_pixels=1, dark_pages=16, flat_pages=8
)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """A small simulation on disk."""
    return simulate(tmp_path_factory.mktemp("rig") / "out", seed=5, rig=SMALL)


@pytest.fixture(scope="module")
def truth(written):
    with xr.open_dataset(written / "truth.nc", engine="h5netcdf") as file:
        return file.load()


def read_frames(directory: Path, number: int) -> np.ndarray:
    return np.stack(
        [tifffile.imread(path) for path in sorted((directory / f"camera{number}").glob("*.tif"))]
    )


# linkage: physics.md 1.3, the thesis's four-bar recomputed with two independent packages


def test_rocker_swings_between_its_dead_points():
    npt.assert_allclose(np.degrees(rocker_range(RigSettings())), [47.4095, 71.8355], atol=5e-5)
    crank = np.degrees(
        crank_angle(np.asarray(rocker_range(RigSettings())), np.array([True, True]), RigSettings())
    )
    npt.assert_allclose(crank, [209.83, 29.95], atol=0.02)


def test_greatest_rocker_speeds():
    speed = rocker_speed(np.linspace(0, 2 * np.pi, 72001), RigSettings())
    npt.assert_allclose([speed.max(), speed.min()], [2.552104, -2.540492], rtol=1e-6)


def test_four_bar_closes_and_speed_is_its_derivative():
    rig = RigSettings()
    crank = np.linspace(0, 2 * np.pi, 37)
    angle = rocker_angle(crank, rig)
    rocker_end = np.stack([rig.ground - rig.rocker * np.cos(angle), rig.rocker * np.sin(angle)])
    crank_end = rig.crank * np.stack([np.cos(crank), np.sin(crank)])
    npt.assert_allclose(np.hypot(*(rocker_end - crank_end)), rig.coupler, rtol=1e-13)
    rate = (
        (rocker_angle(crank + 1e-5, rig) - rocker_angle(crank - 1e-5, rig))
        / 2e-5
        * 114
        * 2
        * np.pi
        / 60
    )
    npt.assert_allclose(rocker_speed(crank, rig), rate, atol=1e-8)


def test_triggers_fill_one_cycle_every_096_degrees():
    triggers = list_triggers(RigSettings())
    assert triggers.reading.size == 50  # the thesis: 50 pictures per cycle
    npt.assert_allclose(
        np.diff(triggers.reading), np.repeat([0.96, 0, -0.96], [24, 1, 24]), atol=1e-12
    )
    npt.assert_allclose(
        np.degrees(rocker_angle(np.radians(triggers.crank_angle), RigSettings())),
        triggers.zero + triggers.reading,
        rtol=1e-12,
    )
    npt.assert_array_equal(np.sign(triggers.speed), np.repeat([1, -1], 25))
    assert np.all(np.diff(triggers.time) > 0)
    assert 0 < triggers.time[0] < triggers.time[-1] < 60 / 114
    crank_turned = np.diff(np.unwrap(np.radians(triggers.crank_angle)))
    npt.assert_allclose(crank_turned, np.diff(triggers.time) * 114 * 2 * np.pi / 60, rtol=1e-9)


def test_film_law_is_a_power_of_speed_over_load():
    triggers = list_triggers(RigSettings(exponent=0.7, load_swing=0.2))
    slope, intercept = np.polyfit(
        np.log(np.abs(triggers.speed) / triggers.load), np.log(triggers.film_min), 1
    )
    npt.assert_allclose(slope, 0.7, rtol=1e-9)
    npt.assert_allclose(np.exp(intercept) * (2.552104 / 222.411) ** 0.7, 6.0, rtol=1e-5)


def test_squeeze_keeps_a_floor_under_the_film():
    assert list_triggers(RigSettings(film_reference=0.6)).film_min.min() == 0.3


def test_film_can_be_given_by_a_table():
    table = tuple(np.linspace(2, 3, 50))
    npt.assert_array_equal(list_triggers(RigSettings(film_table=table)).film_min, table)
    with pytest.raises(ModelError, match="50 triggers, got 3"):
        list_triggers(RigSettings(film_table=(1.0, 2.0, 3.0)))


# gap: physics.md 5.5


def test_gap_has_the_curvature_of_a_rigid_joint():
    rig = RigSettings(tilt=0)
    gap = Gap(rig, 4.0, draw_marks(rig, np.random.default_rng(0)))
    middle = rig.centre[0] + rig.thin_line / rig.pitch
    x = middle + np.linspace(-10, 10, 20001)[None] / rig.pitch
    film = gap.smooth(x, np.zeros_like(x))[0]
    npt.assert_allclose(film.min(), 4.0, rtol=1e-9)
    npt.assert_allclose((film[0] + film[-1] - 2 * film[10000]) / 10**2, 0.2053, rtol=5e-4)  # um/mm2
    npt.assert_allclose(film.mean() - 4.0, 3.4, atol=0.03)  # w^2/(6 R) for w = 10 mm


def test_film_min_is_the_least_smooth_gap_in_the_region():
    rig = RigSettings(tilt=-0.5)
    gap = Gap(rig, 4.0, draw_marks(rig, np.random.default_rng(0)))
    (left, right), (top, bottom) = rig.region
    y, x = np.meshgrid(np.linspace(top, bottom, 101), np.linspace(left, right, 2001), indexing="ij")
    npt.assert_allclose(gap.smooth(x / rig.pitch, y / rig.pitch).min(), 4.0, atol=1e-5)


def test_marks_have_their_depth_and_run_along_sliding():
    rig = RigSettings(width=1000, height=1000, marks=0.1)
    y, x = np.indices((1000, 1000), dtype=float)
    waves_only = draw_marks(rig, np.random.default_rng(3))
    height = waves_only(x, y)
    assert 0.08 < height.std() < 0.13  # waves of 0.1 um rms, and scratches on top
    assert np.abs(np.diff(height, axis=1)).mean() < 0.3 * np.abs(np.diff(height, axis=0)).mean()


def test_film_never_closes():
    rig = RigSettings(marks=1.0)
    y, x = np.indices((256, 320), dtype=float)
    assert Gap(rig, 0.1, draw_marks(rig, np.random.default_rng(0)))(x, y).min() == 0.05


def test_bubble_empties_the_film_inside_only():
    x, y = np.arange(40.0)[None], np.full((1, 40), 10.0)
    film = Bubbles(np.array([20.0]), np.array([10.0]), np.array([5.0])).empty(
        np.full((1, 40), 6.0), x, y
    )[0]
    assert np.all(film[16:25] < 0.1)
    npt.assert_array_equal(film[[10, 13, 27, 35]], 6.0)


# dyes: physics.md 1.4


@pytest.mark.parametrize("band", [580.0, 610.0])
@pytest.mark.parametrize("thickness", [0.2, 5.0])
def test_band_signal_is_the_double_integral(band, thickness):
    def light(depth, wavelength):
        lost = (absorption(np.asarray(LASER)) + absorption(np.asarray(wavelength))) * depth
        return float(
            transmission(np.asarray(wavelength), band)
            * emission(np.asarray(wavelength))
            * np.exp(-lost)
        )

    whole = dblquad(light, band - 12, band + 12, 0, thickness, epsrel=1e-9)[0]
    npt.assert_allclose(band_signal(np.asarray(thickness), band), whole, rtol=1e-7)


@pytest.mark.parametrize("band", [580.0, 610.0])
def test_thin_and_thick_limits(band):
    def made(wavelength):
        return float(transmission(np.asarray(wavelength), band) * emission(np.asarray(wavelength)))

    def left(wavelength):
        return made(wavelength) / float(
            absorption(np.asarray(LASER)) + absorption(np.asarray(wavelength))
        )

    thin, thick = (quad(what, band - 12, band + 12, epsrel=1e-10)[0] for what in (made, left))
    npt.assert_allclose(band_signal(np.asarray(1e-6), band) / 1e-6, thin, rtol=1e-6)
    npt.assert_allclose(band_signal(np.asarray(200.0), band), thick, rtol=1e-9)


def test_table_of_the_signal_is_exact():
    thickness = np.random.default_rng(0).uniform(0, 60, 500)
    direct = band_signal(thickness, 580.0) / band_signal(np.asarray(200.0), 580.0)
    npt.assert_allclose(tabulate_signal(580.0)(thickness), direct, rtol=1e-9)


def test_filter_passes_ten_nanometres_at_half_height():
    npt.assert_allclose(
        transmission(np.array([575.0, 580.0, 585.0]), 580.0), [0.5, 1, 0.5], atol=1e-5
    )


def test_three_parameters_describe_the_ratio_of_the_bands():
    """The narrow-band law of physics.md 1.4b, p about 0.40 and q about 0.25 per um, good to 0.2 %."""
    t = np.geomspace(0.3, 15, 300)
    ratio = np.log(tabulate_signal(610.0)(t) / tabulate_signal(580.0)(t))

    def law(k, p, q):
        return np.log(k * p / q * np.expm1(-q * t) / np.expm1(-p * t))

    fit = least_squares(lambda v: law(*v) - ratio, [0.7, 0.4, 0.25], xtol=1e-12, ftol=1e-12)
    assert np.abs(fit.fun).max() < 2e-3
    npt.assert_allclose(fit.x[1:], [0.40, 0.25], rtol=0.05)


# light


def test_speckle_has_its_contrast_and_correlation():
    rig = RigSettings(width=400, height=400, speckle_fixed=0.06, speckle_new=0.08, speckle_size=0.8)
    grains = mix_grains(
        draw_grains(rig, 10, np.random.default_rng(1)), rig, np.random.default_rng(2)
    )
    y, x = np.indices((400, 400), dtype=float)
    field = speckle(x, y, grains, size=0.8, blur=0.0) - 1
    npt.assert_allclose(field.std(), np.hypot(0.06, 0.08), rtol=0.02)
    for lag in (1, 2):  # two Gaussian grains overlap like exp(-r^2/(4 s^2))
        npt.assert_allclose(
            np.mean(field[:, lag:] * field[:, :-lag]) / field.var(),
            np.exp(-(lag**2) / (4 * 0.8**2)),
            atol=0.015,
        )


def test_camera_sees_speckle_through_its_point_spread():
    rig = RigSettings(width=40, height=40)
    grains = mix_grains(
        draw_grains(rig, 10, np.random.default_rng(1)), rig, np.random.default_rng(2)
    )
    y, x = np.indices((40, 40)) + 0.37
    node, weight = np.polynomial.hermite_e.hermegauss(
        14
    )  # the point spread by Gauss-Hermite quadrature
    blurred = sum(
        wx * wy * speckle(x + 0.55 * nx, y + 0.55 * ny, grains, size=0.72, blur=0.0)
        for nx, wx in zip(node, weight, strict=True)
        for ny, wy in zip(node, weight, strict=True)
    )
    npt.assert_allclose(
        speckle(x, y, grains, size=0.72, blur=0.55), blurred / (2 * np.pi), atol=1e-4
    )


# cameras


def test_camera_2_looks_back_along_the_displacement():
    rig = RigSettings()
    y, x = np.indices((256, 320), dtype=float)
    object_x, object_y = seen_from_camera_2(x, y, (0.3, -0.2), rig)
    dx, dy = displacement(object_x, object_y, rig)
    npt.assert_allclose(object_x + dx + 0.3, x, atol=1e-10, rtol=0)
    npt.assert_allclose(object_y + dy - 0.2, y, atol=1e-10, rtol=0)


def test_displacement_is_shift_scale_rotation_and_half_a_pixel_of_distortion():
    rig = RigSettings(distortion=0.0)
    corner_x, corner_y = np.array([[0.0, 319.0]]), np.array([[0.0, 255.0]])
    dx, dy = displacement(corner_x, corner_y, rig)
    away = np.stack([corner_x[0] - 159.5, corner_y[0] - 127.5])
    turn = np.array(
        [
            [np.cos(np.radians(0.4)), -np.sin(np.radians(0.4))],
            [np.sin(np.radians(0.4)), np.cos(np.radians(0.4))],
        ]
    )
    expected = np.diag([1.004, 0.997]) @ turn @ away - away + np.array([[4.0], [-3.0]])
    npt.assert_allclose([dx[0], dy[0]], expected, atol=1e-12)
    bent_x, bent_y = displacement(corner_x, corner_y, RigSettings(distortion=0.5))
    assert np.all(np.hypot(bent_x - dx, bent_y - dy) > 0.3)
    assert np.all(np.hypot(bent_x - dx, bent_y - dy) < 0.7)


def test_one_bright_grain_appears_displaced_in_camera_2():
    rig = RigSettings(
        width=96, height=80, bubbles=0, speckle_size=2.0, dust=0, response_spread=0, hot_fraction=0
    )
    setup = build_setup(0, rig)
    brightness = np.zeros_like(setup.grains.brightness)
    margin = setup.grains.margin
    dark = Grains(setup.grains.x, setup.grains.y, brightness.copy(), margin)
    brightness[margin + 25, margin + 60] = 4.0
    bright = Grains(setup.grains.x, setup.grains.y, brightness, margin)
    at_x, at_y = setup.grains.x[margin + 25, margin + 60], setup.grains.y[margin + 25, margin + 60]
    drift = (0.4, -0.7)
    no_bubbles = Bubbles(*np.empty((3, 0)))
    with_grain, without = (
        photograph(
            setup,
            Shot(lambda x, y: np.full(x.shape, 6.0), no_bubbles, grains, 1.0, drift),
            np.random.default_rng(1),
        )
        for grains in (bright, dark)
    )
    y, x = np.indices((80, 96))
    near = np.hypot(x - at_x, y - at_y) < 14
    found = []
    for number in (0, 1):
        light = with_grain[number].astype(float) - without[number]
        light = np.where(near & (light > 0.1 * light.max()), light, 0)
        found.append(((x * light).sum() / light.sum(), (y * light).sum() / light.sum()))
    npt.assert_allclose(found[0], (at_x, at_y), atol=0.08)
    dx, dy = displacement(np.array([[at_x]]), np.array([[at_y]]), rig)
    npt.assert_allclose(
        np.subtract(found[1], found[0]), (dx[0, 0] + drift[0], dy[0, 0] + drift[1]), atol=0.12
    )


def test_noise_is_shot_and_read_noise(written):
    """Photon transfer (EMVA 1288): variance in time against signal has slope 1/gain and starts at the dark variance."""
    for session in ("run", "fixture"):
        for number in (1, 2):
            dark = tifffile.imread(written / session / f"camera{number}_dark.tif").astype(float)
            flat = tifffile.imread(written / session / f"camera{number}_flat.tif").astype(float)
            assert dark.shape == (16, 80, 96)
            assert flat.shape == (24, 80, 96)
            still = dark.mean(axis=0) < 90  # not hot
            assert 0.9994 < 1 - (~still).mean() <= 1 - 4e-4
            npt.assert_allclose(
                dark[:, still].var(axis=0, ddof=1).mean(), (9 / 4.4) ** 2 + 1 / 12, rtol=0.02
            )
            levels = flat.reshape(3, 8, 80, 96)
            signal = [level[:, still].mean() - dark[:, still].mean() for level in levels]
            variance = [level[:, still].var(axis=0, ddof=1).mean() for level in levels]
            slope = np.polyfit(signal, variance, 1)[0]
            npt.assert_allclose(1 / slope, 4.4, rtol=0.03)


def test_frames_are_twelve_bits_and_nearly_unsaturated(written):
    for session in ("run", "fixture"):
        for number in (1, 2):
            frames = read_frames(written / session, number)
            assert frames.dtype == np.uint16
            assert np.percentile(frames, 99.9) > 2000
            assert (frames >= 4095).mean() < 1e-5


def test_saturation_clips_at_full_scale(tmp_path):
    rig = RigSettings(
        width=64, height=48, light=3.0, spacing=8.0, fixture_frames=1, dark_pages=1, flat_pages=1
    )
    frames = read_frames(simulate(tmp_path, rig=rig) / "run", 1)
    assert frames.max() == 4095
    assert (frames == 4095).mean() > 0.01


# what is written


def test_run_directory_follows_the_contract(written):
    run = written / "run"
    settings = tomllib.loads((run / "run.toml").read_text(encoding="utf-8"))
    assert list(settings) == [
        "calibration", "run", "camera1", "camera2", "optics", "encoder", "mechanism", "joint", "oil", "thickness",
    ]  # fmt: skip
    assert settings["encoder"]["triggers_per_cycle"] == 50
    assert settings["optics"]["pixel_pitch"] == "200 um"
    assert float(settings["encoder"]["zero"].removesuffix(" deg")) == pytest.approx(
        47.4095 + (24.426 - 23.04) / 2, abs=1e-4
    )
    with (run / "encoder.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["frame", "time_s", "angle_deg", "load_N", "temperature_C", "laser_mJ"]
    assert [int(row["frame"]) for row in rows] == list(range(50))
    assert all(abs(float(row["load_N"]) / 222.411 - 1) < 0.0101 for row in rows)
    assert all(abs(float(row["temperature_C"]) - 25) <= 0.2 for row in rows)
    for number in (1, 2):
        assert read_frames(run, number).shape == (50, 80, 96)


def test_fixture_directory_follows_the_contract(written, truth):
    fixture = written / "fixture"
    settings = tomllib.loads((fixture / "fixture.toml").read_text(encoding="utf-8"))
    assert list(settings) == ["fixture", "camera1", "camera2", "optics"]
    assert settings["fixture"]["origin"] == [0.0, 0.0]
    x, thickness, uncertainty = np.loadtxt(
        fixture / "profile.csv", delimiter=",", skiprows=1, unpack=True
    )
    npt.assert_allclose(np.diff(x), 0.1, atol=1e-9)
    assert x[0] < 0
    assert x[-1] > truth.x[-1]
    npt.assert_array_equal(uncertainty, 0.15)
    error = np.interp(truth.x, x, thickness) - truth.wedge
    assert 0.08 < error.std() < 0.2  # interpolation between readings averages a little
    npt.assert_allclose(truth.wedge[[0, -1]], [0.1, 18.0], atol=1e-9)
    assert read_frames(fixture, 1).shape == (3, 80, 96)


def test_a_perfect_measuring_machine_reads_the_wedge(tmp_path):
    rig = RigSettings(
        width=64,
        height=48,
        cmm_noise=0.0,
        spacing=8.0,
        fixture_frames=1,
        dark_pages=1,
        flat_pages=1,
    )
    out = simulate(tmp_path, rig=rig)
    x, thickness, _ = np.loadtxt(
        out / "fixture" / "profile.csv", delimiter=",", skiprows=1, unpack=True
    )
    with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as truth:
        npt.assert_allclose(np.interp(truth.x, x, thickness), truth.wedge, atol=2e-3)


def test_encoder_zero_can_be_withheld_and_cycles_repeat(tmp_path):
    rig = RigSettings(
        width=64,
        height=48,
        cycles=2,
        write_zero=False,
        spacing=8.0,
        fixture_frames=1,
        dark_pages=1,
        flat_pages=1,
    )
    out = simulate(tmp_path, rig=rig)
    settings = tomllib.loads((out / "run" / "run.toml").read_text(encoding="utf-8"))
    assert "zero" not in settings["encoder"]
    log = np.genfromtxt(out / "run" / "encoder.csv", delimiter=",", names=True)
    npt.assert_array_equal(log["angle_deg"], [0, 8, 16, 16, 8, 0] * 2)
    npt.assert_allclose(log["time_s"][6:] - log["time_s"][:6], 60 / 114, atol=2e-6)
    with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as truth:
        npt.assert_array_equal(truth.frame_trigger, [0, 1, 2, 3, 4, 5] * 2)
        assert dict(truth.film.sizes) == {"trigger": 6, "y": 48, "x": 64}
    frames = read_frames(out / "run", 1)
    assert not np.array_equal(frames[0], frames[6])  # the same film under a new pulse


def test_truth_says_what_was_put_in(truth):
    assert dict(truth.film.sizes) == {"trigger": 50, "y": 80, "x": 96}
    assert dict(truth.bubble.sizes) == {"frame": 50, "y": 80, "x": 96}
    assert dict(truth.expected_electrons.sizes) == {"camera": 2, "trigger": 50, "y": 80, "x": 96}
    assert all("units" in variable.attrs for variable in truth.data_vars.values())
    assert truth.attrs["seed"] == 5
    assert truth.attrs["rig_exponent"] == 0.62
    npt.assert_allclose([truth.drift_x.mean(), truth.drift_y.mean()], 0, atol=1e-14)
    assert 0.2 < truth.drift_x.std() < 0.4
    npt.assert_allclose(
        [truth.fixture_drift_x.mean(), truth.fixture_drift_y.mean()], [0.6, -0.4], atol=1e-14
    )
    npt.assert_allclose(truth.pulse_energy.std(), 0.03, rtol=0.35)


def test_frames_carry_the_light_the_truth_expects(written, truth):
    """Camera 1 pixel by pixel, camera 2 at the displaced pixel, both over the mean of all frames."""
    run = written / "run"
    y, x = np.indices((80, 96))
    inner = (slice(12, -12), slice(12, -12))
    clear = (truth.bubble.max("frame").to_numpy() == 0)[inner]
    for number in (1, 2):
        dark = tifffile.imread(run / f"camera{number}_dark.tif").mean(axis=0)
        frames = read_frames(run, number)
        electrons = 4.4 * (frames - dark) / truth.pulse_energy.to_numpy()[:, None, None]
        shift_x = truth.displacement_x.to_numpy() if number == 2 else 0 * x
        shift_y = truth.displacement_y.to_numpy() if number == 2 else 0 * y
        at_x, at_y = (
            np.rint(x + shift_x).astype(int)[inner],
            np.rint(y + shift_y).astype(int)[inner],
        )
        seen = electrons.mean(axis=0)[at_y, at_x]
        expected = truth.expected_electrons.sel(camera=number).mean("trigger").to_numpy()[inner]
        npt.assert_allclose(np.median((seen / expected)[clear]), 1, atol=0.01)


def test_film_in_the_truth_is_gap_and_marks(truth):
    smooth = truth.film.median("y").isel(trigger=13)
    curvature = np.polyfit(truth.x, smooth, 2)[0] * 2
    npt.assert_allclose(curvature, 0.2053, rtol=0.02)
    change = truth.film.isel(trigger=13) - truth.film.isel(
        trigger=0
    )  # the marks stay where they are
    npt.assert_allclose(change, truth.film_min[13] - truth.film_min[0], atol=3e-4)


def test_bubbles_are_dark_in_the_frame_and_masked_in_the_truth(written, truth):
    frames = read_frames(written / "run", 1)
    mask = truth.bubble.to_numpy() > 0
    assert 0 < mask.mean() < 0.01
    inside = mask & (truth.expected_electrons.sel(camera=1).to_numpy() > 3000)
    core = inside.copy()
    for axis, step in ((1, 1), (1, -1), (2, 1), (2, -1)):  # a pixel inside the meniscus
        core &= np.roll(mask, step, axis) & np.roll(mask, 2 * step, axis)
    assert core.any()
    assert np.median(frames[core]) < 0.3 * np.median(frames[~mask])


# seeds and files


def digest(directory: Path) -> dict[str, str]:
    return {
        str(path.relative_to(directory)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(directory.rglob("*"))
        if path.is_file()
    }


def test_the_same_seed_writes_the_same_bytes(tmp_path):
    rig = RigSettings(
        width=64, height=48, spacing=8.0, fixture_frames=2, dark_pages=2, flat_pages=2
    )
    first = digest(simulate(tmp_path / "first", seed=11, rig=rig))
    again = digest(simulate(tmp_path / "again", seed=11, rig=rig))
    other = digest(simulate(tmp_path / "other", seed=12, rig=rig))
    assert first == again
    assert set(first) == set(other)
    settings = {"run/run.toml", "fixture/fixture.toml"}
    assert all((first[name] == other[name]) == (name in settings) for name in first)


def test_existing_output_is_refused_and_kept(tmp_path, monkeypatch):
    rig = RigSettings(
        width=64, height=48, spacing=8.0, fixture_frames=1, dark_pages=1, flat_pages=1
    )
    simulate(tmp_path, seed=1, rig=rig)
    (tmp_path / "notes.txt").write_text("mine")
    before = digest(tmp_path)
    with pytest.raises(OutputError, match="overwrite"):
        simulate(tmp_path, seed=2, rig=rig)

    def break_off(out, **_):
        (out / "run").mkdir()
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(erlif.rig.run, "write_rig", break_off)
        with pytest.raises(OutputError, match="No space left"):
            simulate(tmp_path, seed=2, rig=rig, overwrite=True)
    assert digest(tmp_path) == before
    simulate(tmp_path, seed=2, rig=rig, overwrite=True)
    after = digest(tmp_path)
    assert after["truth.nc"] != before["truth.nc"]
    assert after["notes.txt"] == before["notes.txt"]


@pytest.mark.parametrize(
    "wrong",
    [
        {"width": 8},
        {"cycles": 0},
        {"light": 0.0},
        {"spacing": 0.0},
        {"crank": 30.0},
        {"pin_radius": 34.0},
        {"wedge": (5.0, 1.0)},
        {"scale": (2.0, 1.0)},
    ],
)
def test_a_rig_that_cannot_work_is_refused(wrong):
    with pytest.raises(ModelError):
        RigSettings(**wrong)


def test_rig_shares_no_code_with_the_measurement():
    """A rig that borrowed from the inversion could not find its mistakes."""
    for path in Path(erlif.rig.__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            for name in names:
                if name.split(".")[0] == "erlif":
                    allowed = name in (
                        "erlif.core.arrays",
                        "erlif.core.errors",
                    )  # types and exceptions
                    assert allowed or name.startswith("erlif.rig"), f"{path.name} imports {name}"
