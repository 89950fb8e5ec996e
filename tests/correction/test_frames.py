"""Corrected frames: closed forms for every pixel, and the scatter of many exposures."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.core.flags import Flag
from erlif.core.products import Frames, References
from erlif.correction import correct_frames

SHAPE = (24, 30)
IMAGE = ("camera", "y", "x")


def make_references(shape=SHAPE, *, bad=(), **changes):
    """Ideal references, with images or pairs of scalars replaced by name."""
    values = {"dark": 64.0, "dark_var": 0.0, "flat": 1.0, "flat_var": 0.0}
    values |= {"gain": (4.4, 4.4), "read_noise": (9.0, 9.0), "full_scale": (4095, 4095)} | changes
    mask = np.zeros((2, *shape), bool)
    for pixel in bad:
        mask[(slice(None), *pixel)] = True
    data = {"bad": (IMAGE, mask)}
    for name, value in values.items():
        if name in ("gain", "read_noise", "full_scale"):
            data[name] = ("camera", list(value))
        else:
            data[name] = (IMAGE, np.broadcast_to(value, (2, *shape)).astype(np.float32))
    return References(xr.Dataset(data, {"camera": [1, 2]}))


def make_frames(*images):
    """The same images for both cameras."""
    counts = np.stack([np.stack(images)] * 2).astype(np.uint16)
    coords = {"camera": [1, 2], "frame": 10 + np.arange(len(images))}
    return Frames(xr.Dataset({"counts": (("camera", "frame", "y", "x"), counts)}, coords))


def flat_frame(counts=1064, shape=SHAPE):
    return np.full(shape, counts)


# values


def test_signal_is_light_above_dark_over_the_response():
    flat, dark = np.linspace(0.5, 1.5, 30), np.linspace(60.0, 90.0, 24)[:, None]
    corrected = correct_frames(make_frames(flat_frame()), make_references(flat=flat, dark=dark))
    expected = (1064 - dark) / flat * np.ones(SHAPE)
    npt.assert_allclose(corrected.signal[0, 0], expected, rtol=1e-6)
    assert corrected.signal.attrs["units"] == "DN"
    assert corrected.signal.dims == ("camera", "frame", "y", "x")
    assert corrected.frame.values.tolist() == [10]


def test_variances_are_those_of_each_camera_in_closed_form():
    """Shot noise, reading and rounding; the light has the derivatives -1/flat and -light/flat."""
    flat = np.linspace(0.5, 1.5, 30) * np.ones(SHAPE)
    references = make_references(
        flat=flat, dark_var=0.3, flat_var=1e-4, gain=(2.0, 8.0), read_noise=(0.0, 16.0)
    )
    corrected = correct_frames(make_frames(flat_frame()), references)
    for n, new in enumerate((500 + 1 / 12, 125 + 4 + 1 / 12)):
        npt.assert_allclose(corrected.signal_var[n, 0], new / flat**2, rtol=1e-6)
        fixed = 0.3 / flat**2 + 1e-4 * (1000 / flat**2) ** 2
        npt.assert_allclose(corrected.signal_var_fixed[n, 0], fixed, rtol=1e-6)


# flags


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
    references = make_references(full_scale=(3300, 3300), flat=flat)
    corrected = correct_frames(make_frames(flat_frame(counts)), references, least_signal=least)
    assert (corrected["flags"] == flag).all()


# bad pixels


@pytest.mark.parametrize("reach", [1, 2, 4, 5])
def test_a_defect_is_filled_from_up_to_five_rings(reach):
    """The middle of a square of 2 n + 1 bad pixels is n + 1 rings from the nearest good ones."""
    image = flat_frame(2064)
    square = [(i, j) for i in range(12 - reach, 13 + reach) for j in range(15 - reach, 16 + reach)]
    for pixel in square:
        image[pixel] = 3000
    references = make_references(SHAPE, bad=square)
    filled = correct_frames(make_frames(image), references).signal.values[0, 0]
    npt.assert_allclose(filled[12, 15], 2000 if reach < 5 else 2936)
    npt.assert_allclose(filled[12 - reach, 15], 2000)


# scatter


def test_variance_matches_the_scatter_of_corrected_counts(simulated, check_coverage):
    """400 exposures with ideal references: the predicted variance is that of the values."""
    rng, camera = np.random.default_rng(2), simulated(shape=SHAPE)
    electrons = np.linspace(200, 14000, SHAPE[1]) * camera.response
    flat = camera.response / camera.response.mean()
    frames = make_frames(*(camera.expose(electrons, rng) for _ in range(400)))
    corrected = correct_frames(frames, make_references(flat=flat)).isel(camera=0)
    truth = electrons / flat / camera.gain
    signal, variance = corrected.signal.values, corrected.signal_var.values
    # 720 pixels, 400 times each; the pulls are those of discrete counts, hence the wider bound
    check_coverage((signal - truth) / np.sqrt(variance), sigmas=6)
    ratio = signal.var(axis=0, ddof=1) / variance.mean(axis=0)
    # a variance of 400 values is known to 7 %, the mean over 720 pixels to 0.26 %
    assert abs(ratio.mean() - 1) < 4 * np.sqrt(2 / 399 / ratio.size)
    npt.assert_allclose(signal.mean(), truth.mean(), rtol=1e-3)


# light that is not film


def with_background(references, light, variance=0.0, *, recorded=True):
    image = {"dims": IMAGE, "coords": references.dark.coords}
    full = np.broadcast_to(light, references.dark.shape).astype(np.float32)
    return References(
        references.assign(
            background=xr.DataArray(full, **image),
            background_var=xr.full_like(references.dark, variance),
            background_recorded=("camera", [recorded] * 2),
        )
    )


def test_background_is_scaled_by_the_pulse_energy_between_dark_and_flat():
    """light = (1064 - 64 - energy * 20)/0.8; a frame without energy has the mean one."""
    references = with_background(make_references(flat=0.8), 20.0)
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
    references = with_background(
        make_references(dark.shape, dark=dark, dark_var=dark_var), page - dark, page_var
    )
    frames = make_frames(flat_frame(1064, dark.shape)).assign_coords(
        pulse_energy=("frame", [energy])
    )
    corrected = correct_frames(frames, references)
    light, variance = corrected.signal.values[0, 0], corrected.signal_var_fixed.values[0, 0]
    npt.assert_allclose(light.mean(), 1000 - 20 * energy, atol=4 * np.sqrt(variance.mean() / 12000))
    npt.assert_allclose(light.var(), variance.mean(), rtol=4 * np.sqrt(2 / 12000))


def test_a_pixel_is_dim_by_the_light_of_its_film():
    frames, references = make_frames(flat_frame(64 + 510)), make_references()
    for known, flag in ((references, 0), (with_background(references, 500.0), Flag.DIM)):
        assert (correct_frames(frames, known)["flags"] == flag).all()
