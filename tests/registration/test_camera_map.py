"""The camera map as a product: its description, its file and its translation."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.pair import map_with

from erlif.core.errors import RegistrationError
from erlif.registration import CameraMap, MapKind, RegistrationSettings, move_map

SHAPE = (5, 7)
ARRAYS = ("displacement_x", "displacement_y", "displacement_std", "overlap", "poor")


@pytest.fixture
def found():
    """A map with a different value in every array, found on the frames of a run."""
    y, x = np.indices(SHAPE).astype(np.float32)
    return CameraMap(
        displacement_x=3 + 0.01 * x,
        displacement_y=-2 + 0.02 * y,
        displacement_std=0.005 + 0.001 * x,
        overlap=x < 6,
        poor=y > 3,
        quality=0.93,
        kind=MapKind.SURFACE,
        resolution="polynomial of degree 2",
        settings=RegistrationSettings(
            window=48, step=12, model="surface", orientation="mirrored_x", whiten=False, search=0.2
        ),
    )


def assert_same(one, other):
    for name in ARRAYS:
        assert getattr(one, name).dtype == getattr(other, name).dtype
        npt.assert_array_equal(getattr(one, name), getattr(other, name))
    for name in ("quality", "kind", "resolution", "settings", "stored", "drift_taken_up"):
        assert getattr(one, name) == getattr(other, name)


@pytest.mark.parametrize(
    ("kind", "resolution", "stored", "drift", "text"),
    [
        (MapKind.SURFACE, "4 x 3", True, None, "surface, 4 x 3, stored with the calibration"),
        (
            MapKind.LOCAL,
            "32 px",
            True,
            (0.25, -1.5),
            "local windows, 32 px, stored with the calibration; the mean drift taken up is "
            "(0.250, -1.500) px",
        ),
        (MapKind.SURFACE, "", False, None, "surface"),
    ],
)
def test_description_in_a_file_is_read_back(found, kind, resolution, stored, drift, text):
    camera_map = replace(
        found, kind=kind, resolution=resolution, stored=stored, drift_taken_up=drift
    )
    dataset = camera_map.to_dataset()
    assert dataset.attrs["registration_model"] == camera_map.model == text
    assert_same(CameraMap.from_dataset(dataset), camera_map)


@pytest.mark.parametrize("text", ["thin-plate spline, 9 nodes", "", "surfaces, of degree 2"])
def test_unknown_kind_of_map_is_refused(found, text):
    dataset = found.to_dataset().assign_attrs(registration_model=text)
    with pytest.raises(RegistrationError, match="surface, local windows"):
        CameraMap.from_dataset(dataset)


@pytest.mark.parametrize("missing", [*ARRAYS, "registration_quality", "registration_model_asked"])
def test_missing_part_of_a_stored_map_is_named(found, missing):
    dataset = found.to_dataset()
    if missing in dataset:
        dataset = dataset.drop_vars(missing)
    else:
        del dataset.attrs[missing]
    with pytest.raises(RegistrationError, match=f"needs {missing}, which"):
        CameraMap.from_dataset(dataset)


@pytest.mark.parametrize(("stored", "recorded"), [(False, None), (True, (0.75, 1.25))])
def test_translations_are_added_and_a_stored_map_records_their_sum(found, stored, recorded):
    begun = replace(found, stored=stored)
    moved = move_map(move_map(begun, np.array([0.5, -0.25])), np.array([0.25, 1.5]))
    npt.assert_allclose(moved.displacement_x, found.displacement_x + 0.75, rtol=1e-6)
    npt.assert_allclose(moved.displacement_y, found.displacement_y + 1.25, rtol=1e-6)
    assert moved.displacement_x.dtype == moved.displacement_y.dtype == np.float32
    assert (moved.stored, moved.drift_taken_up) == (stored, recorded)


def test_a_map_shows_displacement_and_error():
    image = np.linspace(1.0, 3.0, 12).reshape(3, 4)
    camera_map = map_with(image, -image, image.shape, std=0.02)
    for shown in (repr(camera_map), camera_map._repr_html_()):
        assert "1.00 to 3.00 px" in shown
        assert "-3.00 to -1.00 px" in shown
        assert "0.020 px (median)" in shown
    assert camera_map._repr_html_().count("<img") == 2
