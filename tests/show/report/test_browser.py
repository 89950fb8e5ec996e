"""The report in Chromium: opening trigger, maps, saved table, and the width of a telephone."""

import csv
import io
import shutil
from pathlib import Path

import numpy.testing as npt
import pytest

BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(BROWSER is None, reason="this machine has no Chromium"),
]

FLAGS = (
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
)


def test_report_in_a_browser(text, film, tmp_path):
    address = tmp_path / "report.html"
    address.write_text(text, encoding="utf-8")
    faults = []
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=BROWSER, args=list(FLAGS))
        page = browser.new_context(
            viewport={"width": 390, "height": 844}, color_scheme="dark"
        ).new_page()
        page.set_default_timeout(20_000)
        page.on("pageerror", lambda error: faults.append(f"error: {error}"))
        page.on(
            "request",
            lambda request: (
                None
                if request.url.startswith(("file:", "data:"))
                else faults.append(f"elsewhere: {request.url}")
            ),
        )
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
        browser.close()
    assert not faults
