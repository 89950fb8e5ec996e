"""Corrected frames: closed forms for every pixel, and the scatter of many exposures."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.pair import references_of

from erlif.core.flags import Flag
from erlif.core.products import Frames
from erlif.correction import correct_frames

SHAPE = (24, 30)
DRY = {"background_var": 0.0, "background_recorded": (True, True)}


def make_frames(*images):
    """The same images for both cameras."""
    counts = np.stack([np.stack(images)] * 2).astype(np.uint16)
    coords = {"camera": [1, 2], "frame": 10 + np.arange(len(images))}
    return Frames(xr.Dataset({"counts": (("camera", "frame", "y", "x"), counts)}, coords))


def flat_frame(counts=1064, shape=SHAPE):
    return np.full(shape, counts)


def test_signal_is_light_above_dark_over_the_response():
    flat, dark = np.linspace(0.5, 1.5, 30), np.linspace(60.0, 90.0, 24)[:, None]
    corrected = correct_frames(
        make_frames(flat_frame()), references_of(SHAPE, flat=flat, dark=dark)
    )
    expected = (1064 - dark) / flat * np.ones(SHAPE)
    npt.assert_allclose(corrected.signal[0, 0], expected, rtol=1e-6)
    assert corrected.signal.attrs["units"] == "DN"
    assert corrected.signal.dims == ("camera", "frame", "y", "x")
    assert corrected.frame.values.tolist() == [10]


def test_variances_are_those_of_each_camera_in_closed_form():
    """Shot noise, reading and rounding; the light has the derivatives -1/flat and -light/flat."""
    flat = np.linspace(0.5, 1.5, 30) * np.ones(SHAPE)
    references = references_of(
        SHAPE, flat=flat, dark_var=0.3, flat_var=1e-4, gain=(2.0, 8.0), read_noise=(0.0, 16.0)
    )
    corrected = correct_frames(make_frames(flat_frame()), references)
    for n, new in enumerate((500 + 1 / 12, 125 + 4 + 1 / 12)):
        npt.assert_allclose(corrected.signal_var[n, 0], new / flat**2, rtol=1e-6)
        fixed = 0.3 / flat**2 + 1e-4 * (1000 / flat**2) ** 2
        npt.assert_allclose(corrected.signal_var_fixed[n, 0], fixed, rtol=1e-6)


@pytest.mark.parametrize(
    ("counts", "least", "flag"),
    [
        (3299, 100, 0),
        (3300, 100, Flag.SATURATED),
        (4095, 100, Flag.SATURATED),
        (87, 100, 0),  # 100 electrons are 22.7 DN, 86.7 with the dark
        (86, 100, Flag.DIM),
        (64, 100, Flag.DIM),
        (86, 90, 0),
    ],
)
@pytest.mark.parametrize("flat", [1.0, 0.5])
def test_saturated_and_dim_pixels_are_flagged_by_their_counts(counts, least, flag, flat):
    """The electrons of the pixel decide on its noise, not the light that a better one would see."""
    references = references_of(SHAPE, full_scale=(3300, 3300), flat=flat)
    corrected = correct_frames(make_frames(flat_frame(counts)), references, least_signal=least)
    assert (corrected["flags"] == flag).all()


@pytest.mark.parametrize("reach", [1, 2, 4, 5])
def test_a_defect_is_filled_from_up_to_five_rings(reach):
    """The middle of a square of 2 n + 1 bad pixels is n + 1 rings from the nearest good ones."""
    image = flat_frame(2064)
    square = [(i, j) for i in range(12 - reach, 13 + reach) for j in range(15 - reach, 16 + reach)]
    for pixel in square:
        image[pixel] = 3000
    references = references_of(SHAPE, bad=square)
    filled = correct_frames(make_frames(image), references).signal.values[0, 0]
    npt.assert_allclose(filled[12, 15], 2000 if reach < 5 else 2936)
    npt.assert_allclose(filled[12 - reach, 15], 2000)


def test_variance_matches_the_scatter_of_corrected_counts(simulated, check_coverage):
    """400 exposures with ideal references: the predicted variance is that of the values."""
    rng, camera = np.random.default_rng(2), simulated(shape=SHAPE)
    electrons = np.linspace(200, 14000, SHAPE[1]) * camera.response
    flat = camera.response / camera.response.mean()
    frames = make_frames(*(camera.expose(electrons, rng) for _ in range(400)))
    corrected = correct_frames(frames, references_of(SHAPE, flat=flat)).isel(camera=0)
    truth = electrons / flat / camera.gain
    signal, variance = corrected.signal.values, corrected.signal_var.values
    # 720 pixels, 400 times each; the pulls are those of discrete counts, hence the wider bound
    check_coverage((signal - truth) / np.sqrt(variance), sigmas=6)
    ratio = signal.var(axis=0, ddof=1) / variance.mean(axis=0)
    # a variance of 400 values is known to 7 %, the mean over 720 pixels to 0.26 %
    assert abs(ratio.mean() - 1) < 4 * np.sqrt(2 / 399 / ratio.size)
    npt.assert_allclose(signal.mean(), truth.mean(), rtol=1e-3)


def test_background_is_scaled_by_the_pulse_energy_between_dark_and_flat():
    """light = (1064 - 64 - energy * 20)/0.8; a frame without energy has the mean one."""
    references = references_of(SHAPE, flat=0.8, background=20.0, **DRY)
    frames = make_frames(flat_frame(), flat_frame()).assign_coords(
        pulse_energy=("frame", [1.0, 1.5])
    )
    corrected = correct_frames(frames, references)
    npt.assert_allclose(corrected.signal[0, 0], 980 / 0.8, rtol=1e-6)
    npt.assert_allclose(corrected.signal[1, 1], 970 / 0.8, rtol=1e-6)
    without = correct_frames(frames.drop_vars("pulse_energy"), references)
    npt.assert_allclose(without.signal, 980 / 0.8, rtol=1e-6)

    # photons of the background are noise like those of the film
    new = (1000 / 4.4 + (9 / 4.4) ** 2 + 1 / 12) / 0.64
    npt.assert_allclose(corrected.signal_var, new, rtol=1e-6)


@pytest.mark.parametrize("energy", [0.7, 1.0, 1.4])
def test_scatter_of_dark_and_dry_pages_is_the_fixed_variance(energy):
    """Light of one frame, corrected with many drawn darks and dry joints."""
    rng, dark_var, page_var = np.random.default_rng(3), 4.0, 9.0
    dark = 64 + np.sqrt(dark_var) * rng.standard_normal((100, 120))
    page = 84 + np.sqrt(page_var) * rng.standard_normal(dark.shape)
    images = {"dark": dark, "dark_var": dark_var, "background": page - dark}
    references = references_of(dark.shape, **images, **{**DRY, "background_var": page_var})
    frames = make_frames(flat_frame(1064, dark.shape)).assign_coords(
        pulse_energy=("frame", [energy])
    )
    corrected = correct_frames(frames, references)
    light, variance = corrected.signal.values[0, 0], corrected.signal_var_fixed.values[0, 0]
    npt.assert_allclose(light.mean(), 1000 - 20 * energy, atol=4 * np.sqrt(variance.mean() / 12000))
    npt.assert_allclose(light.var(), variance.mean(), rtol=4 * np.sqrt(2 / 12000))


def test_a_pixel_is_dim_by_the_light_of_its_film():
    frames = make_frames(flat_frame(64 + 510))
    dry = references_of(SHAPE, background=500.0, **DRY)
    for known, flag in ((references_of(SHAPE), 0), (dry, Flag.DIM)):
        assert (correct_frames(frames, known)["flags"] == flag).all()
