"""The page of `erlif start` in Chromium: from folders of frames to a film."""

import shutil
import tomllib
from pathlib import Path

import pytest
import xarray as xr
from scenes import browser

import erlif
from erlif.show.start import start_page

pytestmark = browser.MARKS

ROOT = Path(__file__).parents[3]

# Values of data_samples/straight_bushing as a user types them, with bare numbers and with units.
OF_THE_SAMPLE = {
    "camera1.band": "580",
    "camera2.band": "610 nm",
    "mechanism.crank": "5.5",
    "mechanism.coupler": "44",
    "mechanism.rocker": "26",
    "mechanism.ground": "0.51 m",
    "mechanism.crank_speed": "114",
    "joint.pin_radius": "33.36",
    "joint.bushing_radius": "33.59",
    "joint.length": "237",
    "joint.pin.youngs_modulus": "2.7",
    "joint.pin.poissons_ratio": "0.37",
    "joint.bushing.youngs_modulus": "2.7",
    "joint.bushing.poissons_ratio": "0.37",
    "oil.viscosity": "0.12",
    "oil.pressure_viscosity": "20",
}

FIXTURE_BY_HAND = """
[fixture]
name = "lab"
profile = "profile.csv"
origin = [0.0, 104.0]
[camera1]
files = "camera1/*.tif"
band = "580 nm"
bit_depth = 12
dark = "camera1_dark.tif"
flat = "camera1_flat.tif"
[camera2]
files = "camera2/*.tif"
band = "610 nm"
bit_depth = 12
dark = "camera2_dark.tif"
flat = "camera2_flat.tif"
[optics]
pixel_pitch = "75 um"
x_axis = "sliding"
"""

RUN_BY_HAND = """
calibration = "../fixture/calibration.nc"
[run]
name = "lab"
[camera1]
files = "camera1/*.tif"
band = "580 nm"
bit_depth = 12
dark = "camera1_dark.tif"
flat = "camera1_flat.tif"
background = "camera1_background.tif"
[camera2]
files = "camera2/*.tif"
band = "610 nm"
bit_depth = 12
dark = "camera2_dark.tif"
flat = "camera2_flat.tif"
background = "camera2_background.tif"
[optics]
pixel_pitch = "75 um"
x_axis = "sliding"
[encoder]
file = "encoder.csv"
mounted_on = "rocker"
triggers_per_cycle = 50
[mechanism]
kind = "crank-rocker"
crank = "5.5 cm"
coupler = "44 cm"
rocker = "26 cm"
ground = "0.51 m"
crank_speed = "114 rpm"
[joint]
pin_radius = "33.36 mm"
bushing_radius = "33.59 mm"
length = "237 mm"
pin = { youngs_modulus = "2.7 GPa", poissons_ratio = 0.37 }
bushing = { youngs_modulus = "2.7 GPa", poissons_ratio = 0.37 }
[oil]
viscosity = "0.12 Pa s"
pressure_viscosity = "20 1/GPa"
[thickness]
roi = { x = [3.75, 15], y = [2.25, 13.5] }
"""


@pytest.fixture(scope="module")
def chromium():
    with browser.chromium() as started:
        yield started


@pytest.fixture
def visit(chromium):
    """Open the page of a folder; errors and requests to other machines fail."""
    with browser.pages(chromium, own=("http://127.0.0.1:", "data:")) as new_page:

        def start(address, *, width=1400, **options):
            page = new_page(viewport={"width": width, "height": 900}, **options)
            page.set_default_timeout(120_000)
            page.goto(address)
            page.wait_for_selector("body[data-ready]")
            return page

        yield start


@pytest.fixture(scope="module")
def sample(tmp_path_factory):
    """Frames of the sample and of its fixture, without settings."""
    lab = tmp_path_factory.mktemp("sample") / "lab"
    shutil.copytree(ROOT / "data_samples/straight_bushing", lab / "run")
    shutil.copytree(ROOT / "calibration/wedge", lab / "fixture")
    for file in lab.glob("*/*.toml"):
        file.unlink()
    return lab


def take(page, name):
    """Open the folder that is suggested."""
    page.click(f"#card-{name} .take")
    page.wait_for_selector(f"#card-{name} .anew:visible")
    page.wait_for_selector("#panel-1 canvas[data-text*='image 1 of']")


def type_in(page, name, values):
    for place, value in values.items():
        page.fill(f'[id="{name}.{place}"]', value)
        page.keyboard.press("Tab")
        page.wait_for_selector(f'#asked .field:not(.gap)[data-place="{place}"]')


def at(page, column, row):
    """Place on the page of the centre of a pixel of camera 1."""
    box = page.locator("#panel-1 canvas").bounding_box()
    left, right, top, bottom = 50, 82, 8, 38
    width, height = (
        int(page.evaluate(f"document.body.dataset.{one}")) for one in ("columns", "rows")
    )
    return (
        box["x"] + left + (column + 0.5) / width * (box["width"] - left - right),
        box["y"] + top + (row + 0.5) / height * (box["height"] - top - bottom),
    )


def drag(page, start, end):
    page.locator("#panel-1 canvas").scroll_into_view_if_needed()
    page.mouse.move(*at(page, *start))
    page.mouse.down()
    page.mouse.move(*at(page, *end), steps=4)
    page.mouse.up()


def work(page, task, name):
    """Start a task and wait for its end."""
    page.click(f'.task[data-task="{task}"][data-name="{name}"]')
    page.wait_for_selector(f'body[data-work="{task}"], body[data-work="failed"]')
    return page.inner_text("#notes")


def by_hand(folder, frames, run, fixture):
    """The same frames with settings that were written by hand, processed by the command line."""
    for name, text in (("run", run), ("fixture", fixture)):
        shutil.copytree(frames / name, folder / "lab" / name)
        for file in ("run.toml", "fixture.toml", "film.nc", "calibration.nc"):
            (folder / "lab" / name / file).unlink(missing_ok=True)
        (folder / "lab" / name / f"{name}.toml").write_text(text)
    return folder / "lab" / "run"


def assert_same_film(one, two):
    with erlif.open_film(one) as found, erlif.open_film(two) as expected:
        xr.testing.assert_identical(found.drop_attrs(), expected.drop_attrs())
        assert found.attrs["settings"] == expected.attrs["settings"]


def test_from_the_frames_of_the_sample_to_the_film_of_the_command_line(
    visit, sample, tmp_path, command
):
    with start_page(sample) as address:
        page = visit(address)
        take(page, "fixture")

        # the scale by two marks 150 pixels apart, and the origin by a click
        page.check("input[value=scale]")
        drag(page, (50, 20), (200, 20))
        page.fill("#distance", "11.25")
        page.click("#apply")
        page.wait_for_selector('#changes >> text="fixture.toml: optics.pixel_pitch"')
        page.check("input[value=origin]")
        page.mouse.click(*at(page, 0, 104))
        page.wait_for_selector('#changes >> text="fixture.toml: fixture.origin"')
        type_in(page, "fixture", {"camera1.band": "580", "camera2.band": "610"})
        assert page.inner_text("#left") == "Nothing is asked for any more."

        take(page, "run")
        page.click('[data-place="optics.pixel_pitch"] >> text="75 um, as in fixture.toml"')
        page.wait_for_selector('.field:not(.gap)[data-place="optics.pixel_pitch"]')
        type_in(page, "run", OF_THE_SAMPLE)
        page.check("input[value=roi]")
        drag(page, (50, 30), (200, 180))
        page.wait_for_selector('#changes >> text="run.toml: thickness.roi"')

        for name, text in (("run", RUN_BY_HAND), ("fixture", FIXTURE_BY_HAND)):
            written = tomllib.loads((sample / name / f"{name}.toml").read_text())
            assert written == tomllib.loads(text)

        assert "camera1" in work(page, "check", "run")
        assert "calibrated range" in work(page, "calibrate", "fixture")
        assert "50 triggers" in work(page, "process", "run")
        with page.context.expect_page() as opened:
            page.click("#film a")
        opened.value.wait_for_selector("#panel-a canvas[data-text^='trigger']")

    run = by_hand(tmp_path, sample, RUN_BY_HAND, FIXTURE_BY_HAND)
    command("process", run)
    assert_same_film(sample / "run/film.nc", run / "film.nc")
