"""The frame of a page."""

import re

import pytest
from markupsafe import Markup

from erlif.show.plots.style import TWO_COLUMNS, new_figure
from erlif.show.report.captions import Caption
from erlif.show.report.layout import (
    PageFigure,
    Table,
    arrange_figures,
    compose_page,
    download_link,
    embed_figure,
    file_name,
    read_resource,
    render,
)


def test_names_are_escaped_and_sections_are_linked(read_page):
    text = compose_page(
        [("one", "First", Markup("<p>a</p>")), ("two", "Second", "<b>")],
        name="a <b>",
        subject="check",
        subtitle="c & d",
    )
    page = read_page(text)
    assert page.open == []
    assert page.texts["h1"] == "a <b>"
    assert page.texts["title"] == "a <b>: check"
    assert page.texts["two"] == "Second\n<b>\n"
    assert [link["href"] for link in page.all("a")] == ["#one", "#two"]
    assert read_resource("page.css") in text


def test_a_figure_is_part_of_the_page(read_page):
    figure = new_figure()
    figure.add_subplot()
    embedded = embed_figure("empty", figure, Caption("Title", "<text>"))
    assert not embedded.wide
    page = read_page(arrange_figures([embedded]))
    assert page.texts["figcaption"] == "Title. <text>"
    (image,) = page.all("img")
    assert image["src"].startswith("data:image/svg+xml;base64,")
    assert image["alt"] == "Title. <text>"


@pytest.mark.parametrize(
    ("widths", "expected"),
    [
        ("11", ["one", "one"]),
        ("1", ["one lone"]),
        ("2111", ["two", "one", "one", "one lone"]),
        ("121", ["one lone", "two", "one lone"]),
    ],
)
def test_no_row_of_figures_is_half_empty(read_page, widths, expected):
    figures = [PageFigure(f"{n}", "data:", "", "", width == "2") for n, width in enumerate(widths)]
    page = read_page(arrange_figures(figures))
    assert page.open == []
    assert [attrs["class"] for attrs in page.all("figure")] == expected
    assert [attrs["id"] for attrs in page.all("figure")] == [
        f"figure-{n}" for n in range(len(widths))
    ]


def test_a_page_without_figures_has_no_grid():
    assert arrange_figures([]) == ""


def test_wide_figures_scroll_in_narrow_windows():
    """Labels of 6.5 pt in 190 mm have 9 px at 640 px, and 3 px in the 342 px of a telephone."""
    figure = new_figure(TWO_COLUMNS)
    figure.add_subplot()
    embedded = embed_figure("wide", figure, Caption("Title", "Text"))
    assert embedded.wide
    assert re.search(r'<div class="wide"><img [^>]*></div>', arrange_figures([embedded]))

    style = read_resource("page.css")
    assert re.search(r"\.wide \{[^}]*overflow-x: auto", style)
    (width,) = re.findall(r"\nfigure.two img \{ min-width: (\d+)rem", style)
    assert 16 * int(width) >= 640


def test_cells_are_escaped_and_numbers_are_aligned_at_the_right(read_page):
    one = Table([("<a>", "1")], ("name", "value"), "title", numbers=[1])
    page = read_page(render("pairs.html", pairs=one))
    assert page.texts["caption"] == "title"
    assert page.texts["tbody"] == "<a>1"
    assert [cell.get("class") for cell in (*page.all("th"), *page.all("td"))] == [
        None,
        "n",
        None,
        "n",
    ]


@pytest.mark.parametrize(
    ("run", "name"),
    [
        ("straight bushing 1", "straight_bushing_1_x.csv"),
        ("../../etc/passwd", "etc_passwd_x.csv"),
        ('"><script>alert(1)</script>', "script_alert_1_script_x.csv"),
        ("Öl 5°", "Öl_5_x.csv"),
        ("<>", "x.csv"),
    ],
)
def test_name_of_a_file_is_plain(run, name):
    assert file_name(run, "x.csv") == name


def test_link_cannot_be_ended_by_its_text(read_page):
    link = read_page(download_link("</a>\"'", name='"<b>', label="<i>"))
    assert [tag for tag, _ in link.elements] == ["a"]
    assert link.texts["a"] == "<i>"
