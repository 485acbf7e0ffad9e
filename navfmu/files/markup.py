"""Reads XML without entity expansion, document types or network access, and validates it against a schema.

Both are strict unless they are given a list for what is read all the same: prefixes that nothing declares, attributes
that the schema does not know.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from navfmu.errors import NavfmuError

TRUTH_VALUES = ("true", "false", "1", "0")
PREFIXES = 20  # undeclared ones that are put up with in one document
_DOCTYPE = "has a document type declaration, which is not accepted"
_UNDECLARED = re.compile(r"Namespace prefix ([\w.-]+) .*is not defined")
_ROOT = re.compile(rb"\A(?:\xef\xbb\xbf)?(?:\s+|<\?.*?\?>|<!--.*?-->)*<[A-Za-z_][\w.:-]*", re.DOTALL)
_UNKNOWN = re.compile(r"Element '([^']+)', attribute '([^']+)': The attribute '[^']+' is not allowed")


def parse(data: bytes, where: str, lenient: list[str] | None = None, prefixes: Mapping[str, str] | None = None) -> Any:
    """The root element of an XML document (lxml); ``where`` names the file in messages.

    With a list ``lenient``, a prefix that nothing declares means the namespace that ``prefixes`` give it, or one of its
    own, and the list says so.
    """
    from lxml import etree

    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, dtd_validation=False, huge_tree=False
    )
    said: set[str] = set()
    while True:
        try:
            root = etree.fromstring(data, parser)
            break
        except etree.XMLSyntaxError as error:
            if b"<!DOCTYPE" in data:  # such as entities that multiply
                raise NavfmuError(f"{where}: {_DOCTYPE}") from None
            line = f", line {error.lineno}" if error.lineno else ""
            undeclared, start = _UNDECLARED.match(error.msg), _ROOT.match(data)
            if lenient is None or undeclared is None or start is None or undeclared[1] in said or len(said) == PREFIXES:
                raise NavfmuError(f"{where}{line}: is not well-formed XML: {_without_place(error.msg)}") from None
            prefix = undeclared[1]
            said.add(prefix)
            lenient.append(f"{where}{line}: the prefix '{prefix}' is not declared")
            declaration = f' xmlns:{prefix}="{(prefixes or {}).get(prefix, f"urn:undeclared:{prefix}")}"'
            data = data[: start.end()] + declaration.encode() + data[start.end() :]
    if root.getroottree().docinfo.doctype:
        raise NavfmuError(f"{where}: {_DOCTYPE}")
    return root


def validate(root: Any, schema: Path, where: str, lenient: list[str] | None = None, harmless: str = r"(?!)") -> None:
    """Check a document against an XML schema; the first problem becomes a sentence with its line.

    With a list ``lenient``, attributes that the schema does not know are removed, problems that match ``harmless`` are
    left, and the list says so.
    """
    rules = _schema(schema)
    _trim_truth_values(root)
    if rules.validate(root):
        return
    if lenient is not None:
        lenient += _without_unknown(root, rules.error_log, where)
        rules.validate(root)
    problems = list(rules.error_log)
    if lenient is not None:
        left = [problem for problem in problems if re.search(harmless, problem.message)]
        lenient += [f"{where}, line {problem.line}: {_plain(problem.message)}" for problem in left]
        problems = [problem for problem in problems if problem not in left]
    if problems:
        more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        raise NavfmuError(f"{where}, line {problems[0].line}: {_plain(problems[0].message)}{more}")


def _trim_truth_values(root: Any) -> None:
    """Remove the spaces around true, false, 1 and 0, which schemas allow and readers of attributes do not expect."""
    for element in root.iter("*"):
        for name, value in element.attrib.items():
            if value.strip() in TRUTH_VALUES and value.strip() != value:
                element.set(name, value.strip())


def _without_unknown(root: Any, log: Any, where: str) -> list[str]:
    """Remove the attributes that the schema does not know; a sentence for each kind of them."""
    places: dict[tuple[str, str], set[int]] = {}
    for problem in log:
        if found := _UNKNOWN.match(problem.message):
            places.setdefault((found[1], found[2]), set()).add(problem.line)
    said = []
    for (tag, attribute), lines in places.items():
        elements = [e for e in root.iter(tag) if e.sourceline in lines and attribute in e.attrib]
        for element in elements:
            del element.attrib[attribute]
        more = f" ({len(elements) - 1} more like it)" if len(elements) > 1 else ""
        name = tag.rpartition("}")[2]
        said.append(f"{where}, line {min(lines)}: <{name}> has the unknown attribute '{_plain(attribute)}'{more}")
    return said


@cache
def _schema(path: Path) -> Any:
    from lxml import etree

    return etree.XMLSchema(file=str(path))


def _without_place(message: str) -> str:
    """A parser's message without the line, which stands before it already."""
    return message.rpartition(", line ")[0] or message


def _plain(message: str) -> str:
    """A schema message without namespaces in braces."""
    return re.sub(r"\{\w+://[^}]*\}", "", message).rstrip(".")
