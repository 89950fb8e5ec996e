"""Pages as a reader of HTML finds them."""

import base64
import csv
import io
from html.parser import HTMLParser

CSV = "data:text/csv;charset=utf-8;base64,"
VOID = {"meta", "img", "input", "br", "link"}


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
