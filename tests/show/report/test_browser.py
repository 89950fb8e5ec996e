"""The report in Chromium: opening trigger, maps, saved table, and the width of a telephone."""

import csv
import io
import re
from pathlib import Path

import numpy.testing as npt
from scenes import browser

pytestmark = browser.MARKS


def test_report_in_a_browser(text, film, tmp_path):
    address = tmp_path / "report.html"
    in_two_lines = text.replace("minimum n = ", "rank +0.99\nminimum n = ", 1)
    address.write_text(in_two_lines, encoding="utf-8")
    telephone = {"width": 390, "height": 844}
    with (
        browser.chromium() as chromium,
        browser.pages(chromium, own=("file:", "data:")) as new_page,
    ):
        page = new_page(viewport=telephone, color_scheme="dark")
        page.goto(address.as_uri())
        frame = page.query_selector("#film-viewer").content_frame()
        frame.wait_for_selector("body[data-ready]")

        # the trigger of the figures
        opened = int(frame.input_value("#trigger-number"))
        canvas = frame.query_selector("#panel-a canvas")
        assert canvas.get_attribute("data-text").startswith(f"trigger {opened}, ")
        assert f"Trigger {opened}, " in page.inner_text("#figures")

        # two lines of a text stay two
        assert "rank +0.99\nminimum n = " in page.inner_text("dl.brief")

        # the page is not wider than the window, and all controls lie in it
        for place in (page, frame):
            assert place.evaluate("document.documentElement.scrollWidth") <= 390
            ground = place.evaluate("getComputedStyle(document.body).backgroundColor")
            assert ground == "rgb(22, 24, 27)"
        frame.click("#more > summary")
        for control in ("previous", "next", "trigger", "layer", "panel-a", "profile", "cycle"):
            box = frame.query_selector(f"#{control}").bounding_box()
            assert box["x"] >= 0
            assert box["x"] + box["width"] <= 390
        for served in ("two", "write", "tiff", "region-form"):
            assert not frame.query_selector(f"#{served}").is_visible()

        # the frame has the height of its page
        heights = "[document.documentElement.scrollHeight, innerHeight]"
        page.wait_for_timeout(200)
        needed, given = frame.evaluate(heights)
        assert needed == given

        # every map is drawn, and one pixel is that of the film
        layers = ("thickness_std", "thickness_std_shared", "predicted", "residual", "thickness")
        for layer in layers:
            frame.select_option("#layer", layer)
            canvas = frame.wait_for_selector(f'#panel-a canvas[data-layer="{layer}"]')
        # the scale of a difference is even, also that of one map
        frame.select_option("#layer", "residual")
        frame.click("#fit")
        low, high = (float(frame.input_value(f"#{name}")) for name in ("low", "high"))
        assert low == -high < 0
        frame.select_option("#layer", "thickness")
        canvas = frame.wait_for_selector('#panel-a canvas[data-layer="thickness"]')

        box = canvas.bounding_box()
        canvas.click(position={"x": 0.5 * box["width"], "y": 0.5 * box["height"]})
        frame.wait_for_selector("#readout:has-text('predicted')")
        words = re.match(
            r".*\(column (\d+), row (\d+)\): (\S+) µm ± (\S+) µm random ± (\S+) µm shared; "
            r"predicted (\S+) µm, difference (\S+) µm$",
            frame.inner_text("#readout"),
        )
        column, row, value, std, shared, predicted, difference = map(float, words.groups())
        one = film.isel(trigger=opened, x=int(column), y=int(row))
        npt.assert_allclose(value, one.thickness, atol=1e-3)
        npt.assert_allclose([std, shared], [one.thickness_std, one.thickness_std_shared], rtol=0.06)
        npt.assert_allclose(value - predicted, difference, atol=2e-3, rtol=0.06)

        # the click has drawn the row
        frame.click("#side details:first-of-type > summary")
        ends = [float(frame.input_value(f"#line-form [name={end}]")) for end in ("y0", "y1")]
        assert ends[0] == ends[1]
        npt.assert_allclose(ends[0], one.y, atol=0.51 * float(film.y[1] - film.y[0]))
        shown = frame.locator("#profile .u-legend tr:not([hidden]) th").all_text_contents()
        assert shown == ["mm", "value", "predicted"]

        # numbers of the page are saved as CSV, maps are not
        assert frame.is_disabled("#csv")
        frame.select_option("#what", "cycle")
        with page.expect_download() as download:
            frame.click("#csv")
        saved = Path(download.value.path()).read_text(encoding="utf-8")
        found = [float(row["film_min [um]"]) for row in csv.DictReader(io.StringIO(saved))]
        npt.assert_allclose(found, film.film_min.values, rtol=1e-5)

        # another trigger by its number
        frame.fill("#trigger-number", "0")
        frame.press("#trigger-number", "Enter")
        frame.wait_for_selector('#panel-a canvas[data-text^="trigger 0, "]')

        with page.expect_download() as download:
            page.click("a[download]")
        assert download.value.suggested_filename == "a_film_known_small_triggers.csv"
        saved = Path(download.value.path()).read_text(encoding="utf-8")
        rows = list(csv.DictReader(io.StringIO(saved)))
        found = [float(row["film_min [um]"]) for row in rows]
        npt.assert_allclose(found, film.film_min.values, rtol=5e-9)
