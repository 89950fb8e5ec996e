"""A film by formula, its report with a few figures, and a reader of pages."""

import base64
import csv
import io
from html.parser import HTMLParser

import pytest
from scenes.film import changed as changed
from scenes.film import film as film
from scenes.film import film_path as film_path

from erlif.show.report import page as pages
from erlif.show.report import write_report

CSV = "data:text/csv;charset=utf-8;base64,"
VOID = {"meta", "img", "input", "br"}
DRAWN_FEW = ("speed_against_angle", "fixture_profile", "thickness_map")


class Page(HTMLParser):
    """Elements of a page and their text; an element that is closed out of order fails."""

    def __init__(self, text):
        super().__init__()
        self.source = text
        self.open, self.elements, self.texts = [], [], {}
        self.feed(str(text))
        self.close()

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append((tag, dict(attrs).get("id")))

    def handle_endtag(self, tag):
        assert self.open[-1][0] == tag, f"{tag} closes {self.open[-1]}"
        self.open.pop()

    def handle_data(self, data):
        for tag, name in self.open:
            for key in (tag, name):
                if key is not None:
                    self.texts[key] = self.texts.get(key, "") + data

    def all(self, tag):
        """Attributes of all elements of a kind."""
        return [attrs for name, attrs in self.elements if name == tag]

    def saved(self):
        """Name and rows of the table behind the link of the page."""
        (link,) = [attrs for attrs in self.all("a") if attrs["href"].startswith(CSV)]
        text = base64.b64decode(link["href"].removeprefix(CSV)).decode("utf-8")
        return link["download"], list(csv.DictReader(io.StringIO(text)))


@pytest.fixture(scope="package")
def text(film_path):
    """The page as text, with one figure of each kind and one that is left out."""
    few = {name: pages.DRAWN[name] for name in DRAWN_FEW}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pages, "DRAWN", few)
        path = write_report(film_path, film_path.with_name("report.html"))
    return path.read_text(encoding="utf-8")


@pytest.fixture(scope="package")
def page(text):
    """The page of `text`, read."""
    return Page(text)


@pytest.fixture
def read_page():
    """Read a page."""
    return Page


@pytest.fixture
def without_figures(monkeypatch):
    """Leave out the figures, which take most of the time of a page."""
    monkeypatch.setattr(pages, "DRAWN", {})
