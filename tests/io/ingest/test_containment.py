"""Files of a recording that lie outside its directory are used only where the user allows it."""

import shutil

import numpy as np
import pytest
from scenes.camera_files import random_frames, write_genicam, write_im7, write_mraw

from erlif.core.errors import FrameError
from erlif.io.ingest import open_fixture, open_run
from erlif.io.ingest.containment import refuse_outside


def move_out(lab, name):
    """Move a file or folder of the run out of it; gives its new place."""
    outside = lab.directory / "elsewhere" / name
    outside.parent.mkdir(parents=True, exist_ok=True)
    shutil.move(lab.run / name, outside)
    return outside


@pytest.mark.parametrize(
    "name",
    ["camera1", "camera2/frame_0003.tif", "camera1_dark.tif", "camera2_flat.tif", "encoder.csv"],
)
def test_a_link_out_of_the_directory_is_refused_and_named(lab, name):
    (lab.run / name).symlink_to(move_out(lab, name))
    with pytest.raises(FrameError, match=rf"within it; {name}.* is a link to .*--allow-outside"):
        open_run(lab.run)
    assert len(open_run(lab.run, allow_outside=True).pairs.usable) == 6


def test_names_and_links_within_the_directory_are_followed(lab):
    (lab.run / "raw").mkdir()
    shutil.move(lab.run / "camera1", lab.run / "raw" / "one")
    (lab.run / "camera1").symlink_to("raw/one")
    lab.edit("run/run.toml", ('"camera1_dark.tif"', '"raw/../camera1_dark.tif"'))
    assert len(open_run(lab.run).pairs.usable) == 6


def test_the_directory_itself_may_be_a_link(lab):
    link = lab.directory / "link"
    link.symlink_to(lab.run)
    assert len(open_run(link).pairs.usable) == 6


def test_a_fixture_is_held_to_the_same(lab):
    profile = lab.directory / "profile.csv"
    shutil.move(lab.fixture / "profile.csv", profile)
    (lab.fixture / "profile.csv").symlink_to(profile)
    with pytest.raises(FrameError, match=r"profile\.csv is a link"):
        open_fixture(lab.fixture)
    open_fixture(lab.fixture, allow_outside=True)


@pytest.mark.parametrize("linked", ["a.cihx", "b.toml", "c", "c/B1.im7", "a.mraw"])
def test_files_that_are_read_together_with_a_named_one_lie_in_the_directory(tmp_path, linked):
    frames = random_frames(np.random.default_rng(1))
    run = tmp_path / "run"
    (run / "c").mkdir(parents=True)
    write_mraw(run / "a.mraw", frames)
    write_genicam(run / "b.raw", frames, "Mono12p")
    write_im7(run / "c" / "B1.im7", frames)
    (run / "c.set").write_text("SetType = 1")
    names = ["a.mraw", "b.raw", "c.set"]
    refuse_outside(run, names)

    shutil.move(run / linked, tmp_path / "elsewhere")
    (run / linked).symlink_to(tmp_path / "elsewhere")
    with pytest.raises(FrameError, match=r"is a link to .*elsewhere"):
        refuse_outside(run, names)


def test_a_link_whose_name_is_a_pattern_of_another_file_is_refused(tmp_path):
    run, outside = tmp_path / "run", tmp_path / "secret.csv"
    run.mkdir()
    outside.touch()
    (run / "a.csv").touch()
    (run / "[ab].csv").symlink_to(outside)
    with pytest.raises(FrameError, match=r"\[ab\]\.csv is a link to .*secret"):
        refuse_outside(run, ["[ab].csv"])
