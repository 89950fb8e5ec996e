"""The page of a run that is watched, as its requests and as a browser shows it."""

import json
import threading
import time
import urllib.error
import urllib.request

import numpy as np
import pytest

from erlif.core.flags import Flag
from erlif.show.view.live import live_page, readings_of
from erlif.show.view.queries import Request
from tests.scenes.browser import MARKS, chromium, pages


class Source:
    """Three pairs; the newest map is a ramp of 1 to 3 um with a saturated corner."""

    def __init__(self):
        self.version, self.ended, self.alarms = 3, False, {}
        self.thickness = np.linspace(1, 3, 64 * 96, dtype=np.float32).reshape(64, 96)
        self.flags = np.zeros((64, 96), np.uint16)
        self.flags[:8, :8] = Flag.SATURATED
        self.thickness[:8, :8] = np.nan
        self.rows = [
            {
                "place": n,
                "file": f"frame_{n:04d}.tif",
                "time": time.time() - 1 + 0.1 * n,
                "film_min": 2.0 + n,
                "film_min_std": 0.1,
                "film_mean": 3.0 + n if n else None,
                "film_mean_std": 0.1,
                "valid": 0.99,
                "light": [1000.0, 900.0],
                "saturated": [0.0, 0.01],
                "drift": [None, 0.25],
            }
            for n in range(3)
        ]

    def describe(self):
        return {"name": "run 7", "pitch": 0.06}

    def news(self, version, pairs, angles, timeout):
        end = time.monotonic() + timeout
        while self.version <= version and time.monotonic() < end and not self.ended:
            time.sleep(0.01)
        return {
            "version": self.version,
            "status": "film.nc is written" if self.ended else "",
            "closed": self.ended,
            "failed": False,
            "logged": {"joint_load": 222.4, "temperature": 25.04},
            "frames": [3, 3],
            "arrived": 3,
            "measured": 3,
            "after": pairs,
            "pairs": self.rows[pairs:],
            "newest": self.rows[-1],
            "angles": [10.0, 20.0, 30.0][angles:],
            "faults": ["camera 2 lacks frame 1"],
            "alarms": self.alarms,
        }

    def wait_for_map(self, after, timeout):
        end = time.monotonic() + timeout
        while after >= 2 and time.monotonic() < end and not self.ended:
            time.sleep(0.01)

    def newest(self, layer):
        return 2, "pair 2", self.thickness, self.flags


class Trial(Source):
    """The same before the run: the counts of two cameras, of which the second has no darks."""

    def news(self, version, pairs, angles, timeout):
        one = {
            "histogram": [10] * 64,
            "full_scale": 4095,
            "mean": 1000.0,
            "dark": 64.2,
            "highest": 0.5,
            "saturated": 0.0,
            "sharpness": 0.3,
            "measurable": 0.99,
        }
        shift = {"shift": [4.0, -3.0], "quality": 0.98, "overlap": 0.97, "poor": 0.0}
        return super().news(version, pairs, angles, timeout) | {
            "shape": [64, 96],
            "cameras": [one, one | {"dark": None, "sharpness": None, "measurable": None}],
            "best": [0.3, None],
            "map": shift,
            "advice": ["camera 2 saturates"],
        }


class Film(Source):
    """A map ten times as large, and sixteen pairs a second until the fortieth."""

    def __init__(self):
        super().__init__()
        self.thickness = np.kron(self.thickness, np.ones((10, 10), np.float32))
        self.flags = np.kron(self.flags, np.ones((10, 10), np.uint16))
        self.begun = time.monotonic()

    def wait_for_map(self, after, timeout):
        end = time.monotonic() + timeout
        while self.place() <= after and time.monotonic() < end:
            time.sleep(0.005)

    def place(self):
        return min(int(16 * (time.monotonic() - self.begun)), 40)

    def newest(self, layer):
        return (place := self.place()), f"pair {place}", self.thickness, self.flags


SIZES = [{"width": 1280, "height": 900}, {"width": 390, "height": 800}]


def test_news_and_map_are_what_the_source_has():
    reading = readings_of(Source())
    assert reading["run"](Request([], {}))["name"] == "run 7"
    news = reading["news"](Request([], {"version": "-1", "pairs": "2", "angles": "1"}))
    assert [row["place"] for row in news["pairs"]] == [2]
    assert news["angles"] == [20.0, 30.0]
    packed = reading["map"](
        Request([], {"layer": "thickness", "window": "0,0,96,64", "room": "96,64", "after": "1"})
    )
    length = int.from_bytes(packed[:4], "little")
    about = json.loads(packed[4 : 4 + length])
    assert about["shape"] == [64, 96]
    assert about["place"] == 2
    values = np.frombuffer(packed[4 + length : 4 + length + 4 * 64 * 96], "<f4")
    assert np.nanmax(values) == pytest.approx(3)
    assert np.isnan(values[0])


def test_the_page_is_served_with_its_token_alone():
    with live_page(Source()) as address:
        with urllib.request.urlopen(address, timeout=10) as response:
            assert b"<title>erlif watch</title>" in response.read()
        wrong = "/".join([*address.split("/")[:3], "guess", ""])
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(wrong, timeout=10)
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(address, timeout=2)


def test_the_page_is_served_until_an_open_one_has_the_end():
    source, got = Source(), []

    def ask(address):
        while not (got and got[-1]["closed"]):
            query = f"news?version={got[-1]['version'] if got else -1}&pairs=3&angles=3"
            with urllib.request.urlopen(address + query, timeout=10) as response:
                got.append(json.load(response))
            time.sleep(0.3)

    with live_page(source) as address:
        page = threading.Thread(target=ask, args=(address,))
        page.start()
        while not got:
            time.sleep(0.01)
        source.ended = True
    page.join()
    assert got[-1]["status"] == "film.nc is written"


@pytest.fixture(scope="module")
def browser():
    with chromium() as started:
        yield started


class TestInTheBrowser:
    pytestmark = MARKS

    @pytest.fixture(autouse=True)
    def impatient(self, monkeypatch):
        """The server waits less for a page that was closed before it."""
        monkeypatch.setattr("erlif.show.view.live._PATIENCE", 0.5)

    @pytest.mark.parametrize("size", SIZES)
    def test_map_numbers_faults_and_alarms_are_shown(self, browser, size):
        source = Source()
        with live_page(source) as address, pages(browser, own=address) as start:
            page = start(viewport=size)
            page.goto(address)
            page.wait_for_selector("body[data-shown='pair 2']")
            assert page.inner_text("#film_min") == "4.00 ± 0.10 µm"
            assert page.inner_text("#saturated") == "0.0 % / 1.0 %"
            assert page.inner_text("#drift") == "–, 0.25 px"
            assert page.inner_text("#joint_load") == "222 N"
            assert page.inner_text("#temperature") == "25.0 °C"
            assert "camera 2 lacks frame 1" in page.inner_text("#faults")
            assert "saturated: 1.0 %" in page.inner_text("#key")
            assert page.is_hidden("#alarm")
            wide = page.evaluate("document.documentElement.scrollWidth")
            assert wide <= size["width"]
            page.wait_for_selector("#film canvas")

            source.alarms, source.version = {"film": "minimum film 4 um"}, 4
            page.wait_for_selector("#alarm:not([hidden])")
            assert page.inner_text("#alarm") == "minimum film 4 um"
            assert page.title().startswith("ALARM")

            source.ended, source.version = True, 5
            page.wait_for_selector("#status.stated")
            assert page.inner_text("#status") == "film.nc is written"

    def test_maps_that_pass_quickly_have_half_the_detail_and_the_last_all(self, browser):
        with live_page(Film()) as address, pages(browser, own=address) as start:
            page = start(viewport={"width": 1280, "height": 900})
            page.goto(address)
            caption = page.locator("#panel figcaption")
            caption.filter(has_text="2 × 2").wait_for()
            caption.filter(has_text="pair 40").filter(has_not_text="2 × 2").wait_for()

    @pytest.mark.parametrize("size", SIZES)
    def test_both_cameras_and_what_to_turn_are_shown(self, browser, size):
        source = Trial()
        with live_page(source, page="setup.html") as address, pages(browser, own=address) as start:
            page = start(viewport=size)
            page.goto(address)
            page.wait_for_selector("#panel-2 canvas[data-text='pair 2']")
            assert page.inner_text("#advice") == "camera 2 saturates"
            assert "64.2 DN" in page.inner_text("#checks")
            assert "no darks yet" in page.inner_text("#checks")
            assert "4.0, −3.0 px" in page.inner_text("#checks")
            page.wait_for_selector("#histogram-1 canvas")
            wide = page.evaluate("document.documentElement.scrollWidth")
            assert wide <= size["width"]
