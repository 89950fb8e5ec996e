"""The frame of a page."""

from erlif.plots.style import new_figure
from erlif.report.captions import Caption
from erlif.report.layout import compose_page, embed_figure, read_resource


def test_names_are_escaped_and_sections_are_linked(read_page):
    text = compose_page(
        [("one", "First", "<p>a</p>"), ("two", "Second", "<p>b</p>")],
        name="a <b>",
        subject="check",
        subtitle="c & d",
    )
    page = read_page(text)
    assert page.open == []
    assert page.texts["h1"] == "a <b>"
    assert page.texts["title"] == "a <b>: check"
    assert [link["href"] for link in page.all("a")] == ["#one", "#two"]
    assert read_resource("page.css") in text


def test_a_figure_is_part_of_the_page(read_page):
    figure = new_figure()
    figure.add_subplot()
    page = read_page(embed_figure("empty", figure, Caption("Title", "Text"), "<text>"))
    (image,) = page.all("img")
    assert image["src"].startswith("data:image/svg+xml;base64,")
    assert image["alt"] == "Title. <text>"
