"""Excluded pixels against the area of polygons and against images that were drawn."""

import os

import numpy as np
import numpy.testing as npt
import pytest
import tifffile
from PIL import Image

from erlif.core.errors import ConfigError, FrameError
from erlif.core.notes import Level
from erlif.io.ingest import format_notes, hash_inputs, open_fixture, open_run, sign_inputs
from erlif.io.ingest.exclusions import exclude_pixels, exclusion_notes
from erlif.io.settings import ThicknessOptions

SHAPE, PITCH = (96, 128), 0.15
"""Rows and columns of the small rig's frames, and the size of a pixel. [mm]"""

TRIANGLE = [[3.0, 2.0], [15.1, 4.3], [7.7, 12.4]]


def fill(run, *entries, shape=SHAPE):
    thickness = ThicknessOptions(exclude=list(entries))
    settings = run.settings.model_copy(update={"thickness": thickness})
    return exclude_pixels(run.directory, settings, shape)


def with_entries(lab, *entries, directory="run"):
    """The settings of a run or fixture with these parts excluded."""
    path = lab.directory / directory / f"{directory}.toml"
    text = path.read_text(encoding="utf-8")
    head, table, tail = text.partition("[thickness]\n")
    line = f"exclude = {list(entries)}\n"
    path.write_text(f"{head}{table or '[thickness]' + chr(10)}{line}{tail}", encoding="utf-8")


def test_a_rectangle_holds_the_pixels_whose_centres_lie_in_it(run):
    columns, rows = (np.array([9.5, 31.5]) * PITCH, np.array([4.5, 10.5]) * PITCH)
    corners = [[float(columns[i]), float(rows[j])] for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
    expected = np.zeros(SHAPE, bool)
    expected[5:11, 10:32] = True
    npt.assert_array_equal(fill(run, corners), expected)


@pytest.mark.parametrize("corners", [3, 7, 360])
def test_the_area_of_a_regular_polygon_is_that_of_its_triangles(run, corners):
    """n/2 R^2 sin(2 pi/n), to the pixels of a quarter of a pixel along its edge."""
    radius, middle = 100.0, (150.3, 130.8)  # px
    turn = 0.1 + 2 * np.pi * np.arange(corners) / corners
    polygon = PITCH * (np.array(middle) + radius * np.column_stack([np.cos(turn), np.sin(turn)]))
    found = fill(run, polygon.tolist(), shape=(260, 300)).sum()
    area = corners / 2 * radius**2 * np.sin(2 * np.pi / corners)
    assert abs(found - area) < 0.25 * 2 * np.pi * radius


def test_several_parts_are_excluded_together_and_one_may_leave_the_image(run):
    other = [[-5.0, 10.0], [4.0, 10.0], [4.0, 99.0]]
    both = fill(run, TRIANGLE, other)
    npt.assert_array_equal(both, fill(run, TRIANGLE) | fill(run, other))
    assert both[-1, 25]


@pytest.mark.parametrize("kind", ["8 bit", "16 bit", "1 bit", "palette", "colours", "TIFF"])
def test_a_mask_image_is_that_of_the_polygon(lab, kind):
    wanted = fill(open_run(lab.run), TRIANGLE)
    white = np.where(wanted, 255, 0).astype(np.uint8)
    name = "mask.tif" if kind == "TIFF" else "mask.png"
    path = lab.run / name
    match kind:
        case "TIFF":
            tifffile.imwrite(path, white, compression="zlib")
        case "16 bit":
            Image.fromarray(wanted.astype(np.uint16)).save(path)  # 1 of 65535 is not black
        case _:
            modes = {"1 bit": "1", "palette": "P", "colours": "RGBA"}
            Image.fromarray(white).convert(modes.get(kind, "L")).save(path)

    with_entries(lab, name)
    run = open_run(lab.run)
    npt.assert_array_equal(run.pairs.excluded, wanted)
    assert name in hash_inputs(run)


def test_a_fixture_has_its_own_mask_and_a_changed_mask_is_another_input(lab):
    Image.fromarray(np.eye(*SHAPE, dtype=np.uint8)).save(lab.fixture / "mask.png")
    with_entries(lab, "mask.png", directory="fixture")
    before = open_fixture(lab.fixture)
    hashes = hash_inputs(before)
    Image.fromarray(np.eye(*SHAPE, 1, dtype=np.uint8)).save(lab.fixture / "mask.png")
    after = open_fixture(lab.fixture)
    assert [one.pairs.excluded[0].argmax() for one in (before, after)] == [0, 1]
    changed = {name for name, value in hash_inputs(after).items() if value != hashes[name]}
    assert changed == {"mask.png"}
    assert sign_inputs(after, {}) != sign_inputs(after, {lab.fixture / "mask.png": "5a"})


def test_a_mask_outside_the_directory_is_refused(lab):
    Image.fromarray(np.eye(*SHAPE, dtype=np.uint8)).save(lab.directory / "mask.png")
    with_entries(lab, "../mask.png")
    with pytest.raises(FrameError, match=r"\.\./mask\.png leaves the directory"):
        open_run(lab.run)


def save(array, size=None):
    def write(path):
        picture = Image.fromarray(array)
        (picture.resize(size) if size else picture).save(path)

    return write


WHITE = np.full(SHAPE, 255, np.uint8)
FAULTS = [
    (save(WHITE, (64, 48)), "a mask of 128 x 96 pixels, .* in mask.png; it has 64 x 48. Draw it"),
    (save(0 * WHITE), "white pixels in mask.png, .*; it is black. Draw them"),
    (save(WHITE), "pixels that are left; .* covers the whole image. In a mask .* invert it"),
    (lambda path: None, "mask.png; No such file or directory. Save it there, or correct exclude"),
    (lambda path: path.write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(90)), "it is damaged, or of"),
    (lambda path: path.write_text("white"), "PNG or TIFF, in .*mask.png; it is damaged, or of an"),
]


@pytest.mark.parametrize(("write", "message"), FAULTS)
def test_a_mask_image_that_cannot_be_used_is_refused(lab, write, message):
    write(lab.run / "mask.png")
    with_entries(lab, "mask.png")
    with pytest.raises(ConfigError, match=message):
        open_run(lab.run)


def test_a_pipe_is_no_mask(lab):
    os.mkfifo(lab.run / "mask.png")
    with_entries(lab, "mask.png")
    with pytest.raises(ConfigError, match="it is a pipe, not a regular file"):
        open_run(lab.run)


def test_a_polygon_beside_the_image_is_refused_with_both_extents(run):
    beside = [[20.0, 1.0], [25.0, 1.0], [22.0, 3.5]]
    message = r"x 0 to 19\.05 mm and y 0 to 14\.25 mm, .* x 20 to 25 mm and y 1 to 3\.5 mm covers"
    with pytest.raises(ConfigError, match=message):
        fill(run, TRIANGLE, beside)


@pytest.mark.parametrize(("rows", "level"), [(48, Level.NOTE), (49, Level.WARNING)])
def test_more_than_half_of_the_image_is_a_warning(run, rows, level):
    excluded = np.arange(96)[:, None] < np.full((1, 128), rows)
    (note,) = exclusion_notes(excluded)
    assert note.level is level
    assert note.text.startswith(f"{128 * rows} pixels, {100 * rows / 96:.1f} % of the image")
    assert not exclusion_notes(None)
    assert not [one for one in format_notes(run.pairs) if one.subject == "excluded"]
