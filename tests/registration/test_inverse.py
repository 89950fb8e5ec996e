"""Whether the map of a run is the stored one or its inverse.

The inverse of a known displacement comes from a fixed-point iteration.
"""

import itertools

import numpy as np
import numpy.testing as npt
import pytest
from scenes.pair import map_with
from scenes.registration import inverse, smooth_map

from erlif.registration import compare_with_inverse, orient
from erlif.registration.inverse import judge
from erlif.registration.settings import ORIENTATIONS

SHAPE = (240, 320)
STD = 0.01

AFFINE = smooth_map(SHAPE, rotation=0.3, scale=1.01, cubic=0.0, quadratic=0.0)
BOTH = smooth_map(SHAPE)
MAPS = {
    "affine": AFFINE,
    "curved": smooth_map(SHAPE, rotation=0.0, scale=1.0, cubic=1.5, quadratic=0.8),
    "both": BOTH,
    "rotation": smooth_map(SHAPE, rotation=0.5, scale=1.0, cubic=0.0, quadratic=0.0),
}


def backwards(field):
    """Displacement from camera 2 to camera 1, at the pixels of camera 2."""

    def displacement(x, y):
        px, py = inverse(field, x, y)
        return px - x, py - y

    return displacement


def camera_map(field, *, shape=SHAPE, std=STD, move=(0.0, 0.0), orientation="normal"):
    y, x = np.indices(shape, dtype=float)
    dx, dy = np.add(field(x, y), np.reshape(move, (2, 1, 1)))
    h, w = SHAPE
    seen = (x + dx >= 0) & (x + dx <= w - 1) & (y + dy >= 0) & (y + dy <= h - 1)
    return map_with(dx, dy, shape, std=std, overlap=seen, orientation=orientation)


def with_errors(field, seed, size):
    """The map with a smooth error of that rms in each component: affine and quadratic terms."""
    rng = np.random.default_rng(seed)
    terms = rng.normal(size=(2, 5))

    def displacement(x, y):
        u, v = (x - 159.5) / 92.4, (y - 119.5) / 69.3  # of unit variance over the frame
        shapes = (u, v, u * v, (u**2 - 1) / 0.9, (v**2 - 1) / 0.9)
        dx, dy = field(x, y)
        error = [sum(t * s for t, s in zip(row, shapes, strict=True)) for row in terms]
        norm = size / np.sqrt(5)
        return dx + norm * error[0], dy + norm * error[1]

    return displacement


@pytest.mark.parametrize("name", MAPS)
@pytest.mark.parametrize("move", [(0.0, 0.0), (6.0, -4.0)])
def test_map_and_inverse_are_distinguished_at_any_translation(name, move):
    field = MAPS[name]
    stored = camera_map(field)
    same = compare_with_inverse(stored, camera_map(field, move=move))
    assert same.inverted is False
    assert same.misfit < 1e-5
    swapped = compare_with_inverse(stored, camera_map(backwards(field), move=move))
    assert swapped.inverted is True
    # a translation also moves the point at which the inverse is read, which leaves a little
    still = move == (0.0, 0.0)
    assert swapped.misfit_inverse < (0.001 if still else 0.06)
    assert same.misfit_inverse == pytest.approx(swapped.misfit, rel=0.03 if still else 0.1)


@pytest.mark.parametrize("name", ["affine", "curved", "both"])
def test_errors_of_the_map_do_not_change_the_verdict(name):
    stored = camera_map(MAPS[name], std=0.05)
    fields = ((False, MAPS[name]), (True, backwards(MAPS[name])))
    for seed, (inverted, field) in itertools.product(range(8), fields):
        found = camera_map(with_errors(field, seed, 0.05), std=0.05, move=(0.7, -1.1))
        result = compare_with_inverse(stored, found)
        assert result.inverted is inverted
        best = result.misfit_inverse if inverted else result.misfit
        assert 0.01 < best < 0.2  # the error put in: 0.07 px of vector length


def test_misfits_and_significance_of_a_magnification_in_closed_form():
    """Magnification m moves a point by (m - 1) r and its inverse by (1/m - 1) r.

    The radius r has the variance (w^2 + h^2)/12 over a frame of w by h.
    """
    m, std = 1.012, 0.02

    def magnify(by):
        return lambda x, y: ((by - 1) * (x - 159.5), (by - 1) * (y - 119.5))

    result = compare_with_inverse(
        camera_map(magnify(m), std=std), camera_map(magnify(1 / m), std=2 * std)
    )
    radius = np.hypot(320 / m, 240 / m) / np.sqrt(12)  # camera 2 does not see the outermost points
    apart, misfit = 2 * (m - 1) * radius, (m - 1 / m) * radius
    noise = np.sqrt(2 * std**2 + 2 * (2 * std) ** 2 + 0.05**2)
    assert result.misfit_inverse < 1e-4
    npt.assert_allclose(result.misfit, misfit, rtol=0.01)
    npt.assert_allclose(result.significance, misfit**2 / (2 * apart * noise), rtol=0.01)


@pytest.mark.parametrize("orientation", ORIENTATIONS)
def test_orientation_of_camera_2_is_undone(orientation):
    """The run turns its camera 2, which is camera 1 of the calibration, by the opposite angle."""
    back = {"rotated_90": "rotated_270", "rotated_270": "rotated_90"}.get(orientation, orientation)
    stored = camera_map(BOTH, orientation=orientation)
    # on the sensor of the stored camera 2: turned images, and vectors from the turned coordinates
    y, x = np.indices(SHAPE, dtype=float)
    dx, dy = backwards(BOTH)(x, y)
    row, column = orient(y, back), orient(x, back)
    step_x, step_y = orient(dx, back), orient(dy, back)
    down, across = np.gradient(column)  # change of x of the oriented image along the sensor's axes
    found_x, found_y = across * step_x, down * step_x
    down, across = np.gradient(row)
    found_x, found_y = found_x + across * step_y, found_y + down * step_y
    overlap = orient(camera_map(backwards(BOTH)).overlap, back)
    found = map_with(found_x, found_y, row.shape, overlap=overlap, orientation=back)
    result = compare_with_inverse(stored, found)
    assert result.inverted is True
    assert result.misfit_inverse < 0.001
    if back != orientation:
        assert result.misfit == np.inf


def test_another_orientation_or_frame_size_excludes_the_map_itself():
    stored = camera_map(AFFINE)
    smaller = camera_map(AFFINE, shape=(200, 320))
    assert compare_with_inverse(stored, smaller).misfit == np.inf
    turned = camera_map(AFFINE, orientation="rotated_90")
    result = compare_with_inverse(stored, turned)
    assert (result.misfit, result.misfit_inverse, result.inverted) == (np.inf, np.inf, None)


@pytest.mark.parametrize(
    ("misfit", "misfit_inverse", "std", "significance", "inverted"),
    [
        (0.0, 2.0, 0.19, 1 / 0.19, False),  # half the distance, in standard deviations
        (2.0, 0.0, 0.19, 1 / 0.19, True),
        (0.0, 2.0, 0.21, 1 / 0.21, None),  # below 5
        (0.45, 2.0, 0.1, (4 - 0.45**2) / 4 / 0.1, False),
        (0.55, 2.0, 0.1, (4 - 0.55**2) / 4 / 0.1, None),  # above a quarter of the other
        (np.inf, 0.3, 0.1, (4 - 0.3**2) / 4 / 0.1, True),  # excluded: as far as the inverse
        (np.inf, 0.6, 0.1, (4 - 0.6**2) / 4 / 0.1, None),
        (1.7, 1.7, 0.1, 0.0, None),
        (2.5, 2.4, 0.1, 0.0, None),  # both further than the candidates from each other
    ],
)
def test_verdict_in_closed_form(misfit, misfit_inverse, std, significance, inverted):
    """Candidates 2 px apart; the found map lies (worse^2 - better^2) / 4 px from their middle."""
    result = judge(misfit, misfit_inverse, apart=2.0, std=std)
    assert result.significance == pytest.approx(significance)
    assert result.inverted is inverted


def test_maps_without_common_pixels_are_undecided():
    found = camera_map(BOTH)
    found.poor[:] = True
    result = compare_with_inverse(camera_map(BOTH), found)
    assert np.isnan([result.misfit, result.misfit_inverse]).all()
    assert (result.significance, result.inverted) == (0.0, None)
