"""A film by formula, and its report with a few figures."""

import pytest
from scenes.film import changed as changed
from scenes.film import film as film
from scenes.film import film_path as film_path
from scenes.page import Page

from erlif.show.report import page as pages
from erlif.show.report import write_report

DRAWN_FEW = ("speed_against_angle", "fixture_profile", "thickness_map")


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
def without_figures(monkeypatch):
    """Leave out the figures, which take most of the time of a page."""
    monkeypatch.setattr(pages, "DRAWN", {})
