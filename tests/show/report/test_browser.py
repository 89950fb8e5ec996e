"""The report in Chromium: opening trigger, maps, saved table, and the width of a telephone."""

import csv
import io
from pathlib import Path

import numpy.testing as npt
from scenes import browser

pytestmark = browser.MARKS


def test_report_in_a_browser(text, film, tmp_path):
    address = tmp_path / "report.html"
    address.write_text(text, encoding="utf-8")
    telephone = {"width": 390, "height": 844}
    with (
        browser.chromium() as chromium,
        browser.pages(chromium, own=("file:", "data:")) as new_page,
    ):
        page = new_page(viewport=telephone, color_scheme="dark")
        page.goto(address.as_uri())
        canvas = page.wait_for_selector("#map[data-shown]")

        # the trigger of the figures, and its row in the table
        opened = int(canvas.get_attribute("data-shown"))
        assert page.input_value("#trigger") == str(opened)
        assert page.text_content("#trigger-title").startswith(f"Trigger {opened}, ")

        # the page is not wider than the window, and all controls lie in it
        assert page.evaluate("document.documentElement.scrollWidth") == 390
        for control in ("#previous", "#next", "#trigger", "#layer", "#map", "#profile"):
            box = page.query_selector(control).bounding_box()
            assert box["x"] >= 0
            assert box["x"] + box["width"] <= 390
        assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(22, 24, 27)"

        # every map is drawn, and the axis of its profile holds the values of the row
        values = film.thickness.values[opened, film.sizes["y"] // 2]
        values = values[values == values]
        for layer in ("std", "std_shared", "predicted", "difference", "thickness"):
            page.select_option("#layer", layer)
        low, high = (
            float(page.get_attribute("#profile", f"data-{end}")) for end in ("low", "high")
        )
        assert low < values.min() < values.max() < high

        with page.expect_download() as download:
            page.click("a[download]")
        assert download.value.suggested_filename == "a_film_known_small_triggers.csv"
        saved = Path(download.value.path()).read_text(encoding="utf-8")
        rows = list(csv.DictReader(io.StringIO(saved)))
        found = [float(row["film_min [um]"]) for row in rows]
        npt.assert_allclose(found, film.film_min.values, rtol=5e-9)
