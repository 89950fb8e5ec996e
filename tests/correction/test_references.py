"""References of two cameras from what was measured, declared and estimated."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.notes import Level, join_notes
from erlif.correction import CameraNoise, DeclaredNoise, make_references, measure_camera

GAIN, READ, OFFSET = 4.4, 9.0, 64.0
HOT, DEAD = (10, 12), (40, 50)
LEVELS = (3000, 7000, 12000)


@pytest.fixture(scope="module")
def camera(simulated):
    return simulated(hot=(HOT,), dead=(DEAD,))


def reduce(camera, darks, flats):
    empty = np.zeros(4096, np.int64)
    return measure_camera(
        darks=darks, flats=flats, histogram=empty, shape=camera.shape, camera="camera1"
    )


def measure(camera, *, darks=16, pages=8, levels=LEVELS, seed=1):
    """A camera with so many dark pages, or its offset for none, and flats of these levels."""
    rng = np.random.default_rng(seed)
    taken = camera.darks(darks, rng) if darks else camera.offset
    return reduce(camera, taken, camera.flats(levels, pages, rng) if pages else ())


@pytest.fixture(scope="module")
def measured(camera):
    return measure(camera)


def combine(measured, *, estimated=None, **declared):
    given = DeclaredNoise(**declared)
    return make_references([measured] * 2, declared=[given] * 2, estimated=[estimated] * 2)


def warnings_of(cameras):
    return join_notes(note for note in cameras.notes if note.level == Level.WARNING)


def summary_of(cameras):
    return str(cameras.notes[0])


def test_gain_and_read_noise_are_those_of_the_camera(measured):
    references = combine(measured).references
    assert references.camera.values.tolist() == [1, 2]
    for name, truth in (("gain", GAIN), ("read_noise", READ), ("dark_signal", OFFSET)):
        own = references["dark_signal" if name == "dark_signal" else f"{name}_measured"]
        assert np.all(abs(own - truth) < 4 * references[f"{name}_std"])
    # 24 flats of 5760 pixels fix the gain to 0.4 %, 16 darks the read noise to 0.24 % beside it
    assert np.all((references.gain_std / GAIN > 0.002) & (references.gain_std / GAIN < 0.008))
    assert np.all((references.read_noise_std / READ > 0.002) & (references.read_noise_std < 0.1))
    npt.assert_array_equal(references.gain, references.gain_measured)
    assert references.gain_known.all()
    assert references.read_noise_known.all()


def test_read_noise_of_many_cameras_scatters_by_its_standard_deviation(simulated, check_coverage):
    """From 0.4 DN, where rounding matters, to 4 DN; the error of the gain enters as well."""
    rng = np.random.default_rng(2)
    pulls = []
    for seed in range(40):
        camera = simulated(shape=(24, 32), read_noise=rng.uniform(2, 18))
        references = combine(measure(camera, darks=6, pages=3, seed=seed)).references
        found, std = references.read_noise_measured[0], references.read_noise_std[0]
        pulls.append(float((found - camera.read_noise) / std))
    # of 40, 3.5 binomial standard deviations are 26 % at one sigma and 12 % at two
    check_coverage(pulls)


def test_images_and_characteristics_have_their_values(camera, measured):
    references = combine(measured).references.isel(camera=0)
    good = ~references.bad.values
    npt.assert_allclose(references.dark.values[good], OFFSET, atol=5 * np.sqrt(4.27 / 16))
    npt.assert_allclose(references.dark_var, measured.darks.temporal_var / 16, rtol=1e-6)
    truth = camera.response / camera.response.mean()
    pull = ((references.flat - truth) / np.sqrt(references.flat_var)).values[good]
    assert abs(pull.mean()) < 0.1
    assert 0.95 < pull.std() < 1.05
    npt.assert_allclose(
        references.saturation_capacity, (4095 - references.dark_signal) * references.gain
    )
    assert references.full_scale == 4095
    assert references.has_flat
    assert references.dark.dtype == np.float32


@pytest.mark.parametrize(("factor", "reported"), [(0.8, True), (0.93, False), (1.2, True)])
def test_declared_values_that_deviate_by_more_than_10_percent_are_reported(
    measured, factor, reported
):
    own = float(combine(measured).references.gain_measured[0])
    warning = warnings_of(combine(measured, gain=own * factor))
    words = f"camera1: the declared gain, {own * factor:g} electron/DN, deviates by"
    assert (words in warning) == (f"{100 * (factor - 1):+.0f} %" in warning) == reported
    cameras = combine(measured, read_noise=READ * factor)
    assert ("differs from the measured one" in warnings_of(cameras)) == reported
    assert f"(declared {READ * factor:g})" in summary_of(cameras)


@pytest.mark.parametrize("read_noise", [20.0, 60.0])
def test_without_darks_the_declared_read_noise_is_part_of_the_photon_transfer(
    simulated, read_noise
):
    """The variance of 20 electrons is an eighth of that of the dimmest level, of 60 all of it."""
    camera = simulated(read_noise=read_noise)
    references = combine(measure(camera, darks=0), read_noise=read_noise).references
    assert np.all(abs(references.gain - GAIN) < 4 * references.gain_std)
    npt.assert_array_equal(references.dark_var, 0.0)
    npt.assert_array_equal(references.read_noise, read_noise)


def test_a_single_dark_page_brings_the_noise_of_a_page_into_every_frame(camera):
    references = combine(measure(camera, darks=1), read_noise=READ).references
    gain = references.gain.values[:, None, None]
    page = np.broadcast_to((READ / gain) ** 2 + 1 / 12, (2, 72, 80))
    npt.assert_allclose(references.dark_var, page, rtol=1e-6)


def test_read_noise_below_the_rounding_is_measured_as_zero(camera):
    flats = camera.flats(LEVELS, 4, np.random.default_rng(3))
    quiet = reduce(camera, [np.full(camera.shape, 64, np.uint16)] * 4, flats)
    references = combine(quiet, read_noise=0.2).references
    npt.assert_array_equal(references.read_noise_measured, 0.0)
    npt.assert_array_equal(references.read_noise, 0.2)
    npt.assert_allclose(combine(quiet).references.read_noise, 0.0)


def test_gain_without_flats_and_read_noise_without_darks_are_assumed(camera):
    cameras = combine(measure(camera, pages=0))
    references = cameras.references
    npt.assert_allclose(references.gain, 16000 / 4095)
    assert np.isnan(references.gain_measured).all()
    assert not references.gain_known.any()
    assert references.read_noise_known.all()
    assert not references.has_flat.any()
    npt.assert_array_equal(references.flat, 1)
    npt.assert_array_equal(references.flat_var, 0)
    warning = warnings_of(cameras)
    assert "camera2: neither gain nor flats with two pages of one light level" in warning
    assert "camera1: no flat; vignetting" in warning

    cameras = combine(measure(camera, darks=0, pages=0), gain=4.4)
    npt.assert_array_equal(cameras.references.read_noise, 10.0)
    assert not cameras.references.read_noise_known.any()
    assert cameras.references.gain_known.all()
    assert "neither read noise nor two dark pages" in warnings_of(cameras)
    words = "gain 4.4 electron/DN (declared), read noise 10 electron (assumed)"
    assert words in summary_of(cameras)


def test_an_estimate_from_the_frames_replaces_the_assumptions(camera):
    noise = CameraNoise(4.1, 0.2, 8.0, 0.5, response_spread=0.012)
    cameras = combine(measure(camera, darks=0, pages=0), estimated=noise)
    references = cameras.references
    for name, value in (("gain", 4.1), ("read_noise", 8.0)):
        npt.assert_array_equal(references[name], value)
        npt.assert_array_equal(references[f"{name}_measured"], value)
        assert references[f"{name}_known"].all()
    npt.assert_array_equal(references.gain_std, 0.2)
    npt.assert_array_equal(references.read_noise_std, 0.5)
    # a response that no flat corrects is an error of its own size, the same in every frame
    npt.assert_allclose(references.flat_var, 0.012**2, rtol=1e-6)
    npt.assert_allclose(references.response_spread, 0.012)
    assert "will be estimated" not in warnings_of(cameras)


def test_measured_and_declared_values_take_precedence_over_an_estimate(measured, camera):
    noise = CameraNoise(40.0, 1.0, 80.0, 1.0, response_spread=0.5)
    references = combine(measured, estimated=noise, gain=4.5, read_noise=9.2).references
    npt.assert_array_equal(references.gain, 4.5)
    npt.assert_array_equal(references.read_noise, 9.2)
    npt.assert_allclose(references.gain_measured, GAIN, rtol=0.015)
    # in electrons, with the gain in use
    npt.assert_allclose(references.read_noise_measured, READ * 4.5 / 4.4, rtol=0.02)
    references = combine(measured, estimated=noise).references
    npt.assert_allclose(references.gain, GAIN, rtol=0.015)
    npt.assert_allclose(references.read_noise, READ, rtol=0.02)
    assert np.all(references.response_spread < 0.02)
    bare = combine(measure(camera, darks=0, pages=0), estimated=noise, gain=5.0, read_noise=7.0)
    npt.assert_array_equal(bare.references.gain, 5.0)
    npt.assert_array_equal(bare.references.read_noise, 7.0)
    assert np.isnan(bare.references.gain_measured).all()


def test_saturation_below_full_scale_is_reported_and_used(simulated):
    """A camera whose counts stop at 3300: bright flats show it and are left out of the gain."""
    camera = simulated(top=3300)
    cameras = combine(measure(camera, levels=(3000, 7000, 15500)))
    references = cameras.references
    npt.assert_array_equal(references.full_scale, 3300)
    warning = warnings_of(cameras)
    assert "camera1: counts pile up at 3300, below full scale (4095)" in warning
    assert np.all(abs(references.gain - GAIN) < 4 * references.gain_std)
    npt.assert_allclose(references.saturation_capacity, (3300 - 64) * GAIN, rtol=0.02)


def test_a_response_that_is_not_linear_is_reported_and_a_linear_one_is_not(simulated, measured):
    assert "not straight" not in join_notes(combine(measured).notes)
    rng = np.random.default_rng(8)
    camera = simulated()
    flats = []
    for page in camera.flats((3000, 7000, 12000, 15000), 16, rng):
        light = page - OFFSET
        flats.append(np.rint(light * (1 - 0.1 * light / 3400) + OFFSET).astype(np.uint16))
    cameras = combine(reduce(camera, camera.darks(16, rng), flats))
    assert "camera1: the photon transfer curve is not straight" in warnings_of(cameras)
    # (1 - 2 u)^2/(1 - u) - 1 is -29 % at u = 0.1, the brightest pixels, and -26 % at their mean
    bend = cameras.references.bend
    assert np.all((bend > -0.32) & (bend < -0.22))
    assert f"changes by {100 * float(bend[0]):+.1f} ±" in warnings_of(cameras)
