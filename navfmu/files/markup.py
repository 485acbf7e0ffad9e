"""Reads XML without entity expansion, document types or network access, and validates it against a schema."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

from navfmu.errors import NavfmuError

_DOCTYPE = "has a document type declaration, which is not accepted"


def parse(data: bytes, where: str) -> Any:
    """The root element of an XML document (lxml); ``where`` names the file in messages."""
    from lxml import etree

    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, dtd_validation=False, huge_tree=False
    )
    try:
        root = etree.fromstring(data, parser)
    except etree.XMLSyntaxError as error:
        if b"<!DOCTYPE" in data:  # such as entities that multiply
            raise NavfmuError(f"{where}: {_DOCTYPE}") from None
        line = f", line {error.lineno}" if error.lineno else ""
        raise NavfmuError(f"{where}{line}: is not well-formed XML: {_without_place(error.msg)}") from None
    if root.getroottree().docinfo.doctype:
        raise NavfmuError(f"{where}: {_DOCTYPE}")
    return root


def validate(root: Any, schema: Path, where: str) -> None:
    """Check a document against an XML schema; the first problem becomes a sentence with its line."""
    rules = _schema(schema)
    if not rules.validate(root):
        problem = rules.error_log[0]
        more = f" (and {len(rules.error_log) - 1} more)" if len(rules.error_log) > 1 else ""
        raise NavfmuError(f"{where}, line {problem.line}: {_plain(problem.message)}{more}")


@cache
def _schema(path: Path) -> Any:
    from lxml import etree

    return etree.XMLSchema(file=str(path))


def _without_place(message: str) -> str:
    """A parser's message without the line, which stands before it already."""
    return message.rpartition(", line ")[0] or message


def _plain(message: str) -> str:
    """A schema message without namespaces in braces."""
    import re

    return re.sub(r"\{\w+://[^}]*\}", "", message).rstrip(".")
