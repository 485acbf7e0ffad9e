"""The page of a player, once it plays a recording: whose it is and what was found in it, not the built-in example."""

from __future__ import annotations

from collections.abc import Mapping

from navfmu.errors import visible
from navfmu.fmi import tables

PAGE, ACCOUNT = "documentation/index.html", "documentation/import.txt"
AS_BUILT = "as built it holds"
"""What the page of a player says of the samples that it is built with."""


def recorded(files: Mapping[str, bytes], name: str, text: str, account: str) -> dict[str, bytes]:
    """Return the files of a player with the account of the recording ``name``, which ``text`` describes; where there is
    a page, too, and without the response of the built-in samples."""
    account = "\n".join(map(visible, account.split("\n")))  # columns may have names of any characters
    files = {**files, ACCOUNT: account.encode()}
    return {**files, PAGE: _page(files, name, text, account)} if PAGE in files else files


def _page(files: Mapping[str, bytes], name: str, text: str, account: str) -> bytes:
    from lxml import html

    root = html.document_fromstring(files[PAGE].decode())
    body = root.find("body")
    root.find("head/title").text = name
    heading, about = body.find("h1"), body.find("p")
    heading.text, about.text = name, f"{text}. Played by {heading.text}: {about.text}"
    for paragraph in body.findall("p"):
        if AS_BUILT in paragraph.text_content():
            body.remove(paragraph)
    titles = body.findall("h2")
    for title, following in zip(titles, [*titles[1:], None], strict=True):
        if title.text == "Response":
            for element in list(body)[body.index(title) : body.index(following)]:
                body.remove(element)
    section, lines = html.Element("h2"), html.Element("pre", style="white-space: pre-wrap")
    section.text, lines.text = "Recording", account
    first = body.index(body.find("h2"))
    body.insert(first, section)
    body.insert(first + 1, lines)
    for table in tables.known(files):
        rows = len(next(iter(tables.read(files, table, PAGE).values())))
        for cell in body.iterfind(".//td"):
            code = cell.find("code")
            if code is not None and code.text == f"{tables.FOLDER}/{table}{tables.SUFFIX}":
                cell.getnext().text = f"{rows} rows"
    return html.tostring(root, encoding="UTF-8", doctype="<!DOCTYPE html>")
