"""Dark, flat and noise against counts drawn from known electrons."""

import numpy as np
import numpy.testing as npt
import pytest
import tifffile
import xarray as xr
from scipy.stats import norm

from erlif.core.flags import Flag
from erlif.core.notes import Level, join_notes
from erlif.core.products import Frames, References
from erlif.correction import correct_frames
from erlif.ingest import open_fixture
from erlif.pipeline.cameras import characterise_cameras

GAIN, READ, OFFSET = 4.4, 9.0, 64.0
SHAPE = (72, 80)
HOT, DEAD = (10, 12), (40, 50)


def warnings_of(cameras):
    return join_notes(note for note in cameras.notes if note.level == Level.WARNING)


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
    cameras = characterise_cameras(open_fixture(fixture_dir))
    references = cameras.references
    # 16 pages of 5760 pixels fix the read noise to 1/sqrt(2*15*5760) = 0.24 %, 24 flats the gain to about 0.4 %
    npt.assert_allclose(references.gain, GAIN, rtol=0.015)
    npt.assert_allclose(references.read_noise, READ, rtol=0.02)


def test_summary_names_values_and_their_uncertainties(fixture_dir):
    cameras = characterise_cameras(open_fixture(fixture_dir))
    references = cameras.references
    line = join_notes(cameras.notes).split("\n")[0]
    value, std = (
        float(part) for part in line.split("gain ")[1].split(" electron/DN")[0].split(" ± ")
    )
    assert line.startswith("camera1: gain ")
    assert abs(value - GAIN) < 4 * std
    assert 0.002 < std / GAIN < 0.01
    npt.assert_allclose(
        [value, std], [references.gain[0], references.gain_std[0]], atol=0.05 * GAIN / 100
    )
    assert "dark 64.0 DN" in line  # without the hot pixel; 400 DN of it in 5760 would make 64.1
    assert "saturation 4095 DN = 17." in line
    assert warnings_of(cameras) == ""


def test_characteristics_are_those_of_the_camera(fixture_dir):
    cameras = characterise_cameras(open_fixture(fixture_dir))
    references = cameras.references
    assert np.all(abs(references.read_noise - READ) < 4 * references.read_noise_std)
    assert np.all(abs(references.dark_signal - OFFSET) < 4 * references.dark_signal_std)
    # there is none; the variance of 5760 means over 16 pages, 4.27/16 DN2, is known to sqrt(2/5760) of itself
    assert np.all(references.dark_spread**2 < 4 * 4.27 / 16 * np.sqrt(2 / 5760))
    npt.assert_allclose(references.saturation_capacity, (4095 - OFFSET) * GAIN, rtol=0.02)
    # sin over a grid that no pixel repeats: 1 %/sqrt(2), set against neighbours that carry a wave of the same kind
    y, x = np.indices(SHAPE)
    wave = 0.01 * np.sin(1.7 * x + 2.3 * y)
    around = (
        sum(np.roll(wave, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j) / 8
    )
    expected = 1.4826 * np.median(np.abs((wave - around)[2:-2, 2:-2])) / np.sqrt(9 / 8)
    npt.assert_allclose(references.response_spread, expected, rtol=0.1)


def test_declared_gain_is_used_and_a_wrong_one_is_said(fixture_dir):
    write_settings(fixture_dir, 'gain = "6 electron/DN"')
    cameras = characterise_cameras(open_fixture(fixture_dir))
    references = cameras.references
    npt.assert_array_equal(references.gain, 6.0)
    assert "declared gain, 6 electron/DN, deviates by +36 %" in join_notes(cameras.notes)
    assert "declared gain, 6 electron/DN, deviates by +36 %" in warnings_of(cameras)
    npt.assert_allclose(references.gain_measured, GAIN, rtol=0.015)


def test_flat_follows_the_response(fixture_dir):
    cameras = characterise_cameras(open_fixture(fixture_dir))
    references = cameras.references
    flat = references.flat.values[0]
    expected = response() / response().mean()
    good = ~references.bad.values[0]
    deviation = (flat - expected)[good] / np.sqrt(references.flat_var.values[0][good])
    assert abs(deviation.mean()) < 0.1
    assert 0.9 < deviation.std() < 1.1


def test_hot_and_dead_pixels_are_found_and_few_others(fixture_dir):
    bad = characterise_cameras(open_fixture(fixture_dir)).references.bad.values[0]
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
    npt.assert_allclose(
        corrected.signal.values[0].mean(axis=0)[good], (electrons / flat / GAIN)[good], rtol=0.02
    )


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
    corrected = correct_frames(
        Frames(as_frames([counts])), ideal_references(np.ones(SHAPE)), least_signal=100
    )
    flags = corrected.flags.values[0, 0]
    assert flags[5, 6] == Flag.SATURATED
    assert flags[7, 8] == Flag.DIM
    assert flags[HOT] == Flag.BAD_PIXEL
    assert flags[20, 20] == 0
    npt.assert_allclose(corrected.signal.values[0, 0][HOT], 1500 - OFFSET)


def without_flat(directory):
    text = (directory / "fixture.toml").read_text().replace('flat = "flat.tif"', "")
    (directory / "fixture.toml").write_text(text)


def test_camera_without_gain_or_flats_waits_for_the_frames(fixture_dir):
    without_flat(fixture_dir)
    cameras = characterise_cameras(open_fixture(fixture_dir))
    references = cameras.references
    assert not references.gain_known.any()
    assert references.read_noise_known.all()
    assert "camera2: neither gain nor flats with two pages of one light level" in warnings_of(
        cameras
    )
    assert "camera1: no flat; vignetting" in warnings_of(cameras)
    # of a read noise that was declared in electrons nothing can be said before the gain is known
    write_settings(fixture_dir, f'read_noise = "{READ} electron"')
    without_flat(fixture_dir)
    notes = join_notes(characterise_cameras(open_fixture(fixture_dir)).notes)
    assert "camera1: gain not known yet, dark 64.0 DN, saturation 4095 DN\n" in notes
    assert "declared" not in notes


def write_darks(directory, count, rng):
    with tifffile.TiffWriter(directory / "dark.tif") as file:
        for _ in range(count):
            file.write(expose(0, rng), contiguous=False)


def test_two_dark_pages_give_an_unbiased_read_noise_and_condemn_no_pixel(fixture_dir):
    """The variance of two pages is a chi-square of one degree of freedom: a long tail that is no fault of the pixel."""
    write_darks(fixture_dir, 2, np.random.default_rng(3))
    cameras = characterise_cameras(open_fixture(fixture_dir))
    references = cameras.references
    assert np.all(references.bad.sum(("y", "x")) <= 6)
    # 5760 pixels, one degree of freedom each: 0.9 % of the read noise
    npt.assert_allclose(references.read_noise, READ, rtol=0.04)
    assert np.all(abs(references.read_noise - READ) < 4 * references.read_noise_std)


@pytest.mark.parametrize("sigma", [0.3, 0.4, 0.45])
def test_two_dark_pages_of_a_quiet_camera_condemn_no_pixel(fixture_dir, sigma):
    """Most pixels read the same count twice, and the median of their variances is zero."""
    found, condemned = [], 0
    for seed in range(4):
        rng = np.random.default_rng(seed)
        with tifffile.TiffWriter(fixture_dir / "dark.tif") as file:
            for _ in range(2):
                file.write(
                    np.rint(rng.normal(OFFSET, sigma, SHAPE)).astype(np.uint16), contiguous=False
                )
        cameras = characterise_cameras(open_fixture(fixture_dir))
        references = cameras.references.isel(camera=0)
        found.append(2 * float(references.dark_var.mean()))
        bad = references.bad.values.copy()
        bad[HOT] = bad[DEAD] = False
        condemned += int(bad.sum())
    assert condemned < 5e-4 * len(found) * np.prod(SHAPE)
    # the variance of a normal variate rounded to whole counts; 4 x 5760 pairs tell it to 1.6 % at worst
    counts = np.arange(-8, 9)
    expected = (counts**2 * np.diff(norm.cdf(np.arange(-8.5, 9), scale=sigma))).sum()
    npt.assert_allclose(np.mean(found), expected, rtol=0.05)


def test_a_single_dark_page_brings_its_noise_into_every_frame(fixture_dir):
    write_darks(fixture_dir, 1, np.random.default_rng(4))
    write_settings(fixture_dir, f'read_noise = "{READ} electron"')
    cameras = characterise_cameras(open_fixture(fixture_dir))
    references = cameras.references
    npt.assert_allclose(references.dark_var, (READ / GAIN) ** 2 + 1 / 12, rtol=0.03)
    # without darks in time, the declared read noise is taken off the photon transfer
    assert np.all(abs(references.gain - GAIN) < 4 * references.gain_std)


def test_read_noise_below_the_rounding_is_measured_without_complaint(fixture_dir):
    with tifffile.TiffWriter(fixture_dir / "dark.tif") as file:
        for _ in range(4):
            file.write(np.full(SHAPE, 64, np.uint16), contiguous=False)
    write_settings(fixture_dir, 'read_noise = "0.2 electron"')
    cameras = characterise_cameras(open_fixture(fixture_dir))
    references = cameras.references
    npt.assert_array_equal(references.read_noise_measured, 0.0)
    npt.assert_array_equal(references.read_noise, 0.2)


TOP = 3300


def test_saturation_below_full_scale_is_found_flagged_and_said(fixture_dir):
    """A camera whose counts stop at 3300: seen in bright flats, which are left out of gain and response."""
    rng = np.random.default_rng(5)
    with tifffile.TiffWriter(fixture_dir / "flat.tif") as file:
        for level in (3000, 7000, 15500):
            for _ in range(8):
                file.write(np.minimum(expose(level * response(), rng), TOP), contiguous=False)
    cameras = characterise_cameras(open_fixture(fixture_dir))
    references = cameras.references
    npt.assert_array_equal(references.full_scale, TOP)
    assert f"camera1: counts pile up at {TOP}, below full scale (4095)" in warnings_of(cameras)
    assert np.all(abs(references.gain - GAIN) < 4 * references.gain_std)
    frames = Frames(as_frames([np.minimum(expose(15500 * response(), rng), TOP)]))
    flags = correct_frames(frames, references).flags.values
    npt.assert_array_equal((flags & Flag.SATURATED) != 0, frames.counts.values == TOP)


def test_saturation_is_seen_in_frames_where_flats_are_dim(fixture_dir):
    rng = np.random.default_rng(6)
    speckle = 13000 * rng.gamma(40, 1 / 40, SHAPE)
    for n in (1, 2):
        tifffile.imwrite(
            fixture_dir / f"camera{n}" / "a.tif", np.minimum(expose(speckle, rng), 3300 + n)
        )
    cameras = characterise_cameras(open_fixture(fixture_dir))
    references = cameras.references
    npt.assert_array_equal(references.full_scale, [3301, 3302])


@pytest.mark.slow
def test_gain_of_many_cameras_scatters_as_its_uncertainty_says(fixture_dir):
    """100 pairs of cameras through files, 3 pages a level and a lamp that flickers by 2 %."""
    rng = np.random.default_rng(7)
    pulls = []
    for _ in range(100):
        with tifffile.TiffWriter(fixture_dir / "flat.tif") as file:
            for level in (4000, 11000):
                for _ in range(3):
                    file.write(
                        expose(level * rng.normal(1, 0.01) * response(), rng), contiguous=False
                    )
        cameras = characterise_cameras(open_fixture(fixture_dir))
        references = cameras.references
        pulls.append(float((references.gain[0] - GAIN) / references.gain_std[0]))
    inside = np.abs(pulls)
    # binomial scatter of 100: 4.7 % at one standard deviation, 2.2 % at two
    assert 0.683 - 0.14 < np.mean(inside < 1) < 0.683 + 0.14
    assert np.mean(inside < 2) > 0.954 - 0.066
    assert abs(np.mean(pulls)) < 0.3


def test_a_response_that_is_not_linear_is_said_and_a_linear_one_is_not(fixture_dir):
    assert "not straight" not in join_notes(characterise_cameras(open_fixture(fixture_dir)).notes)
    rng = np.random.default_rng(8)
    with tifffile.TiffWriter(fixture_dir / "flat.tif") as file:
        for level in (3000, 7000, 12000, 15000):
            for _ in range(16):
                light = expose(level * response(), rng).astype(float) - OFFSET
                file.write(
                    np.rint(light * (1 - 0.1 * light / 3400) + OFFSET).astype(np.uint16),
                    contiguous=False,
                )
    cameras = characterise_cameras(open_fixture(fixture_dir))
    references = cameras.references
    assert "camera1: the photon transfer curve is not straight" in warnings_of(cameras)
    # (1 - 2 u)^2/(1 - u) - 1 is -29 % at u = 0.1, the brightest pixels, and -26 % at the mean of the brightest level
    assert np.all((references.bend > -0.32) & (references.bend < -0.22))
