"""A first settings file from the files in a directory, and the way from there to a film."""

import re
import shutil
import tomllib
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import tifffile
import xarray as xr
from PIL import Image
from scenes.camera_files import random_frames, write_cine, write_mraw

import erlif
from conftest import SMALL
from erlif.core.errors import ConfigError
from erlif.core.notes import Level
from erlif.io.settings import read_run_settings
from erlif.rig import RigSettings, simulate


def photograph(directory: Path, *names: str, highest: int = 4000, shape=(64, 80)) -> None:
    """Write frames with counts from 60 to `highest`."""
    counts = np.linspace(60, highest, shape[0] * shape[1]).reshape(shape).astype(np.uint16)
    for name in names:
        path = directory / name
        path.parent.mkdir(parents=True, exist_ok=True)
        tifffile.imwrite(path, counts)


def frames(pattern: str, count: int = 4) -> list[str]:
    return [pattern.format(number) for number in range(count)]


def read(directory: Path, name: str = "run.toml") -> dict:
    return tomllib.loads((directory / name).read_text(encoding="utf-8"))


def warnings(notes) -> str:
    return "\n".join(str(note) for note in notes if note.level is Level.WARNING)


@pytest.fixture
def folder(tmp_path) -> Path:
    """Two cameras with four frames each, in a folder without settings."""
    directory = tmp_path / "bushing_7"
    photograph(directory, *frames("cam1_580nm/{}.tif"), *frames("cam2_610nm/{}.tif"))
    return directory


def fill_gaps(path: Path, values: dict[str, str]) -> None:
    """Fill in a settings file as a user does: line by line, by the names of table and key."""
    table, lines = "", []
    for line in path.read_text(encoding="utf-8").splitlines():
        if match := re.fullmatch(r"\[(.+)\]", line):
            table = match[1]
        if match := re.fullmatch(r'(\w+) = "\?\?.*"', line):
            line = f"{match[1]} = {values[f'{table}.{match[1]}']}"
        lines.append(line)
    path.write_text("\n".join(lines), encoding="utf-8")


# from a simulated run to its film

KNOWN = {
    "optics.pixel_pitch": '"150 um"',
    "mechanism.crank": '"5.5 cm"',
    "mechanism.coupler": '"44 cm"',
    "mechanism.rocker": '"26 cm"',
    "mechanism.ground": '"51 cm"',
    "mechanism.crank_speed": '"114 rpm"',
    "joint.pin_radius": '"33.36 mm"',
    "joint.bushing_radius": '"33.59 mm"',
    "joint.length": '"237 mm"',
    "joint.pin.youngs_modulus": '"2.7 GPa"',
    "joint.pin.poissons_ratio": "0.37",
    "joint.bushing.youngs_modulus": '"2.7 GPa"',
    "joint.bushing.poissons_ratio": "0.37",
    "oil.viscosity": '"0.12 Pa s"',
    "oil.pressure_viscosity": '"20 1/GPa"',
    "fixture.origin": "[0.0, 0.0]",
    "camera1.band": '"580 nm"',
    "camera2.band": '"610 nm"',
}


@pytest.mark.usefixtures("maps_alone")
def test_a_run_without_settings_becomes_the_same_film_once_the_gaps_are_filled(lab, film, command):
    original = (lab.run / "run.toml").read_text()
    zero, roi = (re.search(rf"{key} = .*", original)[0] for key in ("zero", "roi"))
    (lab.run / "run.toml").unlink()

    printed = command("init", lab.run, "--full").stdout
    assert f"{len(KNOWN) - 1} gaps are left" in printed  # the origin is that of the fixture
    assert read(lab.run)["calibration"] == "../fixture/calibration.nc"
    fill_gaps(lab.run / "run.toml", KNOWN)

    # optional keys, which the original has too
    noise = (('# gain = "4.4', 'gain = "4.4'), ('# read_noise = "9', 'read_noise = "9'))
    lab.edit("run/run.toml", *noise, *noise, ('# zero = "0 deg"', zero), ("# roi =", f"{roi} # "))

    assert "error" not in command("check", lab.run).stdout
    found = erlif.process(lab.run)
    with erlif.open_film(film) as expected:
        for name in ("thickness", "thickness_std", "flags", "film_min", "film_mean", "crank_angle"):
            xr.testing.assert_equal(found[name], expected[name])


def tidy_as_a_student(lab, folder: Path) -> None:
    """All of a measurement in one folder: frames of both cameras under two names, a foreign log."""
    for source, target in ((lab.fixture, folder / "calib"), (lab.run, folder / "images")):
        target.mkdir(parents=True)
        for camera, side in ((1, "left"), (2, "right")):
            for path in (source / f"camera{camera}").iterdir():
                number = int(re.findall(r"\d+", path.stem)[-1])
                shutil.copy(path, target / f"{side}{number + 1}.tif")
            for kind in ("dark", "flat"):
                shutil.copy(source / f"camera{camera}_{kind}.tif", folder / f"{kind}_{side}.tif")
    shutil.copy(lab.fixture / "profile.csv", folder / "calib" / "zeiss_profile.csv")
    log = np.genfromtxt(lab.run / "encoder.csv", delimiter=",", names=True)
    columns = (
        *(log["frame"] + 1, 1e3 * log["time_s"], log["angle_deg"]),
        *(log["load_N"] / 4.4482216152605, log["temperature_C"]),  # the pound-force of NIST
    )
    header = "sample\ttime (ms)\tencoder (deg)\tLoad cell [lbf]\tOil T (C)"
    np.savetxt(
        folder / "DAQ.txt", np.column_stack(columns), "%.10g", "\t", header=header, comments=""
    )


def test_a_measurement_in_one_folder_becomes_the_same_film(lab, film, tmp_path, command):
    """The fixture is no camera of the run, before and after it has its own settings."""
    folder = tmp_path / "measurement"
    tidy_as_a_student(lab, folder)
    texts = [note.text for note in erlif.init(folder)]
    assert any(text.startswith("calib is of a fixture: erlif init --fixture") for text in texts)
    shutil.copy(lab.fixture / "calibration.nc", folder / "calib")
    erlif.init(folder / "calib", fixture=True)
    notes = erlif.init(folder, overwrite=True)
    assert "calib holds a fixture and has no camera of the run" in [note.text for note in notes]
    assert "name no camera" not in warnings(notes)

    found = read(folder)
    for number, side in ((1, "left"), (2, "right")):
        expected = {"files": f"images/{side}*.tif", "dark": f"dark_{side}.tif"}
        assert expected.items() <= found[f"camera{number}"].items()
        assert found[f"camera{number}"]["flat"] == f"flat_{side}.tif"
    assert {"frame": "sample", "load": "Load cell [lbf]"}.items() <= found["encoder"].items()

    # gain, noise, zero and region of the rig, which no file shows
    original = read(lab.run)
    bands = {f"camera{n}.band": f'"{original[f"camera{n}"]["band"]}"' for n in (1, 2)}
    fill_gaps(folder / "run.toml", KNOWN | bands)
    text = (folder / "run.toml").read_text()
    for n in (1, 2):
        given = "".join(
            f'{key} = "{original[f"camera{n}"][key]}"\n' for key in ("gain", "read_noise")
        )
        text = text.replace(f"[camera{n}]\n", f"[camera{n}]\n{given}")
    text = text.replace("[encoder]\n", f'[encoder]\nzero = "{original["encoder"]["zero"]}"\n')
    roi = re.search(r"roi = .*", (lab.run / "run.toml").read_text())[0]
    (folder / "run.toml").write_text(f"{text}\n[thickness]\n{roi}\n")
    command("process", folder)
    with erlif.open_film(folder / "film.nc") as own, erlif.open_film(film) as expected:
        np.testing.assert_array_equal(own.thickness, expected.thickness)  # times are rounded
        np.testing.assert_allclose(own["joint_load"], expected["joint_load"], rtol=1e-8)


@pytest.mark.slow
@pytest.mark.usefixtures("maps_alone")
def test_a_run_with_a_log_in_time_goes_from_init_to_the_report(
    small_rig, film, tmp_path, command, monkeypatch
):
    """The frames of the same seed; a log at 10 kHz in the form of another logger."""
    simulate(tmp_path, seed=11, rig=RigSettings(**{**vars(SMALL), "log": "continuous"}))
    run = tmp_path / "run"
    shutil.copy(small_rig.fixture / "calibration.nc", tmp_path / "fixture" / "calibration.nc")
    (run / "run.toml").unlink()

    command("init", run)
    table = read(run)["encoder"]
    assert table["angle"] == "Encoder [deg]"
    assert table["pulse"] == "Trigger [V]"
    fill_gaps(run / "run.toml", KNOWN)
    assert "error" not in command("check", run).stdout
    command("process", run)
    monkeypatch.setattr("erlif.show.report.page.DRAWN", {})  # figures take most of the time
    command("report", run / "film.nc")
    assert "zero fitted to the dead points" in (run / "report.html").read_text(encoding="utf-8")

    # the zero is fitted here and given there; the marks are symmetric about the dead points
    with erlif.open_film(run / "film.nc") as found, erlif.open_film(film) as expected:
        np.testing.assert_array_equal(found.stroke, expected.stroke)
        np.testing.assert_allclose(found.rocker_speed, expected.rocker_speed, atol=0.05)
        np.testing.assert_allclose(found.film_min, expected.film_min, rtol=0.02)


def test_a_fixture_without_settings_is_ready_once_its_gaps_are_filled(lab, command):
    (lab.fixture / "fixture.toml").unlink()
    notes = erlif.init(lab.fixture, fixture=True)
    assert read(lab.fixture, "fixture.toml")["fixture"]["profile"] == "profile.csv"
    rows = len((lab.fixture / "profile.csv").read_text().splitlines()) - 1
    assert f"profile.csv, {rows} points" in "\n".join(map(str, notes))
    assert read(lab.fixture, "fixture.toml")["fixture"]["origin"] == "??"
    fill_gaps(lab.fixture / "fixture.toml", KNOWN)
    assert "error" not in command("check", lab.fixture).stdout


# like an earlier run

CONTACT = """
[contact]
load = "5 N"
body = { youngs_modulus = "210 GPa", poissons_ratio = 0.3, radius = "9.5 mm" }
counterbody = { youngs_modulus = "64 GPa", poissons_ratio = 0.2 }
[oil]
viscosity = "0.12 Pa s"
pressure_viscosity = "20 1/GPa"
"""


def moved(run: Path, target: Path) -> Path:
    """The files of a recording in another folder, without its settings."""
    shutil.copytree(run, target, ignore=shutil.ignore_patterns("*.toml", "*.nc"))
    return target


def test_what_the_rig_keeps_is_that_of_the_earlier_run(lab, tmp_path, command):
    """Two of the 17 gaps are left, with the earlier values beside them."""
    again = moved(lab.run, tmp_path / "may")
    printed = command("init", again, "--like", lab.run).stdout
    assert "2 gaps are left" in printed
    text = (again / "run.toml").read_text(encoding="utf-8")
    assert f'-> "114 rpm" in {lab.run}' in re.sub(r"\n# ", " ", text)
    fill_gaps(again / "run.toml", KNOWN)

    apart = {"run", "calibration"}
    earlier = read_run_settings(lab.run).model_dump(exclude=apart)
    found = read_run_settings(again).model_dump(exclude=apart)
    earlier["encoder"]["triggers_per_cycle"] = found["encoder"]["triggers_per_cycle"]
    assert found == earlier | {"joint": found["joint"]}
    assert found["joint"] == earlier["joint"] | {"load": None}  # the log has it


def test_the_contact_and_the_oil_of_an_earlier_disc_are_kept(tmp_path):
    rig = replace(SMALL, mechanism="rotation", pictures=4)
    run = simulate(tmp_path / "disc", seed=3, rig=rig) / "run"
    path = run / "run.toml"
    path.write_text(path.read_text(encoding="utf-8") + CONTACT, encoding="utf-8")
    again = moved(run, tmp_path / "may")
    erlif.init(again, like=run)
    settings = read(again)
    assert settings["contact"]["counterbody"] == read(run)["contact"]["counterbody"]
    assert settings["thickness"]["roi"] == read(run)["thickness"]["roi"]
    assert settings["oil"] == {"viscosity": "?? Pa s", "pressure_viscosity": "20 1/GPa"}
    assert (settings["mechanism"]["speed"], settings["contact"]["load"]) == ("?? rpm", "?? N")


@pytest.mark.parametrize("full", [True, False])
def test_the_fixture_of_an_earlier_day_leaves_its_origin(lab, tmp_path, full):
    again = moved(lab.fixture, tmp_path / "may")
    erlif.init(again, fixture=True, like=lab.fixture, full=full)
    text = (again / "fixture.toml").read_text(encoding="utf-8")
    assert [line for line in text.splitlines() if re.match(r'\w+ = "\?\?', line)] == [
        'origin = "??"'
    ]


def test_an_earlier_run_with_gaps_is_refused(folder):
    erlif.init(folder)
    with pytest.raises(ConfigError, match="gaps are left"):
        erlif.init(folder, overwrite=True, like=folder)


# what is found out


def test_patterns_bands_depth_and_name_are_filled_in(folder):
    notes = erlif.init(folder)
    settings = read(folder)
    assert settings["run"]["name"] == "bushing 7"
    assert settings["camera1"]["files"] == "cam1_580nm/*.tif"
    assert settings["camera2"]["files"] == "cam2_610nm/*.tif"
    assert [settings[f"camera{n}"]["band"] for n in (1, 2)] == ["580 nm", "610 nm"]
    assert settings["camera1"]["bit_depth"] == 12
    assert str(notes[0]) == "camera1: 4 frames of 80 x 64 uint16, cam1_580nm/*.tif"
    assert "no dark frames" in warnings(notes)
    assert settings["camera1"]["offset"] == "?? DN"


@pytest.mark.parametrize("name", ["mask.png", "cam1_580nm/Mask_bolt.tif"])
def test_an_image_named_as_a_mask_is_excluded_and_no_frame(folder, name):
    """The names of the frames are as before, also where the mask lies among them."""
    Image.fromarray(np.eye(64, 80, dtype=np.uint8)).save(folder / name)
    notes = erlif.init(folder)
    settings = read(folder)
    assert settings["thickness"]["exclude"] == [name]
    assert settings["camera1"]["files"].startswith("cam1_580nm/")
    assert "belong to no camera" not in warnings(notes)


@pytest.mark.parametrize("name", ["run", "fixture"])
def test_a_folder_named_run_takes_the_name_of_its_parent(folder, name):
    erlif.init(folder.rename(folder.parent / name))
    settings = read(folder.parent / name)
    assert settings["run"]["name"] == folder.parent.name.replace("_", " ").strip()


@pytest.mark.parametrize(
    ("bits", "shift", "depth", "alignment"),
    [(10, 6, 10, "left"), (12, 4, 12, "left"), (14, 2, 14, "left"), (10, 2, 12, None)],
)
def test_left_aligned_counts_are_noticed(tmp_path, bits, shift, depth, alignment):
    """Those of ten bits at the high end of twelve have to be divided."""
    counts = (np.arange(64 * 80).reshape(64, 80) % (1 << bits)).astype(np.uint16)
    for name in ("cam1.tif", "cam2.tif"):
        tifffile.imwrite(tmp_path / name, counts << shift)
    text = warnings(erlif.init(tmp_path))
    assert ("left-aligned. Divide the counts by 4" in text) == (alignment is None)
    assert read(tmp_path)["camera1"].get("alignment") == alignment
    assert read(tmp_path)["camera1"]["bit_depth"] == depth


def recordings_of_a_camera(directory):
    counts = np.linspace(60, 200, 4 * 64 * 80).reshape(4, 64, 80).astype(np.uint16)
    for camera in (1, 2):
        write_mraw(directory / f"camera{camera}.mraw", counts, stored=16, depth=12)


def alternating_pages(directory):
    counts = np.random.default_rng(1).integers(60, 4000, (8, 64, 80), dtype=np.uint16)
    tifffile.imwrite(directory / "recording.tif", counts, photometric="minisblack")
    tifffile.imwrite(directory / "dark.tif", counts[:4] // 60, photometric="minisblack")
    rows = "".join(f"{k},{k}\n" for k in range(4))
    (directory / "encoder.csv").write_text("frame,angle_deg\n" + rows)


def datasets_of_one_file(directory):
    with h5py.File(directory / "run.h5", "w") as file:
        for camera in (1, 2):
            for name in ("counts", "dark"):
                file[f"camera{camera}/{name}"] = np.full((3, 64, 80), 9 * camera, np.uint16)


@pytest.mark.parametrize(
    ("build", "one", "two", "words"),
    [
        (
            recordings_of_a_camera,
            {"files": "camera1.mraw", "bit_depth": 12},
            {"files": "camera2.mraw", "bit_depth": 12},
            ("After the headers; largest count 200 in 4 images.",),
        ),
        (
            alternating_pages,
            {"files": "recording.tif", "part": "odd", "dark": "dark.tif"},
            {"files": "recording.tif", "part": "even", "dark": "dark.tif"},
            ("4 frames of 80 x 64 uint16",),
        ),
        (
            datasets_of_one_file,
            {"files": "run.h5", "dark": "run.h5", "dataset": "/camera1/counts"},
            {"dataset": "/camera2/counts", "dark_dataset": "/camera2/dark"},
            (),
        ),
    ],
)
def test_cameras_are_recognised_by_their_files(tmp_path, build, one, two, words):
    build(tmp_path)
    assert "rows for" not in warnings(erlif.init(tmp_path))
    found = read(tmp_path)
    assert one.items() <= found["camera1"].items()
    assert two.items() <= found["camera2"].items()
    text = (tmp_path / "run.toml").read_text(encoding="utf-8")
    assert all(word in text for word in words)


def test_the_columns_of_the_log_decide_whether_a_load_is_needed(folder):
    log = folder / "encoder.csv"
    log.write_text("frame,angle_deg\n" + "".join(f"{k},{k}\n" for k in range(4)))
    erlif.init(folder)
    assert read(folder)["encoder"]["file"] == "encoder.csv"
    assert read(folder)["joint"]["load"] == "?? lbf"
    log.write_text("frame,angle_deg,load_N\n" + "".join(f"{k},{k},9\n" for k in range(4)))
    erlif.init(folder, overwrite=True)
    assert "load" not in read(folder)["joint"]


def test_triggers_per_cycle_and_crank_speed_come_from_the_log(folder):
    photograph(folder, *frames("cam1_580nm/{}.tif", 36), *frames("cam2_610nm/{}.tif", 36))
    rows = [f"{k},{k * 0.05:.3f},{20 * np.sin(np.radians(30 * k)):.4f}" for k in range(36)]
    (folder / "encoder.csv").write_text("frame,time_s,angle_deg\n" + "\n".join(rows))
    erlif.init(folder)
    assert read(folder)["encoder"]["triggers_per_cycle"] == 12
    assert read(folder)["encoder"]["mounted_on"] == "rocker"
    assert read(folder)["mechanism"]["crank_speed"] == "?? rpm"
    # twelve triggers of 50 ms: a turn in 0.6 s
    assert "The times of the log give 100 rpm." in (folder / "run.toml").read_text()


def test_the_fixture_beside_the_run_is_named_as_its_calibration(lab):
    (lab.run / "run.toml").unlink()
    (lab.fixture / "calibration.nc").unlink()
    erlif.init(lab.run)
    assert read(lab.run)["calibration"] == "../fixture/calibration.nc"
    text = (lab.run / "run.toml").read_text()
    assert "The calibration has 150 um" in text
    assert read(lab.run)["optics"]["pixel_pitch"] == "?? um"  # a hint, not a value


# what is missing or does not fit


def test_all_recordings_in_one_folder_are_offered_one_by_one(tmp_path):
    for band in (580, 610):
        for name, pages in (("run03", 5), ("run04", 6), ("wedge", 2)):
            write_cine(
                tmp_path / f"Cam_{band}nm_{name}.cine",
                random_frames(np.random.default_rng(1), frames=pages),
            )
    notes = erlif.init(tmp_path, kind="static")
    assert "camera1: 3 recordings look like frames: Cam_580nm_run03.cine (5)" in warnings(notes)
    assert any(note.subject == "fixture" and "init --fixture" in note.text for note in notes)
    assert read(tmp_path)["camera1"]["files"] == "??"
    erlif.init(tmp_path, fixture=True)
    assert read(tmp_path, "fixture.toml")["camera2"]["files"] == "Cam_610nm_wedge.cine"


def test_a_fixture_that_was_not_calibrated_is_no_calibration_yet(folder):
    for name in ("a", "b"):
        (folder.parent / name).mkdir()
        (folder.parent / name / "fixture.toml").touch()
    text = warnings(erlif.init(folder))
    assert "calibrations or fixtures lie near" in text
    assert "../b/calibration.nc (not made yet, from its fixture.toml)" in text


def test_an_empty_folder_is_refused(tmp_path, refused):
    assert "no image file" in refused("init", tmp_path)


def test_a_folder_of_a_format_that_is_not_read_is_refused_with_the_reason(tmp_path, refused):
    for name in ("a1.jpg", "a2.JPEG"):
        (tmp_path / name).write_bytes(b"\xff\xd8\xff")
    message = refused("init", tmp_path)
    assert "the 2 images in it cannot be read. a1.jpg: it is a JPEG image, compressed" in message


@pytest.mark.parametrize(
    "sets", [("dark_a", "dark_b"), ("darks 1/x", "darks 2/x"), ("dark1", "dark2")]
)
def test_darks_that_name_no_camera_are_proposed_in_their_order(tmp_path, sets):
    for camera in ("left", "right"):
        (tmp_path / camera).mkdir()
        for k in range(3):
            tifffile.imwrite(tmp_path / camera / f"{k}.tif", np.full((64, 80), 900, np.uint16))
    for name in sets:
        path = tmp_path / f"{name}.tif"
        path.parent.mkdir(exist_ok=True)
        tifffile.imwrite(path, np.full((64, 80), 60, np.uint16))
    notes = erlif.init(tmp_path)
    settings = read(tmp_path)
    assert [settings[f"camera{n}"]["dark"] for n in (1, 2)] == [f"{name}.tif" for name in sets]
    assert "taken in the order of their names: check them" in warnings(notes)


@pytest.mark.parametrize("first", ["frame,angle_deg", "t [s],angle [deg]"])
def test_the_temperature_of_the_oil_is_known_and_foreign_columns_are_named(folder, first):
    rows = "".join(f"{k},{k % 3},25.{k},7,Bob,50\n" for k in range(4))
    (folder / "log.csv").write_text(f"{first},T oil [degree C],Vib X [g],Operator,laser_mJ\n{rows}")
    texts = [note.text for note in erlif.init(folder)]
    assert "not used: 'Vib X [g]', 'Operator'" in texts
    table = read(folder)["encoder"]
    assert table["file"] == "log.csv"
    assert table.get("temperature", "T oil [degree C]") == "T oil [degree C]"


def write_log(name, text):
    return lambda folder: (folder / name).write_text(text)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda folder: shutil.rmtree(folder / "cam2_610nm"), ["one camera only"]),
        (lambda folder: photograph(folder, *frames("cam3_640nm/{}.tif")), ["3 groups of frames"]),
        (
            lambda folder: (folder / "cam2_610nm" / "2.tif").unlink(),
            ["camera1 has 4 frames, camera2 has 3"],
        ),
        (
            lambda folder: photograph(folder, *frames("cam2_610nm/{}.tif"), shape=(70, 90)),
            ["80 x 64 uint16, camera2 of 90 x 70 uint16"],
        ),
        (
            write_log("log.csv", "index,angle\n0,1\n"),
            ["frame, angle_deg", "log.csv (index, angle)"],
        ),
        (write_log("encoder.csv", "frame,angle_deg\n0,1\n1,2\n2,3\n"), ["3 rows for 4 frames"]),
        (
            lambda folder: photograph(folder, "darks/A.tif", highest=100),
            ["there are darks/A.tif: in [camera1], write dark ="],
        ),
        (
            lambda folder: (folder / "cam1_580nm" / "2.tif").write_bytes(b"no image"),
            ["camera1", "2.tif"],
        ),
        (
            lambda folder: photograph(folder, "cam1_580nm/4.tif", shape=(70, 90)),
            ["the frames differ in size or type: 80 x 64 uint16, 90 x 70 uint16"],
        ),
        (
            write_log("encoder.csv", "frame,angle_deg\n0,1\n1,2\n2,x\n3,4\n"),
            ["encoder log", "row 4"],
        ),
    ],
)
def test_what_does_not_fit_is_reported(folder, change, words):
    change(folder)
    text = warnings(erlif.init(folder))
    assert all(word in text for word in words)


def test_a_fixture_whose_profile_is_no_table_of_numbers_is_reported(folder):
    photograph(folder, "fixture/cam1_580nm/0.tif", "fixture/cam2_610nm/0.tif")
    (folder / "fixture" / "wedge.csv").write_text("x_mm,thickness_um\n0,1\n1,x\n")
    assert "wedge.csv" in warnings(erlif.init(folder / "fixture", fixture=True))


# what is left to do


def test_columns_with_names_of_another_language_are_gaps_that_list_them(folder):
    rows = "".join(f"{k / 10};{k % 7};5\n".replace(".", ",") for k in range(40))
    path = folder / "messung7.csv"
    path.write_text(f"Messung 7;;\nZeit;Drehgeber;Kraft\n{rows}", encoding="utf-16")
    text = warnings(erlif.init(folder))
    assert "messung7.csv is known by its name as angle or time: choose from 'Zeit', " in text
    table = read(folder)["encoder"]
    assert (table["file"], table["angle"], table["time"]) == ("messung7.csv", "??", "??")
    assert "One of the columns 'Zeit', 'Drehgeber', 'Kraft'." in (folder / "run.toml").read_text()


def test_a_log_in_time_needs_the_times_of_the_frames(folder):
    rows = "".join(f"{k / 10},{k % 7}\n" for k in range(40))
    (folder / "rig.txt").write_text(f"t [s],angle\n{rows}")
    text = warnings(erlif.init(folder))
    assert "column 'angle' has no unit that is known" in text
    (folder / "rig.txt").write_text(f"t [s],angle [deg]\n{rows}")
    text = warnings(erlif.init(folder, overwrite=True))
    assert "40 rows for 4 frames, a log in time" in text
    assert read(folder)["encoder"]["mounted_on"] == "rocker"


# other tribometers


def test_columns_of_a_logger_serve_a_disc(folder):
    """Angle and time give the speed, so that the radius is the only gap of the motion."""
    rows = [f"{k / 10};{30 * k};20".replace(".", ",") for k in range(4)]
    text = "Time [s];Encoder [deg];Force [N]\n" + "\n".join(rows) + "\n"
    (folder / "logger.csv").write_text(text, encoding="utf-8")
    erlif.init(folder, kind="rotation")
    settings = read(folder)
    assert settings["mechanism"] == {"kind": "rotation", "radius": "?? mm"}
    assert settings["encoder"]["file"] == "logger.csv"
    assert settings["encoder"]["angle"] == "Encoder [deg]"
    assert settings["encoder"]["time"] == "Time [s]"
    text = (folder / "run.toml").read_text(encoding="utf-8")
    assert "columns separated by semicolons; decimal commas" in text
    assert "mounted_on" not in settings["encoder"]
    assert not {"joint", "oil"} & set(settings)


def test_a_log_of_other_names_serves_a_disc_by_its_units(folder):
    """Two pictures a turn, over two turns."""
    rows = [f"{k / 10};{180 * k % 360 + 11};20".replace(".", ",") for k in range(4)]
    path = folder / "logger.csv"
    path.write_text("Zeit [s];Winkel [deg];Kraft [N]\n" + "\n".join(rows) + "\n")
    text = warnings(erlif.init(folder, kind="rotation"))
    assert "chosen by the unit alone: angle from 'Winkel [deg]', time from 'Zeit [s]'" in text
    found = read(folder)["encoder"]
    chosen = {"angle": "Winkel [deg]", "time": "Zeit [s]", "load": "Kraft [N]"}
    assert found == {"file": "logger.csv", "triggers_per_cycle": 2, **chosen}

    # two columns that may hold the angle
    path.write_text(path.read_text().replace("Zeit [s]", "Tisch [deg]"))
    text = warnings(erlif.init(folder, kind="rotation", overwrite=True))
    assert "choose from 'Tisch [deg]', 'Winkel [deg]', 'Kraft [N]'" in text
    assert read(folder)["encoder"]["angle"].startswith("??")


def test_a_disc_without_a_log_needs_its_speed_and_a_slider_its_zero(folder):
    text = " ".join(map(str, erlif.init(folder, kind="rotation")))
    assert "none was found; each frame is a trigger" in text
    assert read(folder)["mechanism"]["speed"] == "?? rpm"
    assert "encoder" not in read(folder)

    (folder / "encoder.csv").write_text("frame,time_s\n0,0\n1,0.1\n2,0.2\n3,0.3\n")
    erlif.init(folder, kind="sinusoidal", overwrite=True)
    assert read(folder)["encoder"] == {"file": "encoder.csv", "zero": "?? deg"}
    assert read(folder)["mechanism"]["stroke"] == "?? mm"
    assert read(folder)["mechanism"]["frequency"] == "?? Hz"
