"""Annotations: what tools add to a document for themselves, at almost every element of it."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from typing import Any

from navfmu.ssp.document import NAMESPACES

ANNOTATION = f"{{{NAMESPACES['ssc']}}}Annotation"
DOCUMENTS = ("SystemStructureDescription", "ParameterSet", "ParameterMapping")


def unread(root: Any, label: str, read: Collection[Any] = ()) -> Iterator[str]:
    """A sentence for each annotation of a document in which none of the elements ``read`` stands."""
    for annotation in root.iter(ANNOTATION):
        holder = annotation.getparent()
        if next(annotation.iterancestors(ANNOTATION), None) is not None or holder is None or holder.getparent() is None:
            continue  # a part of another annotation
        if not any(annotation in element.iterancestors() for element in read):
            owner = _described(holder.getparent(), root)
            yield f"{label}, line {annotation.sourceline}: annotation '{annotation.get('type')}' of {owner}"


def _described(element: Any, root: Any) -> str:
    """An element in words: "the connector 'y'"."""
    kind, name = element.tag.rpartition("}")[2], element.get("name")
    if element is root and kind in DOCUMENTS:
        return "the document"
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", kind).lower()
    return f"the {words} '{name}'" if name and kind != "System" else f"the {words}"
