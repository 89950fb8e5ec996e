"""Cameras and purposes of files by names as laboratories give them, and their patterns."""

import tomllib
from pathlib import Path

import pytest

from erlif.io.ingest.naming import assign_in_order, find_pattern, group_by_camera, lower_name
from erlif.io.ingest.order import sort_files

NAMES = tomllib.loads(Path(__file__).with_name("names.toml").read_text(encoding="utf-8"))


def survey(directory, *names):
    """Patterns of each camera by purpose, in the order of the labels; which were assigned so."""
    paths = sort_files(directory / name for name in names)
    for path in paths:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    known = {path: lower_name(path, directory) for path in paths}
    groups, unassigned = group_by_camera(known)
    in_order = assign_in_order(groups, unassigned, known)
    assert not unassigned
    return [
        {purpose: find_pattern(files, directory) for purpose, files in group.items() if files}
        for _, group in sorted(groups.items())
    ], in_order


def numbered(*patterns):
    return [pattern.format(number) for pattern in patterns for number in range(3)]


@pytest.mark.parametrize(("one", "two", "patterns"), NAMES["cameras"])
def test_two_cameras_are_distinguished_by_the_names_of_their_files(tmp_path, one, two, patterns):
    found, _ = survey(tmp_path, *numbered(one, two))
    assert found == [{"frames": pattern} for pattern in patterns]
    for pattern in patterns:
        assert len(list(tmp_path.glob(pattern))) == 3


@pytest.mark.parametrize(("dark", "flat", "dry"), NAMES["references"])
def test_darks_and_flats_are_assigned_to_their_camera_by_name(tmp_path, dark, flat, dry):
    frames = numbered("camera1/frame_{}.tif", "camera2/frame_{}.tif")
    others = [name.format(camera) for camera in (1, 2) for name in (dark, flat, dry)]
    found, _ = survey(tmp_path, *frames, *others)
    for number, camera in enumerate(found, 1):
        assert len(list(tmp_path.glob(camera.pop("frames")))) == 3
        expected = {"darks": dark, "flats": flat, "backgrounds": dry}
        assert camera == {purpose: name.format(number) for purpose, name in expected.items()}


@pytest.mark.parametrize(
    "darks", [["darks/left.tif", "darks/right.tif"], ["2_left_dark.tif", "1_right_dark.tif"]]
)
@pytest.mark.parametrize("folder", ["", "raw/"])
def test_darks_of_left_and_right_are_found_in_their_own_folder(tmp_path, darks, folder):
    frames = numbered(f"left/{folder}{{}}.tif", f"right/{folder}{{}}.tif")
    found, in_order = survey(tmp_path, *frames, *darks)
    assert [camera["darks"] for camera in found] == darks
    assert in_order == ()


@pytest.mark.parametrize("sides", [("left", "right"), ("a_", "b_"), ("cam0_", "cam1_")])
def test_two_names_in_one_folder_are_two_cameras_with_their_darks_and_flats(tmp_path, sides):
    """Given against the order of the names, in which they would be taken else."""
    one, two = (side.rstrip("_") for side in sides)
    others = f"dark_{two}.tif", f"1_flat_{two}.tif", f"2_flat_{one}.tif"
    found, in_order = survey(
        tmp_path, *numbered(*(f"images/{side}{{}}.tif" for side in sides)), *others
    )
    frames = [{"frames": f"images/{side}*.tif"} for side in sides]
    flats = [{"flats": f"2_flat_{one}.tif"}, {"flats": others[1], "darks": others[0]}]
    assert found == [frames[0] | flats[0], frames[1] | flats[1]]
    assert in_order == ()


def test_frames_that_no_single_pattern_matches_have_none(tmp_path):
    names = [*numbered("cam1_{}.tif", "cam2_{}.tif"), "cam1_dark_1.tif"]
    found, _ = survey(tmp_path, *names)
    assert found[0]["frames"] == "cam1_[0-9]*.tif"  # the dark is left out
    found, _ = survey(tmp_path, *names, "cam1_3_dark.tif")
    assert found[0]["frames"] is None
