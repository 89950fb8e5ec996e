"""Two cameras in one file, recognised by what the file shows."""

import h5py
import numpy as np
import pytest
import tifffile

from erlif.io.ingest.shared import find_cameras_in_file


def speckle(rows, columns, seed=8):
    """Light with grains of a few pixels."""
    field = np.random.default_rng(seed).normal(size=(rows, columns))
    for axis in (0, 1):
        field = sum(np.roll(field, shift, axis) for shift in range(-2, 3))
    return 1500 + 60 * field


def photograph(*fields):
    """Images of them with shot noise."""
    rng = np.random.default_rng(9)
    return [rng.poisson(np.clip(field, 0, 4000)).astype(np.uint16) for field in fields]


@pytest.mark.parametrize("parts", [("left", "right"), ("top", "bottom")])
def test_halves_that_show_the_same_object_are_two_cameras(tmp_path, parts):
    """The second camera is shifted, dimmer and has its own profile of the light."""
    scene = speckle(140, 170)
    dimmer = np.linspace(0.3, 0.9, 160) * np.roll(scene, (3, -4), (0, 1))[:130, :160]
    stack = np.hstack if parts[0] == "left" else np.vstack
    tifffile.imwrite(tmp_path / "a.tif", stack(photograph(scene[:130, :160], dimmer)))
    found = find_cameras_in_file(tmp_path / "a.tif")
    assert (found.key, found.values) == ("part", parts)
    assert f"its {parts[0]} and {parts[1]} halves" in found.reason


@pytest.mark.parametrize("seed", range(2))
def test_one_scene_is_one_camera(tmp_path, seed):
    tifffile.imwrite(tmp_path / "a.tif", photograph(speckle(256, 320, seed))[0])
    assert find_cameras_in_file(tmp_path / "a.tif", rows=[1]) is None


def test_twice_as_many_pages_as_rows_alternate(tmp_path):
    images = np.stack([photograph(speckle(64, 80))[0] for _ in range(6)])
    tifffile.imwrite(tmp_path / "a.tif", images, photometric="minisblack")
    assert find_cameras_in_file(tmp_path / "a.tif", rows=[3]).values == ("odd", "even")
    assert find_cameras_in_file(tmp_path / "a.tif", rows=[6]) is None
    assert find_cameras_in_file(tmp_path / "a.tif", rows=[3, 6]) is None
    assert find_cameras_in_file(tmp_path / "a.tif") is None


def test_channels_are_cameras(tmp_path):
    images = np.zeros((3, 2, 64, 80), np.uint16)
    tifffile.imwrite(tmp_path / "a.tif", images, ome=True, metadata={"axes": "TCYX"})
    assert find_cameras_in_file(tmp_path / "a.tif").values == ("channel 1", "channel 2")


def test_datasets_are_sorted_by_their_names(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for camera in (1, 2):
            for name in ("counts", "dark", "flat"):
                file[f"camera{camera}/{name}"] = np.zeros((2, 64, 80), np.uint16)
    found = find_cameras_in_file(tmp_path / "a.h5")
    assert (found.key, found.values) == ("dataset", ("/camera1/counts", "/camera2/counts"))
    assert found.darks == ("/camera1/dark", "/camera2/dark")
    assert found.flats == ("/camera1/flat", "/camera2/flat")


def test_other_files_are_one_camera_or_none(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name in ("one", "two", "three"):
            file[name] = np.zeros((2, 64, 80), np.uint16)
    assert find_cameras_in_file(tmp_path / "a.h5") is None
    (tmp_path / "a.tif").write_bytes(b"damaged")
    assert find_cameras_in_file(tmp_path / "a.tif") is None
    tifffile.imwrite(tmp_path / "b.tif", np.zeros((256, 320), np.uint16))
    assert find_cameras_in_file(tmp_path / "b.tif") is None


def test_an_image_with_nan_shows_no_halves(tmp_path):
    image = np.random.default_rng(3).normal(900, 30, (128, 256)).astype(np.float32)
    image[5, 7] = np.nan
    tifffile.imwrite(tmp_path / "a.tif", image)
    assert find_cameras_in_file(tmp_path / "a.tif") is None
