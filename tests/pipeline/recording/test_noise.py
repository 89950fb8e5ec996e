"""Gain and read noise estimated from the frames of a rig whose photons are counted."""

import re
import shutil
from dataclasses import replace

import cv2
import numpy as np
import numpy.testing as npt
import pytest
import tifffile
import xarray as xr
from scenes.fixture import share_within
from scenes.pair import references_of, unknown
from scipy import ndimage

from conftest import FULL
from erlif.core.notes import Level, join_notes
from erlif.core.progress import silent
from erlif.io.ingest import open_fixture, open_run
from erlif.pipeline.recording.cameras import characterise_cameras
from erlif.pipeline.recording.noise import measure_noise, note_noise
from erlif.pipeline.recording.prepare import prepare_chain
from erlif.pipeline.recording.sample import divide_sample
from erlif.ratio import BlurDifference, NoiseView, estimate_camera_noise
from erlif.ratio.camera_noise import cell_size
from erlif.rig import RigSettings, simulate

GAIN, READ = 4.4, 9.0  # of the virtual rig


def forget(path, *keys, camera=r"12"):
    """Take keys out of the tables of the cameras in a settings file."""
    text = path.read_text(encoding="utf-8")
    for table in re.findall(rf"^\[camera[{camera}]\]\n(?:.+\n)*", text, flags=re.MULTILINE):
        text = text.replace(
            table, re.sub(rf"^(?:{'|'.join(keys)}) = .*\n", "", table, flags=re.MULTILINE)
        )
    path.write_text(text, encoding="utf-8")


def estimate(directory):
    """The chain of a recording, and the notes on its cameras."""
    recording = (open_run if (directory / "run.toml").is_file() else open_fixture)(directory)
    return prepare_chain(recording, silent)


def texts(prepared, level=None):
    return join_notes(note for note in prepared.notes if level in (None, note.level))


def test_declared_cameras_keep_their_references(small_rig):
    recording = open_run(small_rig.run)
    declared = characterise_cameras(recording).cameras
    prepared = prepare_chain(recording, silent)
    assert prepared.notes == declared.notes
    xr.testing.assert_identical(prepared.chain.references, declared.references)


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    """Never to be changed; take `laboratory` for a copy."""
    out = tmp_path_factory.mktemp("rig")
    simulate(
        out,
        seed=811,
        rig=RigSettings(width=160, height=128, spacing=6.0, fixture_frames=4, light=0.5),
    )
    return out


@pytest.fixture
def laboratory(rig, tmp_path):
    shutil.copytree(rig, tmp_path / "rig")
    return tmp_path / "rig"


@pytest.mark.parametrize(
    ("kind", "lost"), [("fixture", ("gain", "flat")), ("run", ("gain", "flat", "read_noise"))]
)
def test_gain_is_estimated_from_the_frames_where_nothing_else_determines_it(laboratory, kind, lost):
    forget(laboratory / kind / f"{kind}.toml", *lost)
    prepared = estimate(laboratory / kind)
    references = prepared.chain.references
    gain, std = references.gain.values, references.gain_std.values
    npt.assert_allclose(gain[0], gain[1], rtol=0.05)
    assert np.all(np.abs(gain - GAIN) < 3 * std)
    # 20 480 pixels in four frames determine two gains and a pattern
    assert np.all(std < 0.12 * GAIN)
    assert texts(prepared, Level.WARNING).count("with a probability of") == 2
    assert "will be estimated" not in texts(prepared)


def test_read_noise_is_estimated_from_the_frames_where_darks_are_too_few(laboratory):
    """One dark page, gain declared; in dim frames the read noise shows."""
    for n in (1, 2):
        path = laboratory / "run" / f"camera{n}_dark.tif"
        with tifffile.TiffFile(path) as file:
            page = file.pages[0].asarray()
        tifffile.imwrite(path, page)
    forget(laboratory / "run" / "run.toml", "read_noise")
    prepared = estimate(laboratory / "run")
    references = prepared.chain.references
    npt.assert_array_equal(references.gain, GAIN)
    assert np.all(np.abs(references.read_noise - READ) < 3 * references.read_noise_std)
    assert np.all(references.read_noise_std < READ)
    assert "camera1: read noise estimated" in texts(prepared, Level.WARNING)
    assert texts(prepared, Level.WARNING).count("one read noise [DN] for both") == 2


def test_gain_of_one_camera_follows_from_that_of_the_other(laboratory):
    forget(laboratory / "run" / "run.toml", "gain", "flat", camera="2")
    forget(laboratory / "run" / "run.toml", "flat", camera="1")
    prepared = estimate(laboratory / "run")
    references = prepared.chain.references
    assert references.gain[0] == GAIN
    assert abs(references.gain[1] - GAIN) < 3 * references.gain_std[1] < 0.45 * GAIN
    assert "equal gains" not in texts(prepared)
    assert "one read noise" not in texts(prepared)


def test_without_a_flat_the_spread_of_the_response_becomes_noise(laboratory):
    """The rig's pixels differ by 1 %. The drift of camera 2 shows its spread, taken for both."""
    forget(laboratory / "run" / "run.toml", "flat")
    prepared = estimate(laboratory / "run")
    chain = prepared.chain
    npt.assert_array_equal(chain.references.gain, GAIN)
    npt.assert_allclose(chain.references.response_spread, 0.01, rtol=0.25)
    npt.assert_allclose(
        chain.references.flat_var, chain.references.response_spread.values[0] ** 2, rtol=1e-5
    )
    assert "pixel response of both cameras varies by" in texts(prepared, Level.WARNING)


def test_response_of_camera_1_alone_without_a_flat_is_not_estimated(laboratory):
    """Its pixels do not move against the grid in which frames are compared."""
    forget(laboratory / "run" / "run.toml", "gain", camera="2")
    forget(laboratory / "run" / "run.toml", "gain", "flat", camera="1")
    prepared = estimate(laboratory / "run")
    references = prepared.chain.references
    assert np.isnan(references.response_spread[0])
    npt.assert_array_equal(references.flat_var[0], 0.0)
    npt.assert_allclose(references.response_spread[1], 0.01, rtol=0.1)
    lines = texts(prepared).splitlines()
    (both,) = [line for line in lines if line.startswith("cameras: ")]
    assert "pixels respond" not in both.split("; ")[0]
    one = [line for line in lines if line.startswith("warning: camera1: ")]
    assert not any("pixels respond" in line for line in one)
    assert any("no flat; vignetting and pixel response are not corrected" in line for line in one)


PAIR = (96, 128)


def small_pairs(rng):
    """Four pairs of counted photons; camera 2 drifts by parts of a pixel and is interpolated."""
    y, x = (np.linspace(0, 1, size) for size in PAIR)
    light = np.stack([200 + 2800 * x + 0 * y[:, None], 200 + 2000 * np.outer(y, x)])
    cells = [size // cell_size(PAIR) for size in PAIR]
    for _ in range(4):
        read = rng.normal(0, READ / GAIN, light.shape)
        counts = np.rint(rng.poisson(GAIN * light) / GAIN + read)
        drift = rng.uniform(-0.5, 0.5, 2)
        noise = ndimage.shift(counts[1] - light[1], drift, order=3, mode="grid-wrap")
        place = np.broadcast_to(drift[::-1, None, None], (2, *cells))
        yield NoiseView(np.log((light[1] + noise) / counts[0]), 1 / light, 1 / light**2, place)


def test_gain_is_right_to_five_per_cent_and_its_uncertainty_covers():
    """Without the interpolation the gains are 14 % off, or 3.5 of their std."""
    known = references_of(PAIR, gain=(GAIN, GAIN), read_noise=(READ, READ))
    what = unknown(gain=(True, True))
    gains, stds, count = [], [], 40 if FULL else 20
    for seed in range(count):
        pairs = small_pairs(np.random.default_rng(seed))
        found = estimate_camera_noise(
            pairs, what, references=known, blur=BlurDifference(), frames=4
        )
        gains.append([camera.gain for camera in found.cameras])
        stds.append([camera.gain_std for camera in found.cameras])

    errors = np.array(gains) / GAIN - 1
    assert np.abs(errors).max() < 0.05
    assert np.all(np.abs(errors.mean(axis=0)) < 3 * errors.std(axis=0) / np.sqrt(count))

    # the gains are taken as equal with a probability, so that the uncertainty is rather too large
    pulls = (np.array(gains) - GAIN) / np.array(stds)
    for width, share in ((1, 0.683), (2, 0.954)):
        assert np.all(share_within(pulls, width) > share - 2 * np.sqrt(share * (1 - share) / count))
    assert 0.5 < np.sqrt(np.mean(np.square(pulls))) < 1.2


def test_gain_of_frames_of_the_usual_size_is_right_to_five_per_cent(tmp_path):
    """Fixtures and runs in full and dim light; the dim run alone without ERLIF_FULL."""
    errors, pulls = [], []
    rigs = [(822, 0.3, ["run"]), (821, 1.0, ["fixture"]), (823, 0.6, ["fixture", "run"])]
    for seed, light, kinds in rigs if FULL else rigs[:1]:
        out = tmp_path / str(seed)
        rig = RigSettings(spacing=6.0, light=light)
        simulate(out, seed=seed, rig=rig if "fixture" in kinds else replace(rig, fixture_frames=1))
        for kind in kinds:
            forget(out / kind / f"{kind}.toml", "gain", "flat")
            references = estimate(out / kind).chain.references
            errors += (references.gain.values / GAIN - 1).tolist()
            pulls += ((references.gain.values - GAIN) / references.gain_std.values).tolist()
    assert np.abs(errors).max() < 0.05
    assert np.abs(pulls).max() < 3
    # four independent pairs of correlated errors exceed this once in thirty
    assert np.sqrt(np.mean(np.square(pulls))) < 1.6


def rewrite(lab, change):
    for path in (*lab.frames(1), *lab.frames(2)):
        image = tifffile.imread(path)
        path.unlink()
        tifffile.imwrite(path, change(image).astype(np.uint16))


def sampled(lab):
    ready = prepare_chain(open_run(lab.run), silent)
    return divide_sample(ready.chain, ready.sample)


def test_sound_frames_have_the_noise_of_their_cameras(lab):
    assert measure_noise(sampled(lab)) == pytest.approx(1.05, abs=0.06)
    assert list(note_noise(sampled(lab))) == []


@pytest.mark.parametrize(
    "change",
    [lambda i: i >> 1, lambda i: np.rint(i / 2), lambda i: cv2.GaussianBlur(i, (3, 3), 0.6)],
    ids=["cut in half", "rounded to the half", "smoothed"],
)
def test_counts_that_were_halved_or_smoothed_have_too_little_noise(lab, change):
    rewrite(lab, change)
    (note,) = note_noise(sampled(lab))
    assert note.level == "warning"
    assert "Export the raw counts" in note.text


def test_without_valid_pixels_nothing_is_known():
    assert np.isnan(measure_noise([]))
