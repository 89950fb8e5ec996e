"""Bad input on the command line: one message, status 2, and no half-written file."""

import errno
import os
import shutil
import subprocess
import sys

import h5py
import numpy as np
import pytest
import tifffile
import xarray as xr
from click.testing import CliRunner
from scenes.stores import GRID, VARIABLES
from scenes.tiff_pages import rewrite

import erlif
from erlif.commands.main import main
from erlif.core.flags import Flag
from erlif.io.files import NetcdfMaps, PartialFilm

pytestmark = pytest.mark.slow


def read_film(path, group=None):
    with erlif.open_film(path, group=group) as film:
        return film.load()


def snapshot(directory):
    """Every file below a directory with its bytes."""
    files = (path for path in directory.rglob("*") if path.is_file() and not path.is_symlink())
    return {path: path.read_bytes() for path in files}


def rewrite_all(directory, change):
    for path in directory.rglob("*.tif"):
        rewrite(path, change)


# what is refused: the change, the command, and what the message must contain


def truncate(path):
    path.write_bytes(path.read_bytes()[:6000])


def scramble(path):
    data = bytearray(path.read_bytes())
    data[9000:9100] = bytes(100)
    path.write_bytes(data)


def dangle(path):
    path.unlink()
    path.symlink_to("nowhere.tif")


DAMAGE = {
    "truncated": truncate,
    "empty": lambda path: path.write_bytes(b""),
    "damaged": lambda path: path.write_text("these are no pixels"),
    "cannot be read": dangle,
    "cannot be decoded": scramble,
}


def without(*frames):
    """Remove frames, each named by camera and number."""

    def change(lab):
        for path in [lab.frames(camera)[number] for camera, number in frames]:
            path.unlink()

    return change


def edited(*changes, file="run/run.toml"):
    return lambda lab: lab.edit(file, *changes)


def changed_log(change):
    """Change the rows of the log, the header among them."""

    def write(lab):
        log = lab.run / "encoder.csv"
        rows = log.read_text().splitlines()
        assert rows[0] == HEADER
        log.write_text("\n".join(change(rows)) + "\n")

    return write


def changed_profile(change):
    def write(lab):
        path = lab.fixture / "profile.csv"
        path.write_text("\n".join(change(path.read_text().splitlines())) + "\n")

    return write


def in_colour(lab):
    for path in (*lab.frames(1), *lab.frames(2)):
        tifffile.imwrite(path, np.zeros((96, 128, 3), np.uint8), photometric="rgb")


def left_aligned(depth):
    def change(lab):
        rewrite_all(lab.run, lambda counts: counts << 4)
        lab.edit("run/run.toml", ("bit_depth = 12", f"bit_depth = {depth}"))

    return change


def without_zero(lab):
    changed_log(cell(4, "angle_deg", "40"))(lab)
    settings = lab.run / "run.toml"
    lines = settings.read_text().splitlines()
    settings.write_text("\n".join(line for line in lines if not line.startswith("zero")))


def inverse_calibration(lab):
    with h5py.File(lab.fixture / "calibration.nc", "r+") as file:
        file.attrs["ratio_direction"] = "camera1/camera2"


def without_texture(lab):
    rng = np.random.default_rng(5)
    rewrite_all(lab.run, lambda counts: counts[:64, :64])
    for path in lab.frames(2):
        rewrite(path, lambda counts: rng.integers(500, 3000, counts.shape, np.uint16))
    lab.edit("run/run.toml", ("roi = {", "# roi = {"))


def exchange_cameras(directory):
    for name in ("camera{}", "camera{}_dark.tif", "camera{}_flat.tif"):
        one, two, between = (directory / name.format(n) for n in (1, 2, 3))
        one.rename(between)
        two.rename(one)
        between.rename(two)


HEADER = "frame,time_s,angle_deg,load_N,temperature_C,laser_mJ"


def cell(row, column, value):
    """Change one cell of the log; row 1 is the header."""

    def change(rows):
        cells = rows[row - 1].split(",")
        cells[HEADER.split(",").index(column)] = value
        return [*rows[: row - 1], ",".join(cells), *rows[row:]]

    return change


def header(old, new):
    return lambda rows: [rows[0].replace(old, new), *rows[1:]]


LOGS = [
    (cell(4, "angle_deg", "nan"), "row 4, column angle_deg", "'nan'"),
    (cell(4, "angle_deg", ""), "row 4, column angle_deg", "an empty cell"),
    (cell(3, "load_N", "full"), "row 3, column load_N", "'full'"),
    (cell(3, "load_N", "inf"), "row 3, column load_N", "'inf'"),
    (cell(3, "load_N", "0"), "row 3, column load_N", "positive"),
    (cell(5, "time_s", "1_0"), "row 5, column time_s", "'1_0'"),
    (cell(5, "frame", "2"), "row 5, column frame", "repeats frame 2 of row 4"),
    (cell(7, "frame", "6"), "row 7, column frame", "got 6", "missing"),
    (cell(7, "frame", "5.5"), "row 7, column frame", "5.5"),
    (lambda rows: [*rows[:3], *rows[4:]], "row 4, column frame", "Expected frame 2", "got 3"),
    (
        lambda rows: [*rows[:3], "", *cell(4, "angle_deg", "x")(rows)[3:]],
        "row 5, column angle_deg",
        "'x'",
    ),
    (lambda rows: [*rows[:3], rows[3] + ",7", *rows[4:]], "row 4", "6 values", "decimal"),
    (header("angle_deg", "angle"), "unit of column angle", 'units = { angle = "deg" }'),
    (header("angle_deg", "winkel"), "column for the angle", 'angle = "NAME"'),
    (cell(4, "time_s", "0.001"), "time to rise", "row 4, column time_s"),
    (
        cell(3, "temperature_C", "-300"),
        "-273.15 to 1000 degC",
        "row 3, column temperature_C",
        "-300 degC",
    ),
    (cell(3, "angle_deg", '"1,5"'), "row 3, column angle_deg", "decimal points"),
    (header("laser_mJ", "load_N"), "load_N comes 2 times"),
    (header("laser_mJ", "laser/mJ"), "column 6", "'laser/mJ'", "Rename"),
    (header("laser_mJ", "thickness"), "column 6", "'thickness'", "Rename"),
    (lambda rows: rows[:1], "rows of numbers"),
    (lambda rows: [], "rows of numbers"),
    (lambda rows: rows[:-1], "5 rows", "6 frames", "frame_0005.tif"),
    # 47.4095 and 71.8355 by eq. A.1
    (cell(4, "angle_deg", "40"), "Frame 2, the logged angle", "47.410 to 71.836 deg"),
]

PROFILES = [
    (lambda rows: rows[:6], "at least 8 points"),
    (
        lambda rows: [rows[0], *(f"{500 + n},1.0,0.1" for n in range(50))],
        "points of the profile in the image",
    ),
    (lambda rows: [*rows[:4], "0.3,thin,0.1", *rows[5:]], "row 5, column thickness_um"),
    (lambda rows: ["x,thickness", *rows[1:]], "x_mm,thickness_um"),
    (lambda rows: [], "x_mm,thickness_um"),
]

RUNS = [
    # frames and rows that do not pair
    (
        without((2, 3)),
        "camera1 has 6, camera2 has 5",
        "camera1/frame_0003.tif",
        "--skip-bad-frames",
    ),
    (without((1, 2), (2, 4)), "camera1/frame_0004.tif"),
    (without((1, 2), (2, 2)), "6 rows", "5 frames", "frame 2 of encoder.csv"),
    (edited(('"camera2/*.tif"', '"camera1/*.tif"')), "both [camera1] and [camera2]"),
    # size, type, depth
    (
        lambda lab: rewrite(lab.frames(1)[4], lambda counts: counts[:-2]),
        "camera1/frame_0004.tif",
        "128 x 96",
        "128 x 94",
    ),
    (
        lambda lab: rewrite(lab.frames(2)[1], lambda counts: (counts >> 4).astype(np.uint8)),
        "camera2/frame_0001.tif",
        "uint8",
    ),
    (in_colour, "grey frames"),
    (edited(("bit_depth = 12", "bit_depth = 10")), "up to 1023", "bit_depth = 12 fits"),
    (left_aligned(12), "multiples of 16", "12-bit counts, left-aligned"),
    (left_aligned(16), "multiples of 16", "12-bit counts, left-aligned"),
    (
        lambda lab: rewrite(lab.run / "camera1_flat.tif", lambda counts: counts[:, :-1]),
        "camera1_flat.tif",
    ),
    # log, linkage and calibration
    (without_zero, "24.426 deg", "40.000 deg"),
    (
        edited(('ground = "51 cm"', 'ground = "70 cm"')),
        "0.055, 0.44, 0.26 and 0.7 m",
        "crank must be the shortest link",
    ),
    (
        edited(('band = "580 nm"', 'band = "560 nm"')),
        "560 and 610 nm",
        "580 and 610 nm",
    ),
    (inverse_calibration, "camera2/camera1", "camera1/camera2"),
    (edited(('calibration = "../fixture/calibration.nc"', "")), "--calibration"),
    # registration and swapped cameras
    (without_texture, "texture", "times above chance"),
    (
        edited(("580 nm", "one"), ("610 nm", "580 nm"), ("one", "610 nm")),
        "610 nm on camera 1",
        "swapped",
    ),
    (lambda lab: exchange_cameras(lab.run), "inverse", "swapped"),
]

FIXTURES = [(lambda lab: exchange_cameras(lab.fixture), "falls", "swapped")]


def damaged_frame(reason):
    return lambda lab: DAMAGE[reason](lab.frames(2)[2])


def damaged_dark(reason):
    return lambda lab: DAMAGE[reason](lab.run / "camera1_dark.tif")


DAMAGED = [
    *(
        (damaged_frame(reason), "camera2/frame_0002.tif", reason, "--skip-bad-frames")
        for reason in DAMAGE
    ),
    *(
        (damaged_dark(reason), "camera1_dark.tif")
        for reason in DAMAGE
        if reason != "cannot be read"
    ),
]


@pytest.mark.parametrize(
    ("name", "cases"),
    [
        ("run", RUNS),
        ("run", DAMAGED),
        ("run", [(changed_log(change), *words) for change, *words in LOGS]),
        ("fixture", FIXTURES),
        ("fixture", [(changed_profile(change), *words) for change, *words in PROFILES]),
    ],
    ids=["runs", "damaged files", "logs", "fixtures", "profiles"],
)
def test_bad_input_is_refused_with_what_mends_it(small_rig, tmp_path, name, cases):
    """One message, status 2, and no file has changed."""
    missing = []
    for number, (change, *words) in enumerate(cases):
        lab = type(small_rig)(tmp_path / str(number))
        for part in ("run", "fixture"):
            shutil.copytree(small_rig.directory / part, lab.directory / part)
        change(lab)
        before = snapshot(lab.directory)
        arguments = {"run": ["process"], "fixture": ["calibrate", "--overwrite"]}[name]
        result = CliRunner().invoke(main, [*arguments, str(lab.directory / name)])
        message = result.stderr.partition("erlif: ")[2]
        refused = result.exit_code == 2 and result.stderr.count("erlif: ") == 1
        if not refused or snapshot(lab.directory) != before:
            missing.append(f"case {number}: {result.output}")
        missing += [
            f"case {number}: {word!r} in {message}" for word in words if word not in message
        ]
        shutil.rmtree(lab.directory)
    assert not missing


def test_the_proposed_way_to_drop_a_frame_works(lab, command):
    missing = lab.frames(2)[3]
    missing.write_bytes(b"")
    command("process", lab.run, "--skip-bad-frames")
    film = read_film(lab.film)
    assert film.frames_used.values.tolist() == [1, 1, 1, 0, 1, 1]


def test_cameras_may_count_from_different_numbers(lab):
    for number, path in reversed(list(enumerate(lab.frames(2)))):
        path.rename(path.with_name(f"frame_{number + 1:04d}.tif"))
    assert all(finding.level != "error" for finding in erlif.check(lab.run))


def test_counts_far_below_the_depth_bring_a_warning_into_the_film(lab, command):
    for table in ("run/run.toml", "fixture/fixture.toml"):
        lab.edit(table, ("bit_depth = 12", "bit_depth = 16"))
    warned = command("check", lab.run).stdout
    assert "warning counts: camera1: no count is above" in warned
    assert "bit_depth = 12 would fit" in warned
    assert "bit_depth = 12 would fit" in command("process", lab.run).stdout
    assert "bit_depth = 12 would fit" in read_film(lab.film).attrs["notes"]


def test_damaged_frames_are_left_out_on_request_and_have_notes(lab, command):
    for k, damage in enumerate(DAMAGE.values()):
        damage(lab.frames(1 + k % 2)[k])
    command("process", lab.run, "--skip-bad-frames")
    film, frames = read_film(lab.film), read_film(lab.film, "frames")
    assert film.frames_used.values.tolist() == [0, 0, 0, 0, 0, 1]
    for k, reason in enumerate(DAMAGE):
        assert (
            f"frame pair {k} left out: camera{1 + k % 2}/frame_{k:04d}.tif" in film.attrs["notes"]
        )
        assert reason in frames.attrs["skipped_frames"]
    assert (film.flags[:5] == Flag.OUTSIDE_OVERLAP).all()
    assert (np.isnan(film.thickness) == (film.flags != 0)).all()
    assert np.isfinite(film.film_mean.values).tolist() == [False] * 5 + [True]


def test_a_run_of_damaged_frames_only_is_refused_even_then(lab, refused):
    for path in lab.frames(1):
        path.write_bytes(b"")
    assert "every pair" in refused("process", lab.run, "--skip-bad-frames")


def test_the_fixture_leaves_out_damaged_frames_too(lab, command):
    (lab.fixture / "camera1" / "frame_0001.tif").write_bytes(b"")
    command("calibrate", lab.fixture, "--skip-bad-frames", "--overwrite")
    assert any(
        "frame pair 1 left out" in str(note)
        for note in erlif.open_calibration(lab.fixture / "calibration.nc").notes
    )


@pytest.mark.parametrize("what", ["missing", "text", "film", "cut"])
def test_a_file_that_is_no_calibration_is_refused(lab, refused, film, what):
    path = lab.directory / "other.nc"
    if what == "text":
        path.write_text("K = 0.3")
    elif what == "film":
        shutil.copy(film, path)
    elif what == "cut":
        path.write_bytes((lab.fixture / "calibration.nc").read_bytes()[:4000])
    message = refused("process", lab.run, "--calibration", path)
    assert "other.nc" in message or "missing from this file" in message
    assert "erlif calibrate" in message


def test_the_part_of_the_image_that_the_profile_covers_is_used(lab, command):
    changed_profile(lambda rows: rows[: len(rows) // 2])(lab)
    printed = command("calibrate", lab.fixture, "--overwrite").stdout
    assert "the profile covers" in printed
    low, high = erlif.open_calibration(lab.fixture / "calibration.nc").thickness_range
    assert low < 1.0
    assert 8.0 < high < 10.0  # half of a wedge from 0.1 to 18 um


def test_profile_points_out_of_order_are_sorted_with_a_note(lab, command):
    before = erlif.open_calibration(lab.fixture / "calibration.nc")
    changed_profile(lambda rows: [rows[0], *rows[:0:-1], rows[5]])(lab)
    printed = command("calibrate", lab.fixture, "--overwrite").stdout
    assert "sorted" in printed
    assert "repeat" in printed
    after = erlif.open_calibration(lab.fixture / "calibration.nc")
    np.testing.assert_allclose(after.parameters, before.parameters, rtol=0.01)


# output


def test_an_existing_output_is_replaced_only_on_request(lab, film, refused, command):
    shutil.copy(film, lab.film)
    assert "--overwrite" in refused("process", lab.run)
    assert "--overwrite" in refused("calibrate", lab.fixture)
    lab.film.write_bytes(b"")
    command("process", lab.run, "--overwrite")
    assert lab.film.read_bytes() == film.read_bytes()


@pytest.mark.parametrize("precious", ["fixture", "run/encoder.csv", "run/run.toml"])
def test_overwrite_replaces_nothing_but_products_of_erlif(lab, refused, precious):
    target = lab.directory / "film.nc"
    (lab.directory / precious).rename(target)
    (shutil.copytree if target.is_dir() else shutil.copy)(target, lab.directory / precious)
    message = refused("process", lab.run, "-o", target, "--overwrite")
    assert "does not replace" in message


def test_foreign_work_under_the_name_of_the_partial_film_is_left_alone(lab, refused):
    partial = lab.run / "film.nc.partial"
    partial.mkdir()
    (partial / "thesis.txt").write_text("years of work")
    assert "film.nc.partial" in refused("process", lab.run)


def process_and_die(lab, *, at, option=()):
    """Run `erlif process` in a process of its own that is killed when it reaches `at`."""
    script = f"""
import os, signal
from erlif.io.files import netcdf_maps as store
calls = 0
def die(*arguments, **options):
    os.kill(os.getpid(), signal.SIGKILL)
if {at!r} == "third trigger":
    write = store.write_record
    def write_and_die(*arguments):
        global calls
        calls += 1
        if calls == 3:
            die()
        return write(*arguments)
    store.write_record = write_and_die
else:
    complete = store.write_netcdf
    def complete_and_die(*arguments, group=None, **options):
        if group is not None:
            die()
        return complete(*arguments, **options)
    store.write_netcdf = complete_and_die
from erlif.commands.main import main
main({["process", str(lab.run), "--workers", "1", *option]!r})
"""
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False
    )
    assert done.returncode == -9, done.stderr


@pytest.fixture
def computed(monkeypatch):
    """Numbers of the triggers in the order in which they are computed."""
    triggers = []
    put = PartialFilm.put

    def note(partial, trigger, *rest):
        put(partial, trigger, *rest)
        triggers.append(trigger)

    monkeypatch.setattr(PartialFilm, "put", note)
    return triggers


def test_a_killed_process_is_resumed_and_gives_the_same_bytes(lab, film, command, computed):
    process_and_die(lab, at="third trigger")
    assert not lab.film.exists()
    command("process", lab.run, "--workers", 1)
    assert computed == [2, 3, 4, 5]
    assert lab.film.read_bytes() == film.read_bytes()
    assert [path.name for path in lab.run.iterdir() if "film" in path.name] == ["film.nc"]


def test_a_process_killed_while_writing_leaves_the_previous_film_and_resumes(
    lab, film, command, computed
):
    shutil.copy(film, lab.film)
    process_and_die(lab, at="the end", option=["--overwrite"])
    assert lab.film.read_bytes() == film.read_bytes()
    command("process", lab.run, "--overwrite")
    assert computed == []
    assert lab.film.read_bytes() == film.read_bytes()
    assert [path.name for path in lab.run.iterdir() if "film" in path.name] == ["film.nc"]


@pytest.mark.parametrize(
    ("old", "new"),
    [("roi = { x = [4, 15]", "roi = { x = [3, 15]"), ('"222.411 N"', '"200 N"')],
)
def test_a_partial_film_of_other_settings_is_not_resumed(lab, monkeypatch, computed, old, new):
    interrupt_at_third_trigger(monkeypatch, lab)
    lab.edit("run/run.toml", (old, new))
    erlif.process(lab.run, output=lab.film, workers=1).close()
    assert computed[-6:] == [0, 1, 2, 3, 4, 5]


def test_a_partial_film_of_another_frame_or_calibration_is_not_resumed(lab, monkeypatch, computed):
    interrupt_at_third_trigger(monkeypatch, lab)
    rewrite(lab.frames(1)[0], lambda counts: np.where(counts == counts.max(), counts - 1, counts))
    interrupt_at_third_trigger(monkeypatch, lab)
    with xr.open_dataset(lab.fixture / "calibration.nc", engine="h5netcdf") as dataset:
        changed = dataset.load().assign(ratio_at_zero=dataset.ratio_at_zero * 1.001)
    changed.to_netcdf(lab.fixture / "calibration.nc", engine="h5netcdf")
    interrupt_at_third_trigger(monkeypatch, lab)
    assert computed.count(0) == 3


def kept_triggers(lab):
    """Numbers of the triggers in the journal of the unfinished film, below its first line."""
    journal = lab.run / "film.nc.partial" / "journal"
    return list(range(len(journal.read_text().splitlines()) - 1))


def interrupt_at_third_trigger(monkeypatch, lab, error=KeyboardInterrupt):
    """Process the run with an error at the third trigger; gives result and triggers kept."""
    put = PartialFilm.put

    def put_others(partial, trigger, *rest):
        if trigger == 2:
            raise error
        put(partial, trigger, *rest)

    with monkeypatch.context() as patch:
        patch.setattr(PartialFilm, "put", put_others)
        result = CliRunner().invoke(
            main, ["process", str(lab.run), "--workers", "1", "--overwrite"]
        )
    kept = kept_triggers(lab)
    assert kept[:2] == [0, 1]
    assert 2 not in kept
    return result, kept


def test_an_interrupted_process_keeps_the_previous_film_and_resumes(
    lab, film, monkeypatch, command, computed
):
    lab.film.write_bytes(b"")
    result, kept = interrupt_at_third_trigger(monkeypatch, lab)
    assert result.exit_code == 130
    assert "resumes" in result.stderr
    assert "Traceback" not in result.output
    assert lab.film.read_bytes() == b""
    computed.clear()
    command("process", lab.run, "--workers", 1, "--overwrite")
    assert computed == [trigger for trigger in range(6) if trigger not in kept]
    assert lab.film.read_bytes() == film.read_bytes()


def test_a_disk_that_fills_up_between_triggers_keeps_what_is_done(
    lab, film, monkeypatch, command, computed
):
    reserve = NetcdfMaps._reserve

    def reserve_for_two(maps, size):
        if maps.has(1):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        reserve(maps, size)

    with monkeypatch.context() as patch:
        patch.setattr(NetcdfMaps, "_reserve", reserve_for_two)
        result = CliRunner().invoke(main, ["process", str(lab.run), "--workers", "1"])
    assert result.exit_code == 2
    assert "could not be written: No space left on device" in result.stderr
    assert not lab.film.exists()
    assert not list(lab.run.glob("**/*.unfinished"))
    computed.clear()
    command("process", lab.run, "--workers", 1)
    assert computed[0] == 2
    assert lab.film.read_bytes() == film.read_bytes()


def test_a_disk_too_full_for_the_film_leaves_the_previous_one(lab, film):
    """Files of the process are limited to a size that the film exceeds and two triggers do not."""
    shutil.copy(film, lab.film)
    script = f"""
import resource, signal
from erlif.commands.main import main
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (2**20 + 90_000, 2**20 + 90_000))
main(["process", {str(lab.run)!r}, "--workers", "1", "--overwrite"])
"""
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2, done.stderr
    assert "Traceback" not in done.stderr
    assert done.stderr.count("erlif: ") == 1
    assert "could not be written: File too large" in done.stderr
    assert 0 < len(kept_triggers(lab)) < 6
    assert lab.film.read_bytes() == film.read_bytes()
    assert not list(lab.run.glob("**/*.unfinished*"))


def test_a_disk_too_full_for_a_zarr_leaves_the_previous_one(lab, monkeypatch):
    output = lab.run / "film.zarr"
    (output / "thickness").mkdir(parents=True)
    (output / "zarr.json").write_text('{"attributes": {"erlif_version": "0.1.0"}}')

    def fill_up(*arguments, **options):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(xr.Dataset, "to_zarr", fill_up)
    result = CliRunner().invoke(main, ["process", str(lab.run), "-o", str(output), "--overwrite"])
    assert result.exit_code == 2
    assert "could not be written: No space left on device" in result.stderr
    assert {path.name for path in output.iterdir()} == {"zarr.json", "thickness"}
    assert not list(lab.run.glob("**/*.unfinished*"))


def test_a_second_process_on_the_same_output_is_refused(lab, refused):
    """The lock is held, as by a process that is still at work."""
    with PartialFilm(lab.film, "key of the first", GRID, VARIABLES):
        message = refused("process", lab.run)
    assert "another erlif process is writing it" in message


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("process", "run", "-o", "film.txt"), "Expected a name in .nc or .zarr"),
        (("calibrate", "fixture", "-o", "calibration.csv"), "Expected a name in .nc"),
        (("process", "run", "--calibration", "fixture"), "is a directory. Name its file"),
        (("process", "run/run.toml"), "Name the directory that holds it"),
        (("figures", "run"), "is a directory"),
        (("report", "run/run.toml"), "Make one with: erlif process"),
    ],
)
def test_a_name_of_the_wrong_kind_is_refused_with_the_right_one(lab, refused, arguments, expected):
    command, target, *rest = arguments
    rest = [lab.directory / item if not item.startswith("-") else item for item in rest]
    assert expected in refused(command, lab.directory / target, *rest)


def test_a_calibration_made_on_the_way_is_kept(lab, command):
    (lab.fixture / "calibration.nc").unlink()
    command("process", lab.run)
    assert erlif.open_calibration(lab.fixture / "calibration.nc").curve.sizes["bin"] > 20
