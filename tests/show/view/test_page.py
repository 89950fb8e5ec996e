"""The page in Chromium: each function of the viewer on a run of 5000 triggers."""

import csv
import io
import time
from pathlib import Path

import numpy as np
import numpy.testing as npt
import pytest
import tifffile
from scenes import browser
from scenes.long_film import phase_map, phases, write_long_film

from erlif.core.flags import FLAG_COLOURS, Flag
from erlif.io.files import write_dataset
from erlif.show.plots import example_film, write_example
from erlif.show.view.layers import palette

pytestmark = browser.MARKS

TRIGGERS, SHAPE, NAME = 5000, (256, 320), "<script>alert(1)</script>"
X, Y = 0.05 * np.arange(SHAPE[1]), 0.05 * np.arange(SHAPE[0])
FIRST = 1250  # the fastest trigger outward, where the page opens


def stored(trigger):
    """Film thickness of a trigger as the formulas give it, NaN where flagged."""
    return phase_map(int(phases(TRIGGERS)[trigger]), SHAPE)["thickness"].astype(float)


@pytest.fixture(scope="module")
def long_film(tmp_path_factory):
    return write_long_film(
        tmp_path_factory.mktemp("long") / "film.zarr", triggers=TRIGGERS, shape=SHAPE, name=NAME
    )


@pytest.fixture(scope="module")
def run_toml(long_film):
    """Settings beside the film, with a comment."""
    path = long_film.parent / "run.toml"
    path.write_text("# by hand\n[thickness]\nroi = { x = [2, 14], y = [1, 5] } # mm\n")
    return path


@pytest.fixture(scope="module")
def address(serve, long_film, run_toml):
    return serve(long_film).address


@pytest.fixture(scope="module")
def chromium():
    with browser.chromium() as started:
        yield started


@pytest.fixture
def visit(chromium):
    """Open a page; the test fails on errors, failed requests and requests to other machines."""
    with browser.pages(chromium, own=("http://127.0.0.1:", "data:")) as new_page:

        def start(address, *, width=1400, height=900, **options):
            page = new_page(viewport={"width": width, "height": height}, **options)
            page.goto(address)
            page.wait_for_selector("body[data-ready]")
            return page

        yield start


@pytest.fixture
def page(visit, address):
    return visit(address)


def until(page, found, expected):
    """Wait until a value is the expected one."""
    end = time.monotonic() + 60
    while (value := found()) != expected and time.monotonic() < end:
        page.wait_for_timeout(20)
    assert value == expected


def shows(page, trigger, panel="a"):
    page.wait_for_selector(f'#panel-{panel} canvas[data-text^="trigger {trigger},"]')


def at(page, x, y, panel="a"):
    """Place of a point in mm on the page."""
    return page.evaluate(
        """([panel, x, y]) => {
          const box = document.querySelector(`#panel-${panel} canvas`).getBoundingClientRect();
          const [left, right, top, bottom] = [50, 82, 8, 38];
          return [box.left + left + (x / 16) * (box.width - left - right),
                  box.top + top + (y / 12.8) * (box.height - top - bottom)];
        }""",
        [panel, x + 0.025, y + 0.025],  # positions are those of the centres of pixels
    )


def colour(page, x, y, panel="a"):
    """Colour of the map at a point in mm, six hexadecimal digits."""
    return page.evaluate(
        """([panel, left, top]) => {
          const canvas = document.querySelector(`#panel-${panel} canvas`);
          const box = canvas.getBoundingClientRect();
          const scale = canvas.width / box.width;
          const pen = canvas.getContext("2d");
          const pixel = pen.getImageData((left - box.left) * scale, (top - box.top) * scale, 1, 1);
          return [...pixel.data.slice(0, 3)].map((v) => v.toString(16).padStart(2, "0")).join("");
        }""",
        [panel, *at(page, x, y, panel)],
    )


def drag(page, start, end):
    page.mouse.move(*at(page, *start))
    page.mouse.down()
    page.mouse.move(*at(page, *(np.add(start, end) / 2).tolist()))
    page.mouse.move(*at(page, *end))
    page.mouse.up()


def download(page, what, kind):
    """Name and bytes of an exported file."""
    page.select_option("#what", what)
    with page.expect_download() as found:
        page.click(f"#{kind}")
    return found.value.suggested_filename, Path(found.value.path()).read_bytes()


def enter(page, field, value):
    page.fill(field, f"{value}")
    page.press(field, "Enter")


def rows(content):
    return list(csv.DictReader(io.StringIO(content.decode())))


def test_a_long_run_opens_at_its_fastest_trigger_and_its_name_stays_text(page):
    shows(page, FIRST)
    assert page.inner_text("#run") == page.title() == NAME
    assert page.locator("script:not([src])").count() == 0
    assert colour(page, 3.3, 2.4) == FLAG_COLOURS[Flag.NO_FILM][1:].lower()
    assert colour(page, 15, 12.5) == FLAG_COLOURS[Flag.SATURATED][1:].lower()

    # the colour is that of the palette at the share of the value in the limits
    low, high = (float(page.input_value(f"#{name}")) for name in ("low", "high"))
    colours = palette("batlow")
    for x in (4.0, 12.0):
        value = stored(FIRST)[160, round(x / 0.05)]
        step = int(256 * (value - low) / (high - low))
        near = {colours[6 * n : 6 * n + 6] for n in range(step - 1, step + 2)}
        assert colour(page, x, 8.0) in near
    page.mouse.move(*at(page, 4.0, 8.0))
    until(page, lambda: "random" in page.inner_text("#readout"), True)
    place, text = page.inner_text("#readout").split(": ")
    assert place.endswith("(column 80, row 160)")
    # a tenth of its std, and four digits
    assert abs(float(text.split()[0]) - stored(FIRST)[160, 80]) < 0.01


def test_keys_choose_the_trigger_play_and_zoom(page):
    for key, trigger in (
        *(("ArrowRight", 1251), ("Shift+ArrowRight", 1261), ("ArrowLeft", 1260)),
        *(("End", 4999), ("ArrowRight", 4999), ("Home", 0)),
    ):
        page.keyboard.press(key)
        shows(page, trigger)
    assert page.input_value("#trigger") == page.input_value("#trigger-number") == "0"

    page.keyboard.press("Space")
    until(page, lambda: int(page.input_value("#trigger")) >= 40, True)
    page.keyboard.press("Space")
    until(page, lambda: page.get_attribute("#play", "aria-pressed"), "false")
    trigger = int(page.input_value("#trigger"))
    assert trigger % 20 == 0  # every 20th is played
    shows(page, trigger)

    page.keyboard.press("+")
    until(page, lambda: colour(page, 8, 0.1) == colour(page, 8, 12), True)  # no corner in view
    page.keyboard.press("0")

    # keys within a field belong to the field, and a number that no trigger has is reported
    enter(page, "#trigger-number", 7)
    shows(page, 7)
    page.press("#trigger-number", "Home")
    assert page.input_value("#trigger") == "7"
    enter(page, "#trigger-number", 99999)
    until(page, lambda: "from 0 to 4999; got 99999" in page.inner_text("#status"), True)
    assert page.input_value("#trigger-number") == "4999"

    # arrows move the region by a pixel, and with Shift its end
    def ends():
        return [float(page.input_value(f"#region-form [name={name}]")) for name in ("x0", "x1")]

    page.check("input[name=tool][value=region]")
    page.focus("#panel-a canvas")
    before = ends()
    page.keyboard.press("ArrowRight")
    npt.assert_allclose(ends(), np.add(before, 0.05), atol=1e-3)
    page.keyboard.press("Shift+ArrowLeft")
    npt.assert_allclose(ends(), np.add(before, [0.05, 0.0]), atol=1e-3)
    assert page.input_value("#trigger") == "4999"


def test_a_map_that_fails_does_not_keep_back_the_one_chosen_after_it(page):
    held = []
    page.route("**/map?*trigger=7&*", lambda route: held.append(route))
    enter(page, "#trigger-number", 7)
    until(page, lambda: len(held), 1)
    enter(page, "#trigger-number", 99999)
    held[0].fulfill(status=500, body="no memory")
    shows(page, 4999)
    until(page, lambda: "from 0 to 4999; got 99999" in page.inner_text("#status"), True)


def test_a_drawn_line_gives_the_profile_in_its_direction(page):
    # a slow answer: the export waits for the profile of the line as it is drawn
    page.route("**/profile?*", lambda route: (page.wait_for_timeout(300), route.continue_()))
    page.check("input[value=line]")
    drag(page, (4.0, 6.0), (12.0, 12.0))
    page.locator("#side details").first.locator("summary").click()
    ends = [float(page.input_value(f"#line-form [name={name}]")) for name in ("x0", "y0", "x1")]
    npt.assert_allclose(ends, [4, 6, 12], atol=0.05)

    name, content = download(page, "profile", "csv")
    assert name.endswith("_profile.csv")
    names = ("position [mm]", "value [um]")
    found = np.array([[float(one[name]) for name in names] for one in rows(content)])
    share = found[:, 0] / found[-1, 0]
    npt.assert_allclose(found[-1, 0], 10.0, atol=0.1)  # 8 mm along x, 6 mm along y
    truth = 2.0 + 7 + 8.0 * np.linspace(-1, 1, SHAPE[1]) ** 2  # the parabola below the noise
    expected = np.interp(4.0 + 8.0 * share, X, truth)
    assert abs(found[:, 1] - expected).mean() < 0.06
    assert abs(found[:, 1] - expected).max() < 0.35

    # the pointer on the profile marks its place on the map
    page.mouse.move(1, 1)
    picture = "document.querySelector('#panel-a canvas').toDataURL()"
    before = page.evaluate(picture)
    page.locator("#profile .u-over").hover(position={"x": 100, "y": 20})
    until(page, lambda: page.evaluate(picture) == before, False)


def test_a_drawn_region_has_statistics_and_is_written_on_request(page, run_toml):
    before = run_toml.read_text()
    page.check("input[value=region]")
    drag(page, (9.02, 9.02), (5.02, 6.02))  # from the lower right to the upper left
    until(page, lambda: page.locator("#statistics td").nth(1).inner_text() != "19521", True)
    page.locator("#side details").nth(1).locator("summary").click()
    names = ("x0", "x1", "y0", "y1")
    x0, x1, y0, y1 = (float(page.input_value(f"#region-form [name={n}]")) for n in names)
    npt.assert_allclose([x0, x1, y0, y1], [5, 9, 6, 9], atol=0.06)

    part = np.ix_((y0 <= Y) & (y1 >= Y), (x0 <= X) & (x1 >= X))
    inside = stored(FIRST)[part]
    until(page, lambda: page.locator("#statistics td").nth(1).inner_text(), str(inside.size))
    cells = page.locator("#statistics td").all_inner_texts()
    assert cells[2] == str(np.isfinite(inside).sum())
    npt.assert_allclose(float(cells[3]), np.nanmean(inside), rtol=6e-4)
    expected = [np.nanmin(inside), np.nanmax(inside), np.nanstd(inside)]
    npt.assert_allclose([float(cell) for cell in cells[6:]], expected, rtol=6e-4)

    page.click("#write")
    page.wait_for_selector("#confirm[open]")
    assert "+roi" in page.inner_text("#confirm-change")
    page.click("#confirm-no")
    assert run_toml.read_text() == before
    page.click("#write")
    page.click("#confirm-yes")
    until(page, lambda: "run.toml" in page.inner_text("#status"), True)
    numbers = [f"{value:.3f}".rstrip("0") for value in (x0, x1, y0, y1)]
    written = run_toml.read_text()
    assert written.startswith("# by hand\n[thickness]\nroi = { x = [")
    assert written.endswith(" } # mm\n")
    assert all(number.rstrip(".") in written for number in numbers)


def test_a_click_on_the_cycle_selects_the_trigger(page):
    speed = 4 * np.sin(2 * np.pi * np.arange(TRIGGERS) / TRIGGERS)
    for axis, share in (("crank_angle", 0.25), ("rocker_speed", 0.8), ("joint_load", 0.5)):
        page.select_option("#axis", axis)
        page.locator("#cycle .u-over").scroll_into_view_if_needed()
        box = page.locator("#cycle .u-over").bounding_box()
        page.mouse.click(
            box["x"] + (share + 0.02) / 1.04 * box["width"], box["y"] + 0.2 * box["height"]
        )
        page.wait_for_timeout(50)
        chosen = int(page.input_value("#trigger"))
        shows(page, chosen)
        if axis == "crank_angle":
            assert abs(chosen - 1250) < 50
        elif axis == "rocker_speed":
            assert abs(speed[chosen] - (-4 + 8 * 0.8)) < 0.4
        else:
            load = 220 + 20 * np.cos(4 * np.pi * chosen / TRIGGERS)
            assert abs(load - 220) < 2
    titles = page.locator("#cycle .u-legend").inner_text()
    assert "theory, minimum" in titles
    assert "mean, outward" in titles


def test_triggers_have_their_bars_and_lie_within_the_chart(visit, serve, tmp_path):
    """Bars of 0.5 um add pixels of the colour of the minima above and below their markers."""
    count = """() => {
      const canvas = document.querySelector("#cycle canvas");
      const box = document.querySelector("#cycle .u-over").getBoundingClientRect();
      const whole = canvas.getBoundingClientRect();
      const scale = canvas.width / whole.width;
      const from = (box.left - whole.left) * scale;
      const pen = canvas.getContext("2d");
      const columns = new Map();
      const { data } = pen.getImageData(0, 0, canvas.width, canvas.height);
      for (let n = 0; n < data.length; n += 4) {
        if (data[n] > 180 && data[n + 1] < 120 && data[n + 2] < 60) {
          const column = (n / 4) % canvas.width;
          columns.set(column, (columns.get(column) ?? 0) + 1);
        }
      }
      const places = [...columns.keys()];
      return [Math.max(...columns.values()), Math.min(...places) - from,
        from + box.width * scale - Math.max(...places)];
    }"""
    tall = {}
    for std in (0.001, 0.5):
        path = tmp_path / f"{std}.nc"
        film = example_film()
        write_dataset(film.assign(film_min_std=0 * film.film_min + std), path)
        page = visit(serve(path).address)
        tall[std], left, right = page.evaluate(count)
        assert min(left, right) > 0  # whole markers at both ends
    assert tall[0.5] > 3 * tall[0.001]


def test_the_minimum_stands_beside_the_thinnest_pixel(page):
    until(page, lambda: "film_min" in page.inner_text("#minimum"), True)
    titles = page.locator("#statistics th").all_text_contents()
    assert titles[6:8] == ["thinnest pixel", "thickest pixel"]
    page.select_option("#layer", "thickness_std")
    until(page, lambda: page.inner_text("#minimum"), "")


def test_two_triggers_stand_side_by_side_with_their_difference(page):
    page.check("#two")
    enter(page, "#trigger-b", 300)
    shows(page, 300, "b")
    page.wait_for_selector('#panel-d canvas[data-text^="trigger 300,"]')
    name, content = download(page, "d", "tiff")
    assert name.endswith("_difference_1250.tiff")
    found = tifffile.imread(io.BytesIO(content))
    npt.assert_allclose(found, stored(300) - stored(FIRST), atol=0.03)  # stored to a tenth of std
    row = page.locator("#statistics tr").nth(3).locator("td")
    until(page, lambda: row.count(), 9)
    region = np.ix_((Y >= 1) & (Y <= 5.0001), (X >= 2) & (X <= 14.0001))
    difference = np.nanmean((stored(300) - stored(FIRST))[region])
    npt.assert_allclose(float(row.nth(3).inner_text()), difference, rtol=2e-3)

    page.select_option("#unit", "significance")
    page.wait_for_selector('#panel-d canvas[data-layer="significance"]')
    page.check("#linked")
    page.keyboard.press("End")
    shows(page, 4999, "b")


def test_two_films_stand_side_by_side_where_their_pixels_match(
    visit, serve, long_film, example_path
):
    page = visit(serve(long_film, long_film, example_path).address)
    page.check("#two")
    assert page.input_value("#film-b") == "1"
    assert page.is_checked("#linked")
    page.keyboard.press("ArrowRight")
    shows(page, FIRST + 1, "b")
    page.wait_for_selector(f'#panel-d canvas[data-text*="− trigger {FIRST + 1},"]')
    assert "mean, outward, second film" in page.inner_text("#cycle .u-legend")

    page.select_option("#film-b", "2")
    until(page, lambda: "example has another size" in page.inner_text("#status"), True)
    assert page.input_value("#film-b") == "0"
    page.select_option("#film-a", "2")
    shows(page, 5)  # the last of the example
    assert page.inner_text("#run") == "example"


def test_unlike_films_are_paired_by_angle_and_stroke_on_one_scale(visit, serve, tmp_path):
    """The second film begins with the other stroke, lacks a trigger and is 5 um thicker."""
    one = example_film()
    two = one.isel(trigger=[3, 4, 5, 0, 1]).assign_coords(trigger=np.arange(5))
    two["thickness"] = two.thickness + np.float32(5)
    paths = [write_example(tmp_path / "one.nc"), tmp_path / "two.nc"]
    write_dataset(two.assign_attrs(one.attrs), paths[1])
    page = visit(serve(*paths).address)
    high = float(page.input_value("#high"))
    page.check("#two")
    assert page.inner_text("#paired") == "at the angle of the first"
    until(page, lambda: float(page.input_value("#high")) > high + 4, True)
    # crank angles 250, 290, 330, 70, 110, 150; the one of 330 has its neighbour at 290 degree
    for trigger, partner in ((0, 3), (1, 4), (2, 4), (3, 0), (5, 2)):
        enter(page, "#trigger-number", trigger)
        shows(page, partner, "b")


def test_colours_layers_and_flags(page):
    enter(page, "#high", 9.5)
    enter(page, "#low", 9.4)
    colours = palette("batlow")
    until(page, lambda: colour(page, 1.0, 8.0), colours[-6:])
    enter(page, "#low", 12)
    assert "low before high" in page.inner_text("#status")
    page.click("#fit")
    until(page, lambda: float(page.input_value("#high")) > 16, True)
    known = stored(FIRST)[np.isfinite(stored(FIRST))]
    ends = [float(page.input_value(f"#{name}")) for name in ("low", "high")]
    npt.assert_allclose(ends, np.percentile(known, [0.5, 99.5]), atol=0.05)
    for layer in ("thickness_std", "thickness_std_shared", "flags"):
        page.select_option("#layer", layer)
        page.wait_for_selector(f'#panel-a canvas[data-layer="{layer}"]')
    assert colour(page, 3.3, 2.4) == FLAG_COLOURS[Flag.NO_FILM][1:].lower()
    assert colour(page, 8.0, 8.0) == "f4f4f4"
    assert "no film 1.05 %" in page.inner_text("#key")


def test_what_is_seen_is_exported(page):
    for what in ("a", "profile", "cycle"):
        name, content = download(page, what, "png")
        assert name.endswith(".png")
        assert "script_alert" in name  # the run
        assert content.startswith(b"\x89PNG")
    name, content = download(page, "a", "csv")
    assert name == f"_script_alert_1_script__thickness_{FIRST}.csv"
    values = np.genfromtxt(io.BytesIO(content), delimiter=",", skip_header=1, usecols=2)
    npt.assert_allclose(values.reshape(SHAPE), stored(FIRST), atol=0.01)
    _, content = download(page, "cycle", "csv")
    assert len(rows(content)) == TRIGGERS
    _, content = download(page, "region", "csv")
    assert rows(content)[0]["layer"] == "thickness"
    page.select_option("#what", "profile")
    assert page.is_disabled("#tiff")


def test_a_phone_in_the_dark(visit, address):
    page = visit(address, width=390, height=844, color_scheme="dark", has_touch=True)
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert max(int(part) for part in ground[4:-1].split(",")) < 60
    top = page.locator("#panel-a canvas").bounding_box()
    assert top["y"] + top["height"] < 844  # the map is on the first screen
    small = page.evaluate(
        """() => [...document.querySelectorAll("button, select, input[type=number]")]
        .filter((e) => e.offsetParent && e.getBoundingClientRect().height < 36).length"""
    )
    assert small == 0
    page.tap("#next")
    shows(page, FIRST + 1)
    page.locator("#more > summary").tap()
    page.locator("input[value=region]").tap()
    drag(page, (5.0, 6.0), (9.0, 9.0))
    until(page, lambda: page.locator("#statistics td").nth(1).inner_text() != "19521", True)
    cut = "[...document.querySelectorAll('#statistics td')].map((cell) => [cell.scrollWidth, "
    cut += "cell.clientWidth, cell.getBoundingClientRect().right])"
    for content, room, right in page.evaluate(cut):
        assert content <= room + 1
        assert right <= 390
