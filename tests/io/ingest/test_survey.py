"""Frames, darks, flats and tables found by their names, as laboratories name them."""

from pathlib import Path

import h5py
import numpy as np
import pytest
import tifffile
from scenes.camera_files import (
    random_frames,
    write_cine,
    write_genicam,
    write_im7,
    write_mraw,
    write_seq,
)

from erlif.core.errors import FrameError
from erlif.io.ingest import survey
from erlif.io.ingest.survey import survey_directory
from erlif.io.readers import registry
from erlif.io.readers.hdf5 import HDF5

GREY = np.full((64, 80), 1000, np.uint16)


def photograph(directory: Path, *names: str, image=GREY, pages: int = 1) -> None:
    """Write images under these names."""
    for name in names:
        path = directory / name
        path.parent.mkdir(parents=True, exist_ok=True)
        with tifffile.TiffWriter(path) as file:
            for _ in range(pages):
                file.write(image, contiguous=False)


def numbered(pattern: str, count: int = 3) -> list[str]:
    return [pattern.format(number) for number in range(count)]


def test_cameras_stand_in_the_order_of_their_wavelengths(tmp_path):
    photograph(tmp_path, *numbered("cam1_610nm/{}.tif"), *numbered("cam2_580nm/{}.tif"))
    cameras = survey_directory(tmp_path).cameras
    assert [camera.wavelength for camera in cameras] == [580, 610]
    assert cameras[0].frames.pattern == "cam2_580nm/*.tif"


def test_a_number_that_both_cameras_share_is_not_a_wavelength(tmp_path):
    photograph(tmp_path, *numbered("run_500/cam1/{}.tif"), *numbered("run_500/cam2/{}.tif"))
    assert [camera.wavelength for camera in survey_directory(tmp_path).cameras] == [None, None]


@pytest.mark.parametrize(
    "suffix",
    [
        suffix
        for form in registry.FORMATS
        for suffix in form.suffixes
        if form is not HDF5 and suffix not in form.beside
    ],
)
def test_every_suffix_of_a_format_is_seen(tmp_path, suffix):
    """Whatever the files hold: a damaged frame is a frame."""
    for name in ("left/1", "left/2", "right/1", "right/2"):
        path = tmp_path / f"{name}{suffix}"
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(b"damaged")
    cameras = survey_directory(tmp_path).cameras
    assert [camera.frames.pattern for camera in cameras] == [f"left/*{suffix}", f"right/*{suffix}"]


@pytest.mark.parametrize("suffix", HDF5.suffixes)
def test_files_of_hdf5_are_seen_where_they_hold_frames(tmp_path, suffix):
    """Logs and films of erlif are no frames."""
    for name, data in (("camera1", np.zeros((3, 64, 80))), ("log", np.zeros(9))):
        with h5py.File(tmp_path / f"{name}{suffix}", "w") as file:
            file["data"] = data
    with h5py.File(tmp_path / "film.nc", "w") as file:
        file["thickness"] = np.zeros((3, 64, 80))
        file.attrs["erlif_version"] = "0.1.0"
    (camera,) = survey_directory(tmp_path).cameras
    assert (camera.frames.pattern, camera.frames.pages) == (f"camera1{suffix}", 3)


@pytest.mark.parametrize("name", ["{}.img", "{}", "frame.{:04}", "run{}.dat"])
def test_frames_known_by_their_content_alone_are_found_with_a_few_looks(
    tmp_path, name, monkeypatch
):
    looks = []
    find = survey.find_by_content
    monkeypatch.setattr(survey, "find_by_content", lambda path: looks.append(path) or find(path))
    photograph(tmp_path, *numbered(f"left/{name}", 20), *numbered(f"right/{name}", 20))
    (tmp_path / "readme").write_text("none")
    (tmp_path / "notes.txt").write_text("none")
    found = survey_directory(tmp_path)
    assert [camera.frames.pages for camera in found.cameras] == [20, 20]
    assert len(looks) <= 3


def test_a_set_of_lavision_is_one_recording_with_its_folder(tmp_path):
    for camera in ("left", "right"):
        (tmp_path / camera).mkdir()
        for number in range(3):
            write_im7(tmp_path / camera / f"B{number}.im7", np.ones((1, 64, 80), np.uint16))
        (tmp_path / f"{camera}.set").write_text("SetType = 1")
    cameras = survey_directory(tmp_path).cameras
    assert [one.frames.pattern for one in cameras] == ["left.set", "right.set"]
    assert [one.frames.pages for one in cameras] == [3, 3]


@pytest.mark.parametrize(
    ("folder", "file", "text"),
    [
        ("wedge_may", None, ""),
        ("images/Kalib", None, ""),
        ("old", "fixture.toml", ""),
        ("old", "cmm.csv", "x_mm,thickness_um\n0,1\n"),
    ],
)
def test_the_folder_of_a_fixture_is_no_camera_of_a_run(tmp_path, folder, file, text):
    photograph(tmp_path, *numbered("images/left{}.tif"), *numbered("images/right{}.tif"))
    photograph(tmp_path, *numbered(f"{folder}/left{{}}.tif", 2), f"{folder}/dark_left.tif")
    if file:
        (tmp_path / folder / file).write_text(text)
    survey = survey_directory(tmp_path)
    assert [camera.frames.pages for camera in survey.cameras] == [3, 3]
    assert survey.left_out == (tmp_path / folder,)
    assert survey.cameras[0].darks is None
    assert len(survey_directory(tmp_path / folder).cameras) == 1  # where nothing else is meant


def test_a_photograph_of_the_scale_is_not_a_frame(tmp_path):
    photograph(tmp_path, *numbered("cam1/{}.tif"), *numbered("cam2/{}.tif"), "scale.tif")
    survey = survey_directory(tmp_path)
    assert [camera.frames.pages for camera in survey.cameras] == [3, 3]
    assert survey.unassigned == (tmp_path / "scale.tif",)


def test_tables_are_listed_with_header_and_rows(tmp_path):
    (tmp_path / "log.csv").write_text("frame, angle_deg\n0,1.5\n1,2.5\n\n")
    (tmp_path / "empty.csv").write_text("")
    (tmp_path / "binary.csv").write_bytes(b"\xff\xfe\x00")
    (table,) = survey_directory(tmp_path).tables
    assert (table.path.name, table.header, table.rows) == ("log.csv", ("frame", "angle_deg"), 2)


def test_too_many_files_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("erlif.io.ingest.survey.MOST_FILES", 3)
    photograph(tmp_path, *numbered("cam1/{}.tif", 4))
    with pytest.raises(FrameError, match="more than 3 files"):
        survey_directory(tmp_path)


def test_hidden_files_links_and_files_too_deep_are_not_searched(tmp_path):
    photograph(tmp_path, *numbered("cam1/{}.tif"), *numbered("cam2/{}.tif"))
    photograph(tmp_path, ".hidden.tif", "a/b/c/d/deep.tif")
    (tmp_path / "link.tif").symlink_to(tmp_path / "cam1" / "0.tif")
    survey = survey_directory(tmp_path)
    assert survey.unassigned == ()
    assert [camera.frames.pages for camera in survey.cameras] == [3, 3]


def test_a_camera_whose_files_are_all_damaged_has_no_counts(tmp_path):
    photograph(tmp_path, *numbered("cam1/{}.tif"), *numbered("cam2/{}.tif"))
    for path in (tmp_path / "cam2").iterdir():
        path.write_bytes(b"")
    one, two = survey_directory(tmp_path).cameras
    assert one.counts.pages == 3
    assert one.counts.highest == 1000
    assert two.counts is None
    assert len(two.frames.faults) == 3


def write_upper(path, frames):
    """A recording as cameras on Windows name it."""
    write_mraw(path, frames, stored=16, depth=12)
    header = path.with_suffix(".cihx")
    header.rename(header.with_suffix(".CIHX"))


@pytest.mark.parametrize(
    ("suffix", "write"),
    [
        (".mraw", lambda path, frames: write_mraw(path, frames, stored=16, depth=12)),
        (".MRAW", lambda path, frames: write_upper(path, frames)),
        (".cine", lambda path, frames: write_cine(path, frames, depth=12)),
        (".seq", lambda path, frames: write_seq(path, frames, significant=12)),
        (".raw", lambda path, frames: write_genicam(path, frames, "Mono12p")),
    ],
)
def test_recordings_of_cameras_are_found_with_the_depth_of_their_headers(tmp_path, suffix, write):
    """Dim frames would fit 8 bits; the header beside the counts is no second recording."""
    frames = random_frames(np.random.default_rng(1), bits=6).astype(np.uint16)
    for camera in (1, 2):
        write(tmp_path / f"camera{camera}{suffix}", frames)
    found = survey_directory(tmp_path)
    assert [camera.frames.pattern for camera in found.cameras] == [
        f"camera1{suffix}",
        f"camera2{suffix}",
    ]
    for camera in found.cameras:
        assert camera.frames.pages == 3
        assert not camera.frames.faults
        assert camera.counts.bit_depth == 12
        assert camera.counts.stated


@pytest.mark.parametrize(("fixture", "taken"), [(False, ["run03", 5]), (True, ["wedge", 2])])
def test_a_recording_is_chosen_by_its_name(tmp_path, fixture, taken):
    """Movies of a run and of its fixture in one folder."""
    for band in (580, 610):
        for name, pages in (("run03", 5), ("wedge", 2), ("dark", 3)):
            write_cine(
                tmp_path / f"Cam_{band}nm_{name}.cine",
                random_frames(np.random.default_rng(1), frames=pages),
            )
    cameras = survey_directory(tmp_path, fixture=fixture).cameras
    for band, camera in zip((580, 610), cameras, strict=True):
        found = [camera.frames.pattern, camera.frames.pages]
        assert found == [f"Cam_{band}nm_{taken[0]}.cine", taken[1]]
        assert camera.chosen
        assert [one.pages for one in camera.recordings] == [5, 2]


def test_numbered_parts_of_a_recording_are_one(tmp_path):
    """TIFF files of many pages, as cameras split them; movies are never parts."""
    photograph(tmp_path, *numbered("left/rec_{}.tif", 3), *numbered("right/rec_{}.tif"), pages=4)
    cameras = survey_directory(tmp_path).cameras
    assert [(camera.frames.pages, camera.recordings) for camera in cameras] == [(12, ())] * 2


def test_parts_of_one_file_stand_in_the_order_of_their_pages(tmp_path):
    """By name, "even" would come before "odd"; odd pages are brighter here."""
    pages = np.stack([np.full((64, 80), 3000 - 2000 * (k % 2), np.uint16) for k in range(6)])
    tifffile.imwrite(tmp_path / "both.tif", pages, photometric="minisblack")
    (tmp_path / "encoder.csv").write_text("frame,angle_deg\n0,1\n1,2\n2,3\n")
    one, two = survey_directory(tmp_path).cameras
    assert (one.shared.values[0], one.counts.highest) == ("odd", 3000)
    assert (two.shared.values[1], two.counts.highest) == ("even", 1000)
    assert one.frames.pages == two.frames.pages == 3
