"""Recordings that a laboratory got wrong are found by check; good ones have no warning."""

import shutil

import numpy as np
import pytest
import tifffile
from click.testing import CliRunner
from scenes.terminal import unwrapped
from scenes.tiff_pages import rewrite

from conftest import SMALL
from erlif.commands.main import main
from erlif.rig import RigSettings, simulate


def renumber(frames, order):
    content = [path.read_bytes() for path in frames]
    for path, n in zip(frames, order, strict=True):
        path.write_bytes(content[n])


def both_cameras_the_same(lab):
    lab.edit("run/run.toml", ("camera2/*.tif", "camera1/*.tif"))


def copies_of_one_camera(lab):
    for one, two in zip(lab.frames(1), lab.frames(2), strict=True):
        shutil.copy(one, two)


def copies_of_one_pair(lab):
    for camera in (1, 2):
        first, *others = lab.frames(camera)
        for path in others:
            shutil.copy(first, path)


def a_stuck_frame(lab):
    shutil.copy(lab.frames(2)[2], lab.frames(2)[3])


def renumbered(*order):
    return lambda lab: renumber(lab.frames(2), order)


def exchange(one, two):
    aside = one.with_name("aside")
    one.rename(aside)
    two.rename(one)
    aside.rename(two)


def exchanged(one, two):
    return lambda lab: exchange(lab.run / one, lab.run / two)


def each_frame(change):
    def damage(lab):
        for path in (*lab.frames(1), *lab.frames(2)):
            rewrite(path, change)

    return damage


def scale_up(counts):
    """Eight bits as twelve."""
    return np.rint(counts // 16 * 16.06).astype("u2")


def turn(page):
    return page[::-1, ::-1]


def keep_pages(path, count):
    pages = tifffile.imread(path)[:count]
    with tifffile.TiffWriter(path) as file:
        for page in pages:
            file.write(page, contiguous=False, metadata=None)


def dark_cut_within_a_page(lab):
    path = lab.run / "camera2_dark.tif"
    path.write_bytes(path.read_bytes()[: path.stat().st_size * 2 // 3])


def flat_of_a_tilted_lamp(lab):
    tilt = np.linspace(0.7, 1.0, 128)
    rewrite(lab.run / "camera2_flat.tif", lambda page: (64 + (page - 64.0) * tilt).astype("u2"))


def flat_with_the_beam(lab):
    y, x = np.mgrid[-1:1:96j, -1:1:128j]
    beam = np.exp(-(x**2 + y**2) / 2)
    for camera in (1, 2):
        path = lab.run / f"camera{camera}_flat.tif"
        rewrite(path, lambda page: np.maximum(64 + (page - 64.0) * beam, 0).astype("u2"))


def flats_of_the_joint(lab):
    for camera in (1, 2):
        pages = [tifffile.imread(path) for path in lab.frames(camera)]
        with tifffile.TiffWriter(lab.run / f"camera{camera}_flat.tif") as file:
            for page in pages:
                file.write(page, contiguous=False, metadata=None)


def dark_with_light(lab):
    light = tifffile.imread(lab.frames(1)[0]) - 64.0
    rewrite(lab.run / "camera1_dark.tif", lambda page: (page + 0.05 * light).round().astype("u2"))


def a_missed_pulse(lab):
    for camera in (1, 2):
        dark = tifffile.imread(lab.run / f"camera{camera}_dark.tif")[0]
        rewrite(lab.frames(camera)[3], lambda counts, dark=dark: dark)


def kelvin(lab):
    path = lab.run / "encoder.csv"
    header, *rows = path.read_text().splitlines()
    column = header.split(",").index("temperature_C")
    for n, row in enumerate(rows):
        cells = row.split(",")
        cells[column] = f"{float(cells[column]) + 273.15:.2f}"
        rows[n] = ",".join(cells)
    path.write_text("\n".join([header, *rows]) + "\n")


def another_profile(lab):
    with (lab.fixture / "profile.csv").open("a") as file:
        file.write("20.0,18.9,0.01\n")


SWAPPED = "The cameras look swapped"
DAMAGES = [
    (both_cameras_the_same, 2, "both [camera1] and [camera2] name"),
    (copies_of_one_camera, 2, "both cameras show the same image"),
    (copies_of_one_pair, 2, "all 6 frame pairs that were read show the same image"),
    (a_stuck_frame, 1, "frame pairs 2, 3 show the same image"),
    (renumbered(5, 0, 1, 2, 3, 4), 2, "camera 2 is one pulse late. Remove the first frame"),
    (renumbered(5, 4, 3, 2, 1, 0), 2, "camera 2 are in reverse order. Number them"),
    (renumbered(0, 2, 1, 3, 4, 5), 2, "images of camera 2 are exchanged"),
    (exchanged("camera1", "camera2"), 2, SWAPPED),
    (exchanged("camera1_flat.tif", "camera2_flat.tif"), 2, SWAPPED),
    (exchanged("camera1_dark.tif", "camera1_flat.tif"), 2, "flat"),
    (each_frame(lambda counts: (counts // 16).astype("u1")), 1, "bit_depth = 8 would fit"),
    (each_frame(scale_up), 1, "frames of fewer bits were scaled or corrected"),
    (each_frame(lambda counts: counts & ~np.uint16(32)), 1, "bit 5 (value 32) is never set"),
    (
        lambda lab: keep_pages(lab.run / "camera2_dark.tif", 2),
        1,
        "camera2: 2 dark pages, the other camera has 4",
    ),
    (
        lambda lab: keep_pages(lab.run / "camera1_flat.tif", 4),
        1,
        "camera1: 4 flat pages, the other camera has",
    ),
    (dark_cut_within_a_page, 2, "camera2_dark.tif"),
    (flat_of_a_tilted_lamp, 1, "the light of their flats differs"),
    (flat_with_the_beam, 1, "It shows the beam of the laser, a film or a shadow"),
    (flats_of_the_joint, 1, "the flats of both cameras show one texture"),
    (lambda lab: rewrite(lab.run / "camera1_flat.tif", turn), 1, "The flat is of another camera"),
    (dark_with_light, 1, "light fell on the sensor"),
    (a_missed_pulse, 1, "frame pairs 3 have less than 10% of the light"),
    (kelvin, 1, "no oil of a rig has that"),
    (another_profile, 1, "profile.csv changed"),
]


@pytest.mark.parametrize(
    ("damage", "status", "words"), DAMAGES, ids=lambda one: getattr(one, "__name__", None)
)
def test_check_names_what_is_wrong(lab, damage, status, words):
    damage(lab)
    result = CliRunner().invoke(main, ["check", "--strict", str(lab.run)])
    assert "Traceback" not in result.output
    found = [line for line in unwrapped(result.stdout).splitlines() if not line.startswith("note")]
    assert result.exit_code == status, found
    assert words in "\n".join(found)


GOOD = [{"seed": 32, "light": 0.1}, {"seed": 33, "cycles": 2, "bubbles": 20}]


@pytest.mark.parametrize("change", GOOD, ids=str)
def test_a_good_recording_has_no_warning(tmp_path, change):
    options = dict(change)
    simulate(tmp_path / "rig", seed=options.pop("seed"), rig=RigSettings(**vars(SMALL) | options))
    for name in ("run", "fixture"):
        result = CliRunner().invoke(main, ["check", "--strict", str(tmp_path / "rig" / name)])
        assert result.exit_code == 0, result.output
