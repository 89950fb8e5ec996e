"""simulate: bytes of a seed, refusals, and a rig without code of the measurement."""

import ast
import csv
import itertools
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.testing as npt
import pytest
import tifffile
import xarray as xr
from scenes.rig import QUICK, digest, read_frames

from erlif import rig
from erlif.core.errors import OutputError
from erlif.core.terms import keys_in
from erlif.io.settings import read_run_settings
from erlif.joint import rig as joint_rig
from erlif.rig import RigSettings, simulate
from erlif.rig.directory import run_toml, write_encoder_log, write_profile
from erlif.rig.film import Wedge, list_pictures, list_triggers


def test_the_same_seed_writes_the_same_bytes(tmp_path):
    rig = replace(QUICK, fixture_frames=2, dark_pages=2, flat_pages=2)
    first = digest(simulate(tmp_path / "first", seed=11, rig=rig))
    again = digest(simulate(tmp_path / "again", seed=11, rig=rig))
    other = digest(simulate(tmp_path / "other", seed=12, rig=rig))
    assert first == again
    assert set(first) == set(other)
    settings = {"run/run.toml", "fixture/fixture.toml"}
    assert all((first[name] == other[name]) == (name in settings) for name in first)


def test_existing_output_is_refused_and_kept(tmp_path, monkeypatch):
    rig = QUICK
    simulate(tmp_path, seed=1, rig=rig)
    (tmp_path / "notes.txt").write_text("mine")
    before = digest(tmp_path)
    with pytest.raises(OutputError, match="overwrite"):
        simulate(tmp_path, seed=2, rig=rig)

    def break_off(out, **_):
        (out / "run").mkdir()
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr("erlif.rig.directory.write_rig", break_off)
        with pytest.raises(OutputError, match="No space left"):
            simulate(tmp_path, seed=2, rig=rig, overwrite=True)
    assert digest(tmp_path) == before
    simulate(tmp_path, seed=2, rig=rig, overwrite=True)
    after = digest(tmp_path)
    assert after["truth.nc"] != before["truth.nc"]
    assert after["notes.txt"] == before["notes.txt"]


def test_rig_shares_no_code_with_the_measurement():
    """A rig that used the code of the inversion could not find its mistakes."""
    for path in (*Path(rig.__file__).parent.glob("*.py"), Path(joint_rig.__file__)):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            for name in names:
                if name.split(".")[0] == "erlif":
                    # types, exceptions, progress, numba, the reader of tables, names of keys
                    core = ("arrays", "errors", "progress", "speed.kernels", "tables", "terms")
                    allowed = name.removeprefix("erlif.core.") in core
                    assert allowed or name.startswith("erlif.rig"), f"{path.name} imports {name}"


def test_progress_counts_the_frames_of_both_sessions(tmp_path):
    calls = []
    simulate(tmp_path, rig=QUICK, progress=lambda *call: calls.append(call))
    assert calls[0] == ("fixture frame", 1, 1)
    assert calls[1:] == [("run frame", number, 6) for number in range(1, 7)]


# what is written


def test_run_directory_has_its_settings_log_and_frames(written):
    run = written / "run"
    settings = tomllib.loads((run / "run.toml").read_text(encoding="utf-8"))
    assert list(settings) == [
        "calibration", "run", "camera1", "camera2", "optics",
        "encoder", "mechanism", "joint", "oil", "systematics", "thickness",
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


def test_fixture_directory_has_its_settings_profile_and_frames(written, truth):
    fixture = written / "fixture"
    settings = tomllib.loads((fixture / "fixture.toml").read_text(encoding="utf-8"))
    assert list(settings) == ["fixture", "systematics", "camera1", "camera2", "optics"]
    assert settings["fixture"]["origin"] == [0.0, 0.0]
    x, _, uncertainty = np.loadtxt(fixture / "profile.csv", delimiter=",", skiprows=1, unpack=True)
    npt.assert_allclose(np.diff(x), 0.1, atol=1e-9)
    assert x[0] < 0
    assert x[-1] > truth.x[-1]
    npt.assert_array_equal(uncertainty, 0.15)
    npt.assert_allclose(truth.wedge[[0, -1]], [0.1, 18.0], atol=1e-9)
    assert read_frames(fixture, 1).shape == (3, 80, 96)


def test_encoder_zero_can_be_withheld_and_cycles_repeat(tmp_path):
    out = simulate(tmp_path, rig=replace(QUICK, cycles=2, write_zero=False))
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


# the light in it


def test_frames_carry_the_expected_light(written, truth):
    """Camera 1 pixel by pixel, camera 2 at the displaced pixel, over the mean of all frames."""
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
        at = [np.rint(place).astype(int)[inner] for place in (y + shift_y, x + shift_x)]
        seen = electrons.mean(axis=0)[tuple(at)]
        expected = truth.expected_electrons.sel(camera=number).mean("trigger").to_numpy()[inner]
        npt.assert_allclose(np.median((seen / expected)[clear]), 1, atol=0.01)


def test_bubbles_are_dark_in_the_frame_and_masked_in_truth_nc(written, truth):
    frames = read_frames(written / "run", 1)
    mask = truth.bubble.to_numpy() > 0
    assert 0 < mask.mean() < 0.01
    inside = mask & (truth.expected_electrons.sel(camera=1).to_numpy() > 3000)
    core = inside.copy()
    for axis, step in ((1, 1), (1, -1), (2, 1), (2, -1)):  # a pixel inside the meniscus
        core &= np.roll(mask, step, axis) & np.roll(mask, 2 * step, axis)
    assert core.any()
    assert np.median(frames[core]) < 0.3 * np.median(frames[~mask])


# single files


def test_readings_of_the_profile_scatter_by_the_stated_uncertainty(tmp_path):
    rig = RigSettings(cmm_noise=0.2)
    wedge = Wedge(rig)
    write_profile(tmp_path / "p.csv", wedge, np.random.default_rng(2))
    x, film, std = np.loadtxt(tmp_path / "p.csv", delimiter=",", skiprows=1, unpack=True)
    error = film - wedge.profile(x / rig.pitch)
    npt.assert_array_equal(std, 0.2)
    npt.assert_allclose(error.std(), 0.2, rtol=4 / np.sqrt(2 * x.size))
    assert abs(error.mean()) < 4 * 0.2 / np.sqrt(x.size)


def test_energy_meter_follows_the_pulses_to_half_a_per_cent(tmp_path):
    rig = RigSettings(cycles=20)
    triggers = list_triggers(rig)
    energy = np.random.default_rng(3).normal(1, 0.05, 1000)
    write_encoder_log(tmp_path / "e.csv", triggers, rig, energy, np.random.default_rng(4))
    log = np.genfromtxt(tmp_path / "e.csv", delimiter=",", names=True)
    reading = log["laser_mJ"] / (50 * energy) - 1
    npt.assert_allclose(reading.std(), 0.005, rtol=4 / np.sqrt(2000))
    assert abs(reading.mean()) < 4 * 0.005 / np.sqrt(1000)
    assert np.all(np.diff(log["time_s"]) > 0)


def test_the_mount_of_the_pin_reaches_run_toml_unless_it_is_withheld():
    rig = RigSettings(film="reynolds", tilt=0.0, sideways=5e4, cavitation_pressure=-30.0)
    settings = tomllib.loads(run_toml(rig, list_triggers(rig)))
    middle = 159.5 * 19.2 / 320
    assert settings["prediction"] == {
        "sideways": "50000 N/m",
        "cavitation_pressure": "-30 kPa",
        "load_line": f"{middle + 0.8:.6g} mm",
        "direction": "along",
    }
    for other in (replace(rig, write_mount=False), RigSettings()):
        assert "prediction" not in tomllib.loads(run_toml(other, list_triggers(other)))
    for side in ("pin", "bushing"):  # stiff where the film is that of rigid cylinders
        assert settings["joint"][side]["youngs_modulus"] == "1000 GPa"
    stated = replace(rig, stated_viscosity=0.3)
    assert tomllib.loads(run_toml(stated, list_triggers(stated)))["oil"]["viscosity"] == "0.3 Pa s"


def test_profile_liner_and_roughness_reach_the_settings_of_the_run(tmp_path, monkeypatch):
    """Read as erlif reads them: 0.8 um at the upper end, and half-way between two depths.

    The pin stays in the middle: the settings do not depend on the films.
    """

    def stay(unbalance, last, *_):
        unbalance(last)
        return last, None

    monkeypatch.setattr("erlif.rig.cavitation._balance", stay)
    rig = RigSettings(
        width=64,
        height=48,
        spacing=8.0,
        fixture_frames=1,
        film="reynolds",
        tilt=0.0,
        elapsed=0.1,
        length=30.0,
        profile=(2.0, -1.0, 0.4, 0.8),
        liner=(1.5, 0.5, 0.4),
        roughness=0.6,
        rough=True,
        write_mount=False,
    )
    settings = read_run_settings(simulate(tmp_path, rig=rig) / "run")
    place = np.array([-15e-3, -10e-3, 15e-3])
    npt.assert_allclose(settings.joint.bore.shape(place, 0.03), [2e-6, 0.5e-6, 0.8e-6])
    liner = settings.joint.liner
    assert (liner.thickness, liner.youngs_modulus, liner.poissons_ratio) == (1.5e-3, 5e8, 0.4)
    assert settings.joint.pin.roughness == settings.joint.bushing.roughness == 0.6e-6
    assert settings.prediction.rough
    simulate(tmp_path, rig=QUICK, overwrite=True)
    assert not (tmp_path / "run" / "bore.csv").exists()


def test_flats_rise_level_by_level(written):
    """Three levels of eight pages at 0.25, 0.5 and 0.8 of full scale, seen through the lens."""
    for number in (1, 2):
        dark = tifffile.imread(written / "run" / f"camera{number}_dark.tif").mean(axis=0)
        flat = tifffile.imread(written / "run" / f"camera{number}_flat.tif")
        levels = flat.reshape(3, 8, 80, 96).mean(axis=1) - dark
        bright = np.percentile(levels, 99, axis=(1, 2)) / 4095  # the middle of the lens
        assert bright == pytest.approx([0.25, 0.5, 0.8], rel=0.03)


@pytest.fixture(scope="module")
def odd(tmp_path_factory):
    """A run with light that is not film, a patch of 4 um, and dyes that bleach by 2 % a pulse."""
    light = {"background": 0.05, "background_beam": 0.03, "background_pages": 4}
    rig = replace(QUICK, **light, bleaching=(0.02, 0.0), reference=4.0, bubbles=0)
    return simulate(tmp_path_factory.mktemp("odd") / "out", seed=5, rig=rig)


def test_frames_of_the_dry_joint_hold_their_share_of_the_median_light(odd):
    """Half of the pixels of the run have less light than the level that the share refers to."""
    settings = tomllib.loads((odd / "run" / "run.toml").read_text())
    with xr.open_dataset(odd / "truth.nc", engine="h5netcdf") as truth:
        typical = truth.background_typical.values
        light = truth.expected_electrons.median(("trigger", "y", "x")).values
    # expected_electrons has the mean transmission of both lenses
    npt.assert_allclose(0.93 * typical, light, rtol=0.05)
    middle = slice(20, 28), slice(28, 36)  # near the axes of beam and lens
    for number in (1, 2):
        pages = tifffile.imread(odd / "run" / settings[f"camera{number}"]["background"])
        dark = tifffile.imread(odd / "run" / f"camera{number}_dark.tif").mean(axis=0)
        assert pages.shape == (4, 48, 64)
        light = np.median((pages.mean(axis=0) - dark)[middle]) * 4.4
        assert light == pytest.approx(0.08 * typical[number - 1], rel=0.06)


def test_light_fades_from_pulse_to_pulse_as_dye_1_bleaches(odd, tmp_path):
    fresh = simulate(tmp_path / "fresh", seed=5, rig=replace(QUICK, reference=4.0, bubbles=0))
    rows, columns = slice(20, 28), slice(5, 10)  # within the patch of 4 um
    faded, whole = (
        read_frames(directory / "run", 1)[:, rows, columns].astype(float) - 64
        for directory in (odd, fresh)
    )
    background = faded[0].mean() / whole[0].mean()
    assert background > 1.02
    share = faded.mean(axis=(1, 2)) / whole.mean(axis=(1, 2)) / background
    # dye 1 makes most of the light at 580 nm; less of it also absorbs less of the laser
    assert np.all(np.diff(share) < 0)
    assert 0.92 < share[-1] < 0.99


def test_the_patch_has_its_film_at_all_triggers_and_is_named_in_run_toml(odd):
    settings = tomllib.loads((odd / "run" / "run.toml").read_text())["reference"]
    assert settings["thickness"] == "4 um"
    with xr.open_dataset(odd / "truth.nc", engine="h5netcdf") as truth:
        region = settings["region"]
        patch = truth.film.sel(x=slice(*region["x"]), y=slice(*region["y"]))
        assert patch.size > 50
        npt.assert_array_equal(patch, 4.0)
        (left, _), _ = RigSettings(width=64, height=48).region
        assert region["x"][1] < left


# what changes during the run


def simulate_pairs(out, **changes):
    """Counts of both cameras less their dark level [DN]: a static film, no speckle, even pulses."""
    still = {"pulse_jitter": 0.0, "speckle_fixed": 0.0, "speckle_new": 0.0, "bubbles": 0}
    still |= {"vibration": 0.0, "marks": 0.0, "mechanism": "static", "pictures": 6}
    simulate(out, seed=4, rig=replace(QUICK, **still | changes))
    dark = [
        tifffile.imread(out / "run" / f"camera{number}_dark.tif").mean(axis=0) for number in (1, 2)
    ]
    return [read_frames(out / "run", n) - level for n, level in zip((1, 2), dark, strict=True)]


def find_displacement(before, after):
    """Whole pixels (x, y) by which an image has moved: the smallest squared difference of all."""

    def difference(shift):
        x, y = shift
        return np.square(np.roll(after, (-y, -x), (0, 1)) - before)[8:-8, 8:-8].mean()

    return min(itertools.product(range(-8, 9), repeat=2), key=difference)


def light_over_first(pairs):
    """Light of each frame over that of the first one, (camera, frame)."""
    return np.array([(each.sum(axis=(1, 2)) / each[0].sum()) for each in pairs])


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        # a camera that keeps 10 % of its last light has 1.1 of the first frame from then on
        ({"lag": (0.1, 0.0)}, ([1, 1.1, 1.1, 1.1, 1.1, 1.1], [1] * 6)),
        ({"gain_step": (3, 1.05)}, ([1] * 6, [1, 1, 1, 1.05, 1.05, 1.05])),
        # 50 K at 0.2 % per K of dye 1, which emits nearly all light behind both filters
        ({"warming": 50.0}, ([1, 0.98, 0.96, 0.94, 0.92, 0.9],) * 2),
    ],
    ids=["lag", "step", "warming"],
)
def test_light_changes_from_frame_to_frame(tmp_path, changes, expected):
    found = light_over_first(simulate_pairs(tmp_path / "out", **changes))
    npt.assert_allclose(found, expected, atol=0.03 if "warming" in changes else 0.004)


def test_the_run_differs_from_its_calibration_as_stated(tmp_path):
    plain = simulate_pairs(tmp_path / "plain")
    changed = simulate_pairs(tmp_path / "changed", brightness=(1.0, 0.8), dark_drift=(7.0, 0.0))
    one, two = (
        after.mean() - factor * before.mean()
        for before, after, factor in zip(plain, changed, (1.0, 0.8), strict=True)
    )
    npt.assert_allclose(one, 7.0, atol=0.1)
    npt.assert_allclose(two, 0.0, atol=0.1)


def test_a_compressed_camera_loses_light_in_proportion_to_it(tmp_path):
    """20 % at full scale: half of it at half of full scale."""
    plain, bent = (
        simulate_pairs(tmp_path / name, compression=(share, 0.0))[0].mean(axis=0)
        for name, share in (("plain", 0.0), ("bent", 0.2))
    )
    bright = plain > 500
    expected = plain[bright] * (1 - 0.2 * plain[bright] / 4095)
    assert np.abs((bent[bright] - expected).mean()) < 2


def test_camera_2_loses_sharpness_at_its_frame(tmp_path):
    """Contrast of speckle of 0.72 px, from a blur of 0.55 px to one of 1.14 px."""
    contrast = [
        [np.std(np.diff(frame, axis=1)) / frame.mean() for frame in camera]
        for camera in simulate_pairs(
            tmp_path,
            blur_step=(3, 1.0),
            speckle_fixed=0.3,
            dust=0,
            hot_fraction=0.0,
            beam_corner=1.0,
        )
    ]
    npt.assert_allclose(contrast[0], contrast[0][0], rtol=0.02)
    npt.assert_allclose(contrast[1][:3], contrast[1][0], rtol=0.02)
    assert max(contrast[1][3:]) < 0.7 * contrast[1][0]


def test_dark_of_camera_2_rises_at_its_frame(tmp_path):
    before, after = (
        simulate_pairs(tmp_path / name, dark_step=(4, rise))
        for name, rise in (("before", 0.0), ("after", 9.0))
    )
    npt.assert_array_equal(before[0], after[0])
    npt.assert_array_equal(before[1][:4], after[1][:4])
    npt.assert_allclose((after[1] - before[1])[4:].mean(), 9.0, atol=0.01)


def test_an_iris_leaves_dark_corners_to_which_a_lens_scatters_light(tmp_path):
    """Glare of 2 % of the mean light of each frame, which the light of the film does not reach."""
    y, x = np.indices((48, 64))
    outside = np.hypot(x - 31.5, y - 23.5) > 0.8 * np.hypot(31.5, 23.5) + 6  # of both cameras
    dark, scattered = (
        simulate_pairs(tmp_path / name, iris=0.8, glare=glare, hot_fraction=0.0)
        for name, glare in (("dark", 0.0), ("scattered", 0.02))
    )
    for camera in range(2):
        npt.assert_allclose(dark[camera][:, outside].mean(), 0.0, atol=0.5)
        light = scattered[camera] - dark[camera]
        expected = 0.02 * dark[camera].mean()
        npt.assert_allclose(light[:, outside].mean(), expected, rtol=0.2)


def test_a_bump_displaces_camera_2_from_its_frame_on(tmp_path):
    """By 5 pixels along x and -3 along y, as speckle of the oil behind an even flat shows."""
    out = tmp_path / "out"
    pairs = simulate_pairs(out, bump=(2, 5.0, -3.0), speckle_fixed=0.3)
    for number, counts, expected in zip((1, 2), pairs, [(0, 0), (5, -3)], strict=True):
        dark, flat = (
            tifffile.imread(out / "run" / f"camera{number}_{name}.tif").astype(float)
            for name in ("dark", "flat")
        )
        even = counts / (flat - dark).mean(axis=0)
        assert find_displacement(even[:2].mean(axis=0), even[2:].mean(axis=0)) == expected

    with xr.open_dataset(out / "truth.nc", engine="h5netcdf") as truth:
        npt.assert_array_equal(truth.drift_x, [0, 0, 5, 5, 5, 5])
        npt.assert_array_equal(truth.drift_y, [0, 0, -3, -3, -3, -3])


def test_settings_file_states_what_the_rig_does_not_have():
    def stated(**changes):
        text = run_toml(replace(QUICK, **changes), list_pictures(QUICK))
        return tomllib.loads(text).get("systematics", {})

    terms = set(keys_in("run")) - {"energy", "course"}  # it has no dry joint and no second fixture
    assert stated() == dict.fromkeys(terms, "0 %")
    assert set(stated(wall=(0.3, 0.3))) == terms
    assert set(stated(wall=(0.0, 0.1), lag=(0.01, 0.0))) == terms - {"wall", "lag"}
    for dark in ({"dark_drift": (0.0, 5.0)}, {"dark_step": (3, 5.0)}, {"glare": 0.01}):
        assert set(stated(**dark)) == terms - {"background"}
    assert stated(write_systematics=False) == {}
