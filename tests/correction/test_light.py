"""Counts to light, held to the plain correction."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.pair import EPS, camera_noise, references_of, scene
from scenes.plain import block_light, correct_frames

from erlif.core.flags import Flag
from erlif.core.products import Frames, References
from erlif.correction.light import PairLight, fill_noise, measure_light, tabulate
from erlif.registration.normalise import binned


def recording(shape, seed=5, dtype=np.uint16, full_scale=4095, dry=False):
    """Counts and references with bad, saturated and dim pixels, one of them at the corner."""
    rng, dims, size = np.random.default_rng(seed), ("camera", "y", "x"), (2, *shape)
    images = {
        "dark": rng.uniform(full_scale / 64, full_scale / 60, size),
        "dark_var": rng.uniform(0.05, 0.1, size),
        "flat": rng.normal(1, 0.02, size),
        "flat_var": rng.uniform(1e-6, 2e-6, size),
    }
    bad = rng.uniform(size=size) < 0.02
    bad[:, 0, 0] = True
    scalars = {"gain": [4.4, 4.1], "read_noise": [9.0, 11.0], "full_scale": [full_scale] * 2}
    if dry:
        images |= {
            "background": rng.uniform(10, 40, size),
            "background_var": rng.uniform(1, 4, size),
        }
        scalars |= {"background_recorded": [True, False]}
    references = references_of(shape, **images, **scalars).assign(bad=(dims, bad))

    counts = np.clip(rng.normal(full_scale / 2, full_scale / 4, size), 0, full_scale)
    counts[:, :, : shape[1] // 3] *= 0.05  # about the level of the dark
    return counts.astype(dtype), References(references)


def plain(counts, references, least_signal=100.0):
    frames = xr.Dataset({"counts": (("camera", "frame", "y", "x"), counts[:, None])})
    return correct_frames(Frames(frames), references, least_signal=least_signal).isel(frame=0)


@pytest.mark.parametrize("shape", [(48, 64), (37, 51), (3, 5), (8, 1), (131, 51), (66, 9)])
@pytest.mark.parametrize(("dtype", "full_scale"), [(np.uint16, 4095), (np.uint8, 255)])
def test_light_is_that_of_the_plain_correction(shape, dtype, full_scale):
    counts, references = recording(shape, dtype=dtype, full_scale=full_scale)
    found = measure_light(counts, tabulate(references, least_signal=100.0))
    expected = plain(counts, references)
    npt.assert_array_equal(found.flags, expected["flags"].values)
    npt.assert_array_equal(found.peaks, counts.max(axis=(1, 2)))

    # half a unit of the last place for each operation: 3 in the light, 7 and 9 in the variances;
    # below the dark, light is a difference, which single precision has exactly here
    bad = references.bad.values
    npt.assert_allclose(found.light[~bad], expected.signal.values[~bad], rtol=3 * EPS)
    largest = 2 * float(np.abs(found.light).max())  # a filled pixel has the rounding of the others
    npt.assert_allclose(found.light, expected.signal.values, rtol=0, atol=3 * EPS * largest)
    npt.assert_allclose(found.variance, expected.signal_var.values, rtol=5 * EPS)
    npt.assert_allclose(found.variance_fixed, expected.signal_var_fixed.values, rtol=6 * EPS)


def test_excluded_pixels_of_camera_1_have_no_light_and_the_others_that_of_before():
    counts, references = recording((64, 80))
    excluded = np.zeros((64, 80), bool)
    excluded[16:40, 30:50] = True
    before = measure_light(counts, tabulate(references, least_signal=100.0))
    found = measure_light(counts, tabulate(references, least_signal=100.0, excluded=excluded))

    npt.assert_array_equal(found.flags[0] & Flag.MASKED > 0, excluded)
    npt.assert_array_equal(found.flags & ~np.uint16(Flag.MASKED), before.flags)
    assert np.isnan(found.light[0][excluded]).mean() > 0.95  # bad pixels are filled at the edge
    npt.assert_array_equal(found.light[1], before.light[1])
    far = ~excluded & ~references.bad.values[0]
    npt.assert_array_equal(found.light[0][far], before.light[0][far])
    assert not found.half_weight[0, 8:20, 15:25].any()
    assert np.isfinite(references.dark.values).all()  # they serve other settings, too


def test_threshold_of_dim_light_is_exact():
    """Light of exactly the threshold is not dim, one count less is."""
    counts, references = recording((4, 6))
    references["dark"][:] = 64.0
    references["gain"][:] = 4.0
    counts[:] = 64 + 25
    counts[:, 1] -= 1
    found = measure_light(counts, tabulate(references, least_signal=100.0))
    npt.assert_array_equal(
        found.flags & Flag.DIM > 0, np.broadcast_to(np.arange(4)[:, None] == 1, (2, 4, 6))
    )


@pytest.mark.parametrize("shape", [(48, 64), (37, 51), (2, 9), (131, 51), (66, 9)])
def test_binned_light_and_blocks_are_means(shape):
    counts, references = recording(shape, seed=6)
    found = measure_light(counts, tabulate(references, least_signal=100.0))
    for n in range(2):
        usable = found.flags[n] & (Flag.SATURATED | Flag.BAD_PIXEL) == 0
        half, weight = binned(found.light[n], usable.astype(np.float32), 2)
        npt.assert_array_equal(found.half_weight[n], weight)
        npt.assert_allclose(found.half[n], half, rtol=0, atol=4 * EPS * found.light.max())

        # a sum of 64 terms is rounded at most 64 times
        light, blocks = found.light[n], found.blocks[n]
        npt.assert_allclose(blocks, block_light(light), rtol=0, atol=64 * EPS * light.max())


@pytest.mark.parametrize("dry", [False, True])
def test_light_alone_is_the_same_without_memory_for_the_noise(dry):
    counts, references = recording((16, 24), dry=dry)
    tables = tabulate(references, least_signal=100.0)
    out = measure_light(counts, tables, out=PairLight.empty((16, 24), with_noise=False))
    full = measure_light(counts, tables)
    for name in ("light", "flags", "half", "half_weight", "blocks", "peaks"):
        npt.assert_array_equal(getattr(out, name), getattr(full, name))
    assert out.variance.size == out.variance_fixed.size == 0


# variances, held to the equations in double precision

NOISY = (37, 51)


def fill(light, noise, energy=1.0):
    kept = np.zeros((2, *light.shape), np.float32)
    fill_noise(light, tuple(noise), np.float32(energy), *kept, 0, light.shape[0])
    return kept


@pytest.mark.parametrize(("recorded", "energy"), [(1.0, 1.2), (0.0, 0.8)])
def test_dry_joint_adds_its_shot_noise_and_that_of_its_page(recorded, energy):
    """Light is (counts - dark - energy (page - dark))/flat: derivatives by dark, page and flat."""
    rng = np.random.default_rng(3)
    light, noise = scene(NOISY).light[0], camera_noise(NOISY)[0]
    dry, page = (rng.uniform(low, 2 * low, NOISY).astype(np.float32) for low in (20, 0.3))
    per_gain, read_var, _ = noise.numbers.tolist()
    numbers = np.array([per_gain, read_var, recorded], np.float32)
    found = fill(light, noise._replace(dry_light=dry, dry_var=page, numbers=numbers), energy)
    scale, seen = noise.per_flat.astype(float), light + energy * dry.astype(float)
    new = (seen / scale * per_gain + read_var) * scale**2
    of_dark = (1 - energy * recorded) ** 2 * noise.dark_var * scale**2
    repeated = of_dark + energy**2 * page + light.astype(float) ** 2 * noise.flat_var
    npt.assert_allclose(found, [new, repeated], rtol=6 * EPS)
