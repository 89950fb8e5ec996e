"""Recordings that a laboratory got wrong are found by check; good ones have no warning."""

import shutil

import numpy as np
import pytest
import tifffile
from click.testing import CliRunner
from scenes.terminal import unwrapped
from scenes.tiff_pages import rewrite

from conftest import SMALL, reorder
from erlif.commands.main import main
from erlif.rig import RigSettings, simulate


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
    return lambda lab: reorder(lab.frames(2), order)


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


def flat_of_a_tilted_lamp(lab):
    tilt = np.linspace(0.7, 1.0, 128)
    rewrite(lab.run / "camera2_flat.tif", lambda page: (64 + (page - 64.0) * tilt).astype("u2"))


def flats_of_the_joint(lab):
    for camera in (1, 2):
        pages = [tifffile.imread(path) for path in lab.frames(camera)]
        with tifffile.TiffWriter(lab.run / f"camera{camera}_flat.tif") as file:
            for page in pages:
                file.write(page, contiguous=False, metadata=None)


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
    (copies_of_one_camera, 2, "both cameras show the same image"),
    (copies_of_one_pair, 2, "all 6 frame pairs that were read show the same image"),
    (a_stuck_frame, 1, "frame pairs 2, 3 show the same image"),
    (renumbered(5, 0, 1, 2, 3, 4), 2, "camera 2 is one pulse late. Remove the first frame"),
    (exchanged("camera1", "camera2"), 2, SWAPPED),
    (exchanged("camera1_flat.tif", "camera2_flat.tif"), 2, SWAPPED),
    (exchanged("camera1_dark.tif", "camera1_flat.tif"), 2, "flat"),
    (each_frame(lambda counts: (counts // 16).astype("u1")), 1, "bit_depth = 8 would fit"),
    (each_frame(lambda counts: counts & ~np.uint16(32)), 1, "bit 5 (value 32) is never set"),
    (flat_of_a_tilted_lamp, 1, "the light of their flats differs"),
    (flats_of_the_joint, 1, "the flats of both cameras show one texture"),
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
