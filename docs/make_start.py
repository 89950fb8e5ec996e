"""Draw the pictures of docs/start.md from the sample: ``python docs/make_start.py``.

Needs playwright and Chromium.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

ROOT = Path(__file__).parents[1]
IMAGES = Path(__file__).with_name("images")
sys.path.insert(0, str(ROOT / "tests"))

from scenes.browser import chromium  # noqa: E402
from scenes.start import OF_THE_SAMPLE, at, drag, take, type_in  # noqa: E402

from erlif.show.start import start_page  # noqa: E402

COLOURS = 64
"""Of a picture: grey images and a few colours."""


def draw(page, name, first, height):
    """Save the page from an element on, of this height, with few colours."""
    page.evaluate("first => document.querySelector(first).scrollIntoView()", first)
    page.wait_for_timeout(800)
    path = IMAGES / f"start_{name}.png"
    page.screenshot(path=path, clip={"x": 0, "y": 0, "width": 1100, "height": height})
    with Image.open(path) as picture:
        few = picture.convert("RGB").quantize(COLOURS, method=Image.Quantize.MAXCOVERAGE)
        few.save(path, optimize=True)


def make(page):
    """Go from the frames to the film, and draw pictures on the way."""
    take(page, "fixture")
    page.check("input[value=scale]")
    drag(page, (50, 20), (200, 20))
    page.fill("#distance", "11.25")
    draw(page, "scale", "[aria-label=Images]", 680)
    page.click("#apply")
    page.wait_for_selector('#changes >> text="fixture.toml: optics.pixel_pitch"')
    page.check("input[value=origin]")
    page.mouse.click(*at(page, 0, 104))
    page.wait_for_selector('#changes >> text="fixture.toml: fixture.origin"')
    draw(page, "origin", "#tools", 560)
    type_in(page, "fixture", {"camera1.band": "580", "camera2.band": "610"})

    take(page, "run")
    page.click('[data-place="optics.pixel_pitch"] >> text="75 um, as in fixture.toml"')
    values = dict(OF_THE_SAMPLE)
    last = values.popitem()
    page.wait_for_selector('.field:not(.gap)[data-place="optics.pixel_pitch"]')
    few = {place: values[place] for place in ("camera1.band", "camera2.band", "mechanism.crank")}
    type_in(page, "run", few)
    page.fill('[id="run.mechanism.coupler"]', "44 V")
    draw(page, "settings", '[data-place="optics.pixel_pitch"]', 540)
    type_in(page, "run", values | dict([last]))
    page.click(".task[data-task=process]")
    page.wait_for_selector("body[data-work=process]")
    page.set_viewport_size({"width": 1100, "height": 490})  # the end of the page
    draw(page, "film", "[aria-label='To the film']", 450)


if __name__ == "__main__":
    with TemporaryDirectory() as folder:
        lab = Path(folder) / "lab"
        shutil.copytree(ROOT / "data_samples/straight_bushing", lab / "run")
        shutil.copytree(ROOT / "calibration/wedge", lab / "fixture")
        for file in lab.glob("*/*.toml"):
            file.unlink()
        with start_page(lab) as address, chromium() as browser:
            shown = browser.new_page(viewport={"width": 1100, "height": 900})
            shown.set_default_timeout(120_000)
            shown.goto(address)
            shown.wait_for_selector("body[data-ready]")
            make(shown)
