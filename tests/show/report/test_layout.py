"""The frame of a page."""

from markupsafe import Markup

from erlif.show.report.layout import (
    PageFigure,
    PageTable,
    arrange_figures,
    compose_page,
    download_link,
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


def test_no_row_of_figures_is_half_empty(read_page):
    for widths, expected in (
        ("11", ["one", "one"]),
        ("1", ["one lone"]),
        ("2111", ["two", "one", "one", "one lone"]),
        ("121", ["one lone", "two", "one lone"]),
    ):
        wide = [width == "2" for width in widths]
        figures = [PageFigure(f"{n}", "data:", "", "", each) for n, each in enumerate(wide)]
        page = read_page(arrange_figures(figures))
        assert page.open == []
        assert [attrs["class"] for attrs in page.all("figure")] == expected
        assert [attrs["id"] for attrs in page.all("figure")] == [
            f"figure-{n}" for n in range(len(wide))
        ]


def test_cells_links_and_names_of_files_stay_text(read_page):
    one = PageTable([("<a>", "1")], ("name", "value"), "title", numbers=[1])
    page = read_page(render("pairs.html", pairs=one))
    assert (page.texts["caption"], page.texts["tbody"]) == ("title", "<a>1")
    classes = [cell.get("class") for cell in (*page.all("th"), *page.all("td"))]
    assert classes == [None, "n", None, "n"]

    link = read_page(download_link("</a>\"'", name='"<b>', label="<i>"))
    assert [tag for tag, _ in link.elements] == ["a"]
    assert link.texts["a"] == "<i>"
    for run, name in (
        ("../../etc/passwd", "etc_passwd_x.csv"),
        ('"><script>alert(1)</script>', "script_alert_1_script_x.csv"),
        ("Öl 5°", "Öl_5_x.csv"),
        ("<>", "x.csv"),
    ):
        assert file_name(run, "x.csv") == name
