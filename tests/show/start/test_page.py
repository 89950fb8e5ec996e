"""The page of `erlif start` in Chromium: from folders of frames to a film."""

import json
import shutil
import time
import tomllib
from contextlib import closing, contextmanager
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import pytest
import tifffile
import xarray as xr
from PIL import Image
from scenes import browser
from scenes.rig import small_rig
from scenes.start import OF_THE_SAMPLE, at, drag, take, type_in

import erlif
from erlif.core.errors import ErlifError
from erlif.rig import simulate
from erlif.show.start import start_page
from erlif.show.start.page import StartPage

pytestmark = browser.MARKS

FIXTURE_BY_HAND = """
[fixture]
name = "lab"
profile = "profile.csv"
origin = [0.0, 48.0]
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
pixel_pitch = "150 um"
x_axis = "sliding"
"""

DISC_BY_HAND = """
calibration = "../fixture/calibration.nc"
[run]
name = "lab"
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
pixel_pitch = "150 um"
x_axis = "sliding"
[encoder]
file = "encoder.csv"
[mechanism]
kind = "rotation"
radius = "20 mm"
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
pixel_pitch = "150 um"
x_axis = "sliding"
[encoder]
file = "encoder.csv"
mounted_on = "rocker"
triggers_per_cycle = 16
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
    """The page of a folder; errors and requests to other machines fail.

    The page is closed before its server, which pictures still come from.
    """

    @contextmanager
    def start(directory, *, width=1400, **options):
        with start_page(directory) as address:  # noqa: SIM117
            with browser.pages(chromium, own=("http://127.0.0.1:", "data:")) as new_page:
                page = new_page(viewport={"width": width, "height": 900}, **options)
                page.set_default_timeout(60_000)
                page.goto(address)
                page.wait_for_selector("body[data-ready]")
                yield page

    return start


def photograph(directory, **changes):
    """Frames of a rig and of its fixture, without settings."""
    simulate(directory, seed=3, rig=small_rig(**changes))
    for file in directory.glob("*/*.toml"):
        file.unlink()
    return directory


@pytest.fixture
def joint(tmp_path):
    """Frames of a joint, whose bushing was photographed without dye too."""
    return photograph(tmp_path / "lab", background=0.01, background_pages=2)


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


@pytest.mark.usefixtures("maps_alone")
def test_from_the_frames_of_a_joint_to_the_film_of_the_command_line(
    visit, joint, tmp_path, command
):
    with visit(joint) as page:
        take(page, "fixture")

        # the scale by two marks 75 pixels apart, and the origin by a click
        page.check("input[value=scale]")
        drag(page, (25, 20), (100, 20))
        page.fill("#distance", "11.25")
        page.click("#apply")
        page.wait_for_selector('#changes >> text="fixture.toml: optics.pixel_pitch"')
        page.check("input[value=origin]")
        page.mouse.click(*at(page, 0, 48))
        page.wait_for_selector('#changes >> text="fixture.toml: fixture.origin"')
        type_in(page, "fixture", {"camera1.band": "580", "camera2.band": "610"})
        assert page.inner_text("#left") == "Nothing is asked for any more."

        take(page, "run")
        page.click('[data-place="optics.pixel_pitch"] >> text="150 um, as in fixture.toml"')
        page.wait_for_selector('.field:not(.gap)[data-place="optics.pixel_pitch"]')
        type_in(page, "run", OF_THE_SAMPLE)
        page.check("input[value=roi]")
        drag(page, (25, 15), (100, 90))
        page.wait_for_selector('#changes >> text="run.toml: thickness.roi"')

        for name, text in (("run", RUN_BY_HAND), ("fixture", FIXTURE_BY_HAND)):
            written = tomllib.loads((joint / name / f"{name}.toml").read_text())
            assert written == tomllib.loads(text)

        assert "camera1" in work(page, "check", "run")
        assert "calibrated range" in work(page, "calibrate", "fixture")
        assert "16 triggers" in work(page, "process", "run")
        with page.context.expect_page() as opened:
            page.click("#film a")
        opened.value.wait_for_selector("#panel-a canvas[data-text^='trigger']")

    run = by_hand(tmp_path / "again", joint, RUN_BY_HAND, FIXTURE_BY_HAND)
    command("process", run)
    assert_same_film(joint / "run/film.nc", run / "film.nc")


@pytest.fixture
def disc(tmp_path):
    """Frames of a pin on disc and of its fixture, without settings."""
    return photograph(tmp_path / "lab", mechanism="rotation", pictures=8)


def reach(page, selector):
    """Go to an element by the Tab key alone, in at most one turn around the page."""
    for _ in range(400):
        if page.evaluate("selector => document.activeElement?.matches(selector)", selector):
            return
        page.keyboard.press("Tab")
    raise AssertionError(f"no way to {selector} by the keyboard")


def press(page, *keys):
    for key in keys:
        page.keyboard.press(key)


@pytest.mark.usefixtures("maps_alone")
def test_a_pin_on_disc_by_the_keyboard_alone_on_a_narrow_dark_screen(
    visit, disc, tmp_path, command
):
    with visit(disc, width=390, color_scheme="dark") as page:
        assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(22, 24, 27)"
        reach(page, "#card-fixture .take")
        press(page, "Enter")
        page.wait_for_selector("#panel-1 canvas[data-text*='image 1 of']")

        # 96 pixels of the scale are 14.4 mm; the cursor begins in the middle of 128 x 96 pixels
        reach(page, "input[name=tool]")
        press(page, "ArrowRight")
        reach(page, "#panel-1 canvas")
        press(page, *["Shift+ArrowLeft"] * 5, "Enter", *["Shift+ArrowRight"] * 9)
        press(page, *["ArrowRight"] * 6, "Enter")
        page.wait_for_selector("#distance:focus")
        page.keyboard.type("14.4")
        press(page, "Enter")
        page.wait_for_selector('#changes >> text="fixture.toml: optics.pixel_pitch"')
        typed = {"fixture.origin": "[0, 48]", "camera1.band": "580", "camera2.band": "610"}
        for place, value in typed.items():
            reach(page, f'[id="fixture.{place}"]')
            page.keyboard.type(value)
        press(page, "Tab")
        page.wait_for_selector('#left:text("Nothing is asked for")')

        reach(page, "#kind")
        page.keyboard.type("rotation")
        reach(page, "#card-run .take")
        press(page, "Enter")
        page.wait_for_selector('#file:text-is("run.toml")')
        for place in ("camera1.band", "camera2.band", "optics.pixel_pitch"):
            reach(page, f'[data-place="{place}"] .other')
            press(page, "Enter")
            page.wait_for_selector(f'.field:not(.gap)[data-place="{place}"]')
        reach(page, '[id="run.mechanism.radius"]')
        page.keyboard.type("20")
        reach(page, ".task[data-task=process]")
        press(page, "Enter")
        page.wait_for_selector("body[data-work=process], body[data-work=failed]")
        assert "8 triggers" in page.inner_text("#notes")
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
        reach(page, "#film a")

    fixture = FIXTURE_BY_HAND.replace("[0.0, 48.0]", "[0, 48]")
    for name, text in (("run", DISC_BY_HAND), ("fixture", fixture)):
        assert tomllib.loads((disc / name / f"{name}.toml").read_text()) == tomllib.loads(text)
    run = by_hand(tmp_path / "again", disc, DISC_BY_HAND, fixture)
    command("process", run)
    assert_same_film(disc / "run/film.nc", run / "film.nc")


def test_the_origin_may_be_given_before_the_scale(visit, disc):
    """The profile is drawn again when the image has its scale; until then there is no size."""
    with visit(disc) as page:
        take(page, "fixture")
        given = {"fixture.origin": "0, 48", "camera1.band": "580", "camera2.band": "610"}
        type_in(page, "fixture", given)
        page.wait_for_load_state("networkidle")
        type_in(page, "fixture", {"optics.pixel_pitch": "150"})
        assert "calibrated range" in work(page, "calibrate", "fixture")
        page.wait_for_selector("#curve:visible")
        wide = "document.querySelector('#curve').naturalWidth"
        page.wait_for_function(f"{wide} > 100")
        work(page, "check", "fixture")
        page.wait_for_selector("#curve", state="hidden")
        page.wait_for_load_state("networkidle")


HOSTILE = '<img src=x onerror="alert(1)">'


def test_a_hostile_name_a_huge_image_and_a_folder_without_rights_are_named(
    visit, disc, monkeypatch
):
    root = disc.parent
    (root / HOSTILE).mkdir()
    (root / "private").mkdir()
    (disc / "run").rename(root / HOSTILE / "run")
    (root / HOSTILE / "run" / "camera1" / HOSTILE.replace("/", "_")).write_bytes(b"II*\0")
    listed = Path.iterdir

    def refuse(path):  # as for any user but root
        if path.name == "private":
            raise PermissionError(13, "Permission denied")
        return listed(path)

    monkeypatch.setattr(Path, "iterdir", refuse)
    with visit(root) as page:
        page.click("#card-run .choose")
        page.click('#picker-folders >> text="private"')
        page.wait_for_selector("#picker-refusal:text('private may not (Permission denied)')")
        page.click(f"#picker-folders button:text-is({HOSTILE!r})")
        page.click("#picker-folders button:text-is('run')")
        page.wait_for_selector(f"#picker-path:text({HOSTILE + '/run'!r})")
        page.click("#picker-take")
        page.wait_for_selector("#card-run .anew:visible")
        assert page.inner_text("#card-run .folder") == f"{HOSTILE}/run"
        assert page.locator("img:not(#curve)").count() == 0

        # a header that claims 60000 x 60000 pixels
        huge = root / HOSTILE / "run" / "camera1" / "frame_0001.tif"
        content = bytearray(huge.read_bytes())
        with tifffile.TiffFile(huge) as file:
            for name in ("ImageWidth", "ImageLength"):
                tag = file.pages[0].tags[name]
                content[tag.valueoffset : tag.valueoffset + 2] = (60000).to_bytes(2, "little")
        huge.write_bytes(content)
        page.click("#card-run .anew")
        page.wait_for_selector("#changes li:nth-child(2)")
        page.focus("#number")
        page.keyboard.press("ArrowRight")
        page.wait_for_selector("#status.bad:text('frame_0001.tif')")


def test_a_value_is_checked_while_it_is_typed_and_each_change_is_undone(visit, lab):
    before = (lab.run / "run.toml").read_bytes()
    with visit(lab.directory) as page:
        take(page, "run")
        page.click("text='All other settings'")
        field = page.locator('[id="run.optics.pixel_pitch"]')
        row = '#others [data-place="optics.pixel_pitch"]'
        field.fill("75 V")
        page.wait_for_selector(f"{row} .bad:text('75 V')")
        field.press("Tab")  # refused, and not written
        assert (lab.run / "run.toml").read_bytes() == before
        field.fill("151")
        page.wait_for_selector(f"{row} pre .added:text('pixel_pitch = \"151 um\"')")
        assert (lab.run / "run.toml").read_bytes() == before
        field.press("Tab")
        page.wait_for_selector('#changes >> text="run.toml: optics.pixel_pitch"')
        assert b'"151 um"' in (lab.run / "run.toml").read_bytes()

        page.select_option("#orientation", "mirrored_x")
        page.wait_for_selector('#changes >> text="run.toml: registration.orientation"')
        page.check("input[value=brush]")
        drag(page, (20, 20), (60, 30))
        page.click("#apply")
        page.wait_for_selector("#key li:has-text('masked')")
        for left in (2, 1, 0):
            page.click("#undo")
            page.wait_for_selector(
                f"#changes:not(:has(li:nth-child({left + 1})))", state="attached"
            )
        assert (lab.run / "run.toml").read_bytes() == before
        assert not list(lab.run.glob("mask_*"))
        page.wait_for_selector("#undo:disabled")


def test_work_is_cancelled_and_leaves_no_film(visit, lab):
    with visit(lab.directory) as page:
        take(page, "run")
        page.click(".task[data-task=process]")
        page.click("#cancel")
        page.wait_for_selector("body[data-work=failed]")
        assert "Cancelled" in page.inner_text("#notes")
        assert not lab.film.exists()


def test_a_value_that_is_being_typed_stays_while_others_change(visit, lab):
    with visit(lab.directory) as page:
        take(page, "run")
        page.click("text='All other settings'")
        field = page.locator('[id="run.optics.pixel_pitch"]')
        field.fill("151")
        page.evaluate("""() => {
            const choice = document.getElementById("orientation");
            choice.value = "mirrored_x";
            choice.dispatchEvent(new Event("change"));
        }""")
        page.wait_for_selector('#changes >> text="run.toml: registration.orientation"')
        assert field.input_value() == "151"
        field.press("Enter")
        page.wait_for_selector('#changes >> text="run.toml: optics.pixel_pitch"')
        assert field.input_value() == "151 um"


def test_a_closed_way_of_the_brush_is_not_joined_to_the_next_one(visit, lab):
    with visit(lab.directory) as page:
        take(page, "run")
        page.check("input[value=brush]")
        drag(page, (20, 20), (60, 20), (60, 50), (20, 50), (20, 20))
        drag(page, (100, 70), (110, 70))
        page.click("#apply")
        page.wait_for_selector("#key li:has-text('masked')")
    with Image.open(lab.run / "mask_1.png") as mask:
        values = [mask.getpixel(place) for place in ((60, 35), (105, 70), (85, 56))]
    assert values == [255, 255, 0]  # the last one is between both


def test_a_change_that_cannot_be_made_and_a_server_that_has_ended_are_named(visit, lab):
    with visit(lab.directory) as page:
        take(page, "run")
        (lab.run / "run.toml").write_text("no settings")
        page.select_option("#orientation", "mirrored_x")
        page.wait_for_selector("#status.bad:text('Expected valid TOML')")
        # as fetch fails where nobody listens
        page.evaluate("() => { window.fetch = () => Promise.reject(new TypeError('fetch')); }")
        page.click("#card-run .choose")
        page.wait_for_selector("#picker-refusal:text('does not run any more')")


def end_of_work(page):
    while (state := page.describe()["work"])["running"]:
        time.sleep(0.01)
    return state


def test_an_earlier_film_stays_open_where_the_work_fails(lab, film, monkeypatch):
    shutil.copy(film, lab.film)

    def fail(*given, **options):
        raise ErlifError("Cancelled.")

    monkeypatch.setattr("erlif.show.start.page.process", fail)
    with closing(StartPage(lab.directory)) as page:
        send = page.writing()
        send["open"]([], b'{"name": "run", "folder": "run", "kind": "static"}')
        send["start"]([], b'{"task": "process", "name": "run"}')
        state = end_of_work(page)
        assert state["failed"]
        assert state["film"] == "run/film.nc"
    assert page.films == []


def test_a_fixture_is_checked_in_a_folder_that_holds_a_run_too(lab):
    for name in ("fixture.toml", "profile.csv"):
        shutil.copy(lab.fixture / name, lab.run)
    with closing(StartPage(lab.directory)) as page:
        send = page.writing()
        for name, subject in (("run", "encoder log: "), ("fixture", "profile: ")):
            opened = {"name": name, "folder": "run", "kind": "static"}
            send["open"]([], json.dumps(opened).encode())
            send["start"]([], json.dumps({"task": "check", "name": name}).encode())
            notes = [note["text"] for note in end_of_work(page)["notes"]]
            assert any(text.startswith(subject) for text in notes), notes


def test_settings_of_any_form_are_described_with_their_faults(lab):
    with closing(StartPage(lab.directory)) as page:
        page.writing()["open"]([], b'{"name": "run", "folder": "run", "kind": "static"}')
        for text in (
            *("camera1 = 3", "camera1.files = 3", "camera2 = []", "registration = 'x'"),
            *("thickness.roi = 1", "thickness.exclude = [[1]]", "fixture.profile = 3"),
            *("fixture = {direction = 3}", "optics.pixel_pitch = [75]", "joint = [{bore = 1}]"),
            *("fixture.origin = []", "reference.region = 'all'", "mechanism = true"),
        ):
            (lab.run / "run.toml").write_text(text)
            assert page.describe()["files"]["run"]["faults"], text


def test_a_list_with_a_fault_is_not_drawn(lab):
    lab.edit("fixture/fixture.toml", ("origin = [", "origin = ['left', "))
    with closing(StartPage(lab.directory)) as page:
        page.writing()["open"]([], b'{"name": "fixture", "folder": "fixture", "kind": "static"}')
        assert page.describe()["files"]["fixture"]["shapes"]["origin"] is None


def test_a_long_way_of_the_brush_is_one_mask(lab):
    way = [[column % 128, column // 128] for column in range(9_000)]  # more than 64 KiB
    with start_page(lab.directory) as address:
        for name, given in (
            ("open", {"folder": "run", "kind": "static"}),
            ("brush", {"strokes": [way], "width": 3}),
        ):
            urlopen(Request(address + name, json.dumps({"name": "run", **given}).encode())).close()
    with Image.open(lab.run / "mask_1.png") as mask:
        assert (mask.size, mask.getpixel((100, 60))) == ((128, 96), 255)


NONSENSE = [
    *("", "[]", "3", '{"name": "run"}', '{"name": "x", "values": {}}', '{"values": [1]}'),
    *('{"name": "run", "values": {"a.b": [1]}}', '{"name": "run", "folder": "..", "kind": "x"}'),
    '{"name": "run", "strokes": [[[1, "a"]]], "width": 5}',
    '{"name": "run", "strokes": [[[1, 1]]], "width": Infinity}',
    '{"name": "x", "folder": "run", "kind": "static"}',
]


POSTED = ("open", "try", "change", "brush", "start")
ASKED = (
    *("name=fixture&purpose=frames", "name=no&purpose=frames", "name=run&purpose=no"),
    "name=run&purpose=frames&camera=9",
)


def test_what_no_page_sends_is_refused_in_a_sentence(lab, caplog):
    before = (lab.run / "run.toml").read_bytes()
    with start_page(lab.directory) as address:

        def send(name, body=None):
            return urlopen(Request(address + name, body))

        def refused(name, body=None):
            with pytest.raises(HTTPError) as caught, send(name, body):
                pass
            with caught.value as reply:
                return reply.code, json.load(reply)["message"]

        send("open", b'{"name": "run", "folder": "run", "kind": "static"}').close()
        cases = [(name, body.encode()) for name in POSTED for body in NONSENSE]
        cases += [(f"frame?number=0&camera=1&window=0,0,9,9&room=9,9&{one}", None) for one in ASKED]
        for name, body in cases:
            code, message = refused(name, body)
            assert (code, message[:8]) == (400, "Expected"), (name, body, message)
    assert (lab.run / "run.toml").read_bytes() == before
    assert "open has ended with an error" in caplog.messages  # with its details, for defects
