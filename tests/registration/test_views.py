"""Frames summed up: cells in full pixels, drift of each frame, expected differences."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.registration import Blobs, Scene, map_views, smooth_map, translation

from erlif.core.errors import RegistrationError
from erlif.registration.matching import AA, BX, BY, EE, GXX, GXY, GYY, SUMS, WEIGHT, solve_shift
from erlif.registration.views import make_cells
from erlif.registration.whitening import make_filter

SHAPE = (128, 160)


def sums_of(rows=8, cols=10):
    sums = np.random.default_rng(1).uniform(1, 2, (rows, cols, SUMS))
    sums[..., WEIGHT] = 64
    return sums


def translated(*offsets, seed=2):
    """Pairs of one analytic texture in which camera 2 is translated by each of the offsets."""
    field = Blobs(SHAPE, 1.5, np.random.default_rng(seed))
    y, x = np.indices(SHAPE, dtype=float)
    image = 1000 * (1 + 0.15 * field(x, y))
    return [(image, 1000 * (1 + 0.15 * field(x - dx, y - dy)), None, None) for dx, dy in offsets]


@pytest.mark.parametrize("binning", [1, 2, 4])
def test_cells_lie_at_the_middle_of_their_full_pixels_and_have_gradients_per_full_pixel(binning):
    """The first cell of 8 binned pixels covers the full pixels 0 to 8 binning - 1."""
    sums = sums_of()
    cells = make_cells(sums, 8, translation(), binning=binning)
    npt.assert_allclose(cells.x[0], (8 * binning - 1) / 2)
    npt.assert_allclose(cells.y[0], (8 * binning - 1) / 2)
    npt.assert_allclose(np.diff(cells.x), 8 * binning)
    assert (len(cells.y), len(cells.x)) == (8, 10)

    # a displacement of one binned pixel is one of ``binning`` full ones
    npt.assert_allclose(cells.sums[..., [GXX, GXY, GYY]] * binning**2, sums[..., [GXX, GXY, GYY]])
    npt.assert_allclose(cells.sums[..., [BX, BY]] * binning, sums[..., [BX, BY]])
    npt.assert_array_equal(cells.sums[..., [EE, WEIGHT, AA]], sums[..., [EE, WEIGHT, AA]])
    npt.assert_allclose(solve_shift(cells.sums), binning * np.array(solve_shift(sums)))


def test_a_surface_needs_sixteen_cells():
    sums = sums_of()
    sums.reshape(-1, SUMS)[16:, WEIGHT] = 0
    assert (make_cells(sums, 8, translation()).weight > 0).sum() == 16
    sums.reshape(-1, SUMS)[15, WEIGHT] = 0
    with pytest.raises(RegistrationError, match="needs 16 cells of 8 px, got 15"):
        make_cells(sums, 8, translation())


def test_spectra_are_measured_on_the_unfiltered_textures():
    views = map_views(translated((0.0, 0.0)))
    sums, _, spectra = views.compare(translation())
    assert spectra.blocks > 4
    npt.assert_array_equal(sums, views.look(translation())[0])
    views.filter_through(make_filter(spectra))
    filtered, _ = views.look(translation())
    # the derivative needs 2 px on each side, the filter 4, the interpolation 1 at the far side
    assert sums[..., WEIGHT].sum() == (128 - 4) * (160 - 4)
    assert filtered[..., WEIGHT].sum() == (128 - 13) * (160 - 13)


def test_each_frame_is_read_at_its_own_drift_and_the_surface_takes_the_mean():
    """The surface fits the first frame to a few hundredths of a pixel, as the start does."""
    offsets = np.array([(1.0, 0.0), (-2.0, 1.5), (4.0, 0.5), (0.0, -1.0)])
    views = map_views(translated(*offsets))
    _, surface = views.look(translation(0.95, 0.05))
    npt.assert_allclose(views.drift, offsets - offsets.mean(0), atol=0.02)
    npt.assert_allclose(views.drift.mean(0), 0, atol=1e-12)
    dx, dy = surface.evaluate(np.zeros(1), np.zeros(1))
    npt.assert_allclose((dx[0, 0], dy[0, 0]), offsets.mean(0), atol=0.02)


def counted(pairs):
    """The pairs, and the list of the numbers that were read."""
    read = []

    class Counted(list):
        def __getitem__(self, number):
            read.append(number)
            return super().__getitem__(number)

    return Counted(pairs), read


def test_each_frame_is_read_once_or_in_every_pass_if_too_large_to_be_kept(monkeypatch):
    pairs, read = counted(translated((0.0, 0.0), (0.5, 0.0), (0.0, 0.5)))
    kept = map_views(pairs)
    whitening = make_filter(kept.compare(translation())[2])
    kept.filter_through(whitening)
    before = [kept.look(translation())[0] for _ in range(2)]
    assert read == [0, 1, 2]

    monkeypatch.setattr("erlif.registration.views.MOST_KEPT", 0)
    again = map_views(pairs)
    again.compare(translation())
    again.filter_through(whitening)
    after = [again.look(translation())[0] for _ in range(2)]
    npt.assert_allclose(after, before, rtol=1e-5, atol=1e-5)
    read.clear()
    again.look(translation())
    assert read == [1, 2]  # the frame of the start is kept in any case


def test_cameras_of_different_size_are_filtered_on_their_own_grids():
    truth = Scene((192, 224), 5).photograph(smooth_map((192, 224), offset=(0.0, 0.0)))
    wide = np.ascontiguousarray(truth.moving[:, :200])
    views = map_views([(truth.reference, wide, None, None)])
    surface = translation(shape=(192, 224))
    views.filter_through(make_filter(views.compare(surface)[2]))
    assert views.shape == (192, 224)
    assert views.shape_moving == (192, 200)
    weight = views.look(surface)[0][..., WEIGHT]
    assert weight[:, -3:].sum() == 0  # camera 2 sees nothing there
    assert weight[5, 5] == 64
