"""Dark, flat and noise against counts drawn from known electrons."""

import numpy as np
import numpy.testing as npt
import pytest
import tifffile
import xarray as xr

from erlif.core.errors import FrameError
from erlif.core.flags import Flag
from erlif.core.products import Frames, References
from erlif.correction import correct_frames, measure_references
from erlif.ingest import open_fixture

GAIN, READ, OFFSET = 4.4, 9.0, 64.0
SHAPE = (72, 80)
HOT, DEAD = (10, 12), (40, 50)


def expose(electrons, rng):
    """Counts of a camera with known gain, read noise and offset; written here, independently of the virtual rig."""
    light = rng.poisson(np.broadcast_to(electrons, SHAPE)) + rng.normal(0, READ, SHAPE)
    counts = light / GAIN + OFFSET
    counts[HOT] += 400
    counts[DEAD] = OFFSET
    return np.clip(np.rint(counts), 0, 4095).astype(np.uint16)


def response():
    """Vignetting and a pixel pattern."""
    y, x = np.indices(SHAPE)
    falloff = 1 - 0.3 * ((x / SHAPE[1] - 0.5) ** 2 + (y / SHAPE[0] - 0.5) ** 2)
    return falloff * (1 + 0.01 * np.sin(1.7 * x + 2.3 * y))


CAMERA = """
[camera{n}]
files = "camera{n}/*.tif"
band = "{band} nm"
dark = "dark.tif"
flat = "flat.tif"
{extra}
"""


@pytest.fixture
def fixture_dir(tmp_path):
    rng = np.random.default_rng(1)
    with tifffile.TiffWriter(tmp_path / "dark.tif") as file:
        for _ in range(16):
            file.write(expose(0, rng), contiguous=False)
    with tifffile.TiffWriter(tmp_path / "flat.tif") as file:
        for level in (3000, 7000, 12000):
            for _ in range(8):
                file.write(expose(level * rng.normal(1, 0.005) * response(), rng), contiguous=False)
    for n in (1, 2):
        (tmp_path / f"camera{n}").mkdir()
        tifffile.imwrite(tmp_path / f"camera{n}" / "a.tif", expose(8000 * response(), rng))
    write_settings(tmp_path)
    return tmp_path


def write_settings(directory, extra=""):
    text = '[fixture]\nname = "test"\nprofile = "profile.csv"\n[optics]\npixel_pitch = "60 um"\n'
    text += "".join(CAMERA.format(n=n, band=band, extra=extra) for n, band in ((1, 580), (2, 610)))
    (directory / "fixture.toml").write_text(text)


def test_gain_and_read_noise_are_measured(fixture_dir):
    references = measure_references(open_fixture(fixture_dir))
    # 16 pages of 5760 pixels fix the read noise to 1/sqrt(2*15*5760) = 0.24 %, 24 flats the gain to about 0.4 %
    npt.assert_allclose(references.gain, GAIN, rtol=0.015)
    npt.assert_allclose(references.read_noise, READ, rtol=0.02)


def test_measured_gain_names_its_uncertainty_and_it_covers(fixture_dir):
    notes = measure_references(open_fixture(fixture_dir)).attrs["notes"]
    note = next(line for line in notes.split("\n") if line.startswith("camera1: gain measured"))
    value, std = (float(part) for part in note.split("flats, ")[1].split(" electron")[0].split(" ± "))
    assert abs(value - GAIN) < 4 * std
    assert 0.002 < std / GAIN < 0.01


def test_declared_gain_is_used_and_a_wrong_one_is_said(fixture_dir):
    write_settings(fixture_dir, 'gain = "6 electron/DN"')
    references = measure_references(open_fixture(fixture_dir))
    npt.assert_array_equal(references.gain, 6.0)
    assert "declared gain, 6 electron/DN, is +36 % off" in references.attrs["notes"]


def test_flat_follows_the_response(fixture_dir):
    references = measure_references(open_fixture(fixture_dir))
    flat = references.flat.values[0]
    expected = response() / response().mean()
    good = ~references.bad.values[0]
    deviation = (flat - expected)[good] / np.sqrt(references.flat_var.values[0][good])
    assert abs(deviation.mean()) < 0.1
    assert 0.9 < deviation.std() < 1.1


def test_hot_and_dead_pixels_are_found_and_few_others(fixture_dir):
    bad = measure_references(open_fixture(fixture_dir)).bad.values[0]
    assert bad[HOT]
    assert bad[DEAD]
    assert bad.sum() <= 4


def test_variance_matches_the_scatter_of_corrected_counts():
    """600 exposures with ideal references: the predicted variance of a pixel is the scatter of its values."""
    rng = np.random.default_rng(2)
    electrons = np.linspace(200, 14000, SHAPE[1]) * response()
    flat = response() / response().mean()
    references = ideal_references(flat)
    frames = Frames(as_frames([expose(electrons, rng) for _ in range(600)]))
    corrected = correct_frames(frames, references)
    good = np.ones(SHAPE, bool)
    good[HOT] = good[DEAD] = False
    scatter = corrected.signal.values[0].var(axis=0, ddof=1)
    predicted = corrected.signal_var.values[0].mean(axis=0)
    share = (scatter / predicted)[good]
    assert abs(share.mean() - 1) < 4 * share.std() / np.sqrt(share.size)
    npt.assert_allclose(corrected.signal.values[0].mean(axis=0)[good], (electrons / flat / GAIN)[good], rtol=0.02)


def ideal_references(flat):
    image = ("camera", "y", "x")
    both = (2, *SHAPE)
    bad = np.zeros(both, bool)
    bad[:, HOT[0], HOT[1]] = bad[:, DEAD[0], DEAD[1]] = True
    return References(
        xr.Dataset(
            {
                "dark": (image, np.full(both, OFFSET, np.float32)),
                "dark_var": (image, np.zeros(both, np.float32)),
                "flat": (image, np.broadcast_to(flat, both).astype(np.float32)),
                "flat_var": (image, np.zeros(both, np.float32)),
                "bad": (image, bad),
                "gain": ("camera", [GAIN, GAIN]),
                "read_noise": ("camera", [READ, READ]),
                "full_scale": ("camera", [4095, 4095]),
            }
        )
    )


def as_frames(images):
    counts = np.stack([images, images])
    return xr.Dataset({"counts": (("camera", "frame", "y", "x"), counts)}, {"camera": [1, 2]})


def test_saturated_dim_and_bad_pixels_are_flagged_and_bad_ones_filled():
    counts = np.full(SHAPE, 1500, np.uint16)
    counts[5, 6] = 4095
    counts[7, 8] = 66
    counts[HOT] = 3000
    corrected = correct_frames(Frames(as_frames([counts])), ideal_references(np.ones(SHAPE)), least_signal=100)
    flags = corrected.flags.values[0, 0]
    assert flags[5, 6] == Flag.SATURATED
    assert flags[7, 8] == Flag.DIM
    assert flags[HOT] == Flag.BAD_PIXEL
    assert flags[20, 20] == 0
    npt.assert_allclose(corrected.signal.values[0, 0][HOT], 1500 - OFFSET)


def test_camera_without_gain_or_flats_is_refused(fixture_dir):
    text = (fixture_dir / "fixture.toml").read_text().replace('flat = "flat.tif"', "")
    (fixture_dir / "fixture.toml").write_text(text)
    with pytest.raises(FrameError, match="camera1 has no gain"):
        measure_references(open_fixture(fixture_dir))
