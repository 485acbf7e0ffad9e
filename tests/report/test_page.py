"""Report pages: one file, nothing fetched, nothing interpreted that was meant as text."""

from __future__ import annotations

from html.parser import HTMLParser

from navfmu.report.figure import figure, png
from navfmu.report.page import Page


class Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.sources: list[str] = []

    def handle_starttag(self, tag, attributes):
        if tag not in ("meta", "img"):
            self.open.append(tag)
        self.sources += [value for name, value in attributes if name in ("src", "href")]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def made() -> Page:
    page = Page("a <b> & c", "lead")
    page.heading("h")
    page.items(["<script>alert(1)</script>"])
    page.table(["name", "value"], [["x <y>", 1.5], ["z", 2]], lambda row, column: "good" if column else None)
    inner = Page("")
    inner.code("a < b")
    page.folded("more", inner)
    return page


def test_a_page_is_well_formed_and_fetches_nothing():
    with figure(size=(2, 2)) as (drawing, axis):
        axis.plot([0, 1])
        image = png(drawing, dpi=40)
    page = made()
    page.picture(image, 'a "title"', "caption")
    reader = Reader()
    reader.feed(page.html())
    assert reader.open == [] and len(reader.sources) == 1 and reader.sources[0].startswith("data:image/png;base64,")


def test_text_stays_text_and_numbers_stand_right():
    text = made().html()
    assert "<script>" not in text and "x &lt;y&gt;" in text
    assert '<th class="n">value</th>' in text and '<td class="n good">1.5</td>' in text


def test_the_same_drawing_gives_the_same_bytes():
    images = []
    for _ in range(2):
        with figure(2, 1, size=(3, 2), sharex=True) as (drawing, axes):
            axes[0].plot([1, 2], label="a")
            images.append(png(drawing, dpi=40))
    assert images[0] == images[1] and images[0].startswith(b"\x89PNG")
