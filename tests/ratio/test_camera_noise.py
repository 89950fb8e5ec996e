"""Noise of cameras from their frames, on counted photons whose gain is known."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.pair import map_with, ratio_images, references_of, unknown
from scenes.plain import soften
from scipy import ndimage, signal

from erlif.core.errors import FrameError
from erlif.core.products import AlignedFrames
from erlif.ratio import BlurDifference, NoiseView, estimate_camera_noise
from erlif.ratio.camera_noise import _convolve, _overlap
from erlif.ratio.softening import Softening
from erlif.registration import interpolation_variance_factor

GAIN = 4.4  # [electron/DN]
SHAPE = (256, 320)
ROWS, COLUMNS = (np.linspace(0, 1, n) for n in SHAPE)
LIGHT = np.stack(
    [200 + 2800 * COLUMNS * np.ones((SHAPE[0], 1)), 200 + 2000 * np.outer(ROWS, COLUMNS)]
)
"""Light of the two cameras, (camera, y, x). [DN]"""
CELLS = (SHAPE[0] // 8, SHAPE[1] // 8)


def views(
    rng, *, gains=(GAIN, GAIN), read=(0.0, 0.0), frames=4, pattern=None, drift=0, light=LIGHT
):
    """Frames of two cameras, pixel on pixel; camera 2 drifts along x by whole pixels per frame.

    `read` is the read noise [DN], `pattern` the relative response of camera 2 on its own pixels.
    """
    for n in range(frames):
        counts = [
            rng.poisson(gain * image) / gain + rng.normal(0, std, SHAPE)
            for image, gain, std in zip(light, gains, read, strict=True)
        ]
        if pattern is not None:
            counts[1] *= np.roll(pattern, -n * drift, axis=1)
        place = np.zeros((2, *CELLS))
        place[0] = n * drift
        one, two = (np.rint(image) for image in counts)
        yield NoiseView(np.log(two / one), 1 / light, 1 / light**2, place)


def references(gain=(2.0, 2.0)):
    """Gains are an assumption where they are to be estimated."""
    return references_of(SHAPE, gain=gain, read_noise=(0.0, 0.0))


def estimate(taken, what, known=None, frames=4, blur=None):
    known = references() if known is None else known
    blur = BlurDifference() if blur is None else blur
    return estimate_camera_noise(taken, what, references=known, blur=blur, frames=frames)


def test_unequal_gains_are_distinguished():
    taken = views(np.random.default_rng(2), gains=(GAIN, GAIN / 2), frames=8)
    found = estimate(taken, unknown(gain=(True, True)), frames=8)
    for camera, gain in zip(found.cameras, (GAIN, GAIN / 2), strict=True):
        assert abs(camera.gain - gain) < 3.5 * camera.gain_std


def test_gain_of_one_camera_follows_from_that_of_the_other():
    taken = views(np.random.default_rng(3), gains=(GAIN, GAIN / 2))
    found = estimate(taken, unknown(gain=(False, True)), references(gain=(GAIN, 2.0)))
    one, two = found.cameras
    assert one.gain == GAIN
    assert one.gain_std == 0
    assert abs(two.gain - GAIN / 2) < 3 * two.gain_std < 0.1 * GAIN
    assert np.isnan(found.alike)


def test_read_noise_of_both_cameras_is_found():
    """Read noise of 6 DN, in electrons after the gain; the logarithm is nearly linear in it."""
    taken = views(np.random.default_rng(4), read=(6.0, 6.0))
    known = references(gain=(GAIN, GAIN))
    found = estimate(taken, unknown(read_noise=(True, True)), known)
    for camera in found.cameras:
        assert abs(camera.read_noise - 6.0 * GAIN) < 3 * camera.read_noise_std
        assert camera.read_noise_std < 0.1 * 6.0 * GAIN


def test_noise_that_a_blur_averages_is_taken_for_whole_shot_noise():
    """The blur mixes the noise of neighbours; the gains stay those of the cameras."""
    blur = BlurDifference(0.5, -0.3, 0.01, 0.01)
    taps, sound = Softening.of(blur).taps, np.zeros(SHAPE)
    rng = np.random.default_rng(19)
    taken = []
    for _ in range(6):
        one, two = (np.rint(rng.poisson(GAIN * image) / GAIN) for image in LIGHT)
        log_ratio = np.log(soften(two, sound, taps[1]) / soften(one, sound, taps[0]))
        taken.append(NoiseView(log_ratio, 1 / LIGHT, 1 / LIGHT**2, np.zeros((2, *CELLS))))
    found = estimate(taken, unknown(gain=(True, True)), frames=6, blur=blur)
    for camera in found.cameras:
        assert abs(camera.gain - GAIN) < 3 * camera.gain_std < 0.1 * GAIN


def test_a_camera_that_drifts_shows_the_spread_of_its_response():
    pattern = 1 + 0.01 * np.random.default_rng(9).standard_normal(SHAPE)
    taken = views(np.random.default_rng(10), pattern=pattern, drift=1)
    known = references(gain=(GAIN, GAIN))
    found = estimate(taken, unknown(response=(True, True)), known)
    npt.assert_allclose([c.response_spread for c in found.cameras], 0.01, rtol=0.05)


def test_cameras_at_rest_do_not_determine_the_spread_of_the_response():
    pattern = 1 + 0.01 * np.random.default_rng(11).standard_normal(SHAPE)
    taken = views(np.random.default_rng(12), pattern=pattern)
    found = estimate(taken, unknown(gain=(True, True), response=(True, True)))
    assert all(np.isnan(camera.response_spread) for camera in found.cameras)
    assert all(abs(camera.gain - GAIN) < 3 * camera.gain_std for camera in found.cameras)


def test_a_single_frame_leaves_the_response_open_and_does_not_determine_the_gain():
    taken = list(views(np.random.default_rng(14), frames=1))
    assert estimate(taken, unknown(response=(False, True)), frames=1) is None
    message = "frames with enough light and overlap, got 1 with 0 usable"
    with pytest.raises(FrameError, match=message):
        estimate(taken, unknown(gain=(False, True)), frames=1)


def test_noise_that_does_not_rise_with_the_light_is_refused():
    rng = np.random.default_rng(16)
    place = np.zeros((2, *CELLS))
    noise = 0.05 * LIGHT[1] / LIGHT[1].max()
    taken = [NoiseView(rng.normal(0, noise), 1 / LIGHT, 1 / LIGHT**2, place) for _ in range(4)]
    with pytest.raises(FrameError, match="noise that rises with the light"):
        estimate(taken, unknown(gain=(False, True)), references(gain=(100.0, 2.0)))


@pytest.fixture
def frame():
    """One frame on a map with a displacement of (0.5, 3) px, and a drift of (0.25, -1) px."""
    shape = (24, 40)
    field = np.ones(shape, np.float32)
    images = np.ones((2, 1, *shape), np.float32)
    dims = ("camera", "frame", "y", "x")
    signal = images * np.reshape([1000, 500], (2, 1, 1, 1))
    factor = interpolation_variance_factor(0.75 * field, 2 * field)
    averaged = np.stack([field, factor])[:, None]
    unit = AlignedFrames(
        xr.Dataset(
            {
                "signal": (dims, signal),
                "signal_var": (dims, signal * averaged),
                "signal_var_fixed": (dims, images * averaged),
            },
            {"drift_x": ("frame", [0.25]), "drift_y": ("frame", [-1.0])},
        )
    )
    return ratio_images(np.full((1, *shape), np.log(0.5))), unit, map_with(0.5, 3, shape)


def test_a_view_has_the_variance_of_single_pixels(frame):
    """Shot noise 1/signal, dark 1/signal^2; the averaging of the interpolation is left out."""
    view = NoiseView.of(*frame, size=8)
    npt.assert_allclose(view.shot[:, 5, 5], [1 / 1000, 1 / 500], rtol=1e-5)
    npt.assert_allclose(view.read[:, 5, 5], [1 / 1000**2, 1 / 500**2], rtol=1e-5)


def test_interpolated_noise_of_differences_has_the_predicted_covariance():
    """White noise through scipy's cubic spline at two sub-pixel places, 160 000 pixels each."""
    rng = np.random.default_rng(1)
    noise = rng.standard_normal((400, 400))
    y, x = np.indices(noise.shape, float)
    kernel = rng.standard_normal((5, 5))
    places = [(0.3, -0.15), (0.45, 0.2)]
    moved = (
        ndimage.map_coordinates(noise, (y + v, x + u), order=3, mode="grid-wrap") for u, v in places
    )
    images = [ndimage.correlate(image, kernel, mode="wrap") for image in moved]
    at = np.reshape(places, (2, 2, 1, 1))
    for a, b in np.ndindex(2, 2):
        expected = (images[a] * images[b]).mean()
        npt.assert_allclose(_overlap(kernel, at[a], at[b])[0, 0], expected, rtol=0.02)


@pytest.mark.parametrize("columns", [1, 3, 9])
def test_a_convolution_has_all_places_at_which_both_images_overlap(columns):
    """Against scipy.signal; the weights have an odd number of rows and columns."""
    rng = np.random.default_rng(columns)
    image, kernel = rng.normal(size=(5, 7)), rng.normal(size=(9, columns))
    npt.assert_allclose(_convolve(image, kernel), signal.convolve2d(image, kernel), atol=1e-14)


def test_film_and_marks_that_stand_still_have_no_effect():
    scene = 0.2 * np.random.default_rng(5).standard_normal(SHAPE)
    plain = list(views(np.random.default_rng(6)))
    marked = [NoiseView(v.log_ratio + scene, v.shot, v.read, v.place) for v in plain]
    what = unknown(gain=(True, True))
    npt.assert_allclose(
        [camera.gain for camera in estimate(marked, what).cameras],
        [camera.gain for camera in estimate(plain, what).cameras],
        rtol=1e-6,
    )
