"""Declared contents of TOML files: what may stand in one, and the sentence when something else does.

A kind of file is one class for the file and one for each kind of table in it:

    class Picture(Table):
        \"\"\"One picture of the report.\"\"\"

        title: str = Field(description="heading above the picture")
        signals: Texts = Field(description="what is drawn")
        unit: str | None = Field(None, description="unit on the axis; default: that of the first signal")

    class ReportFile(Table):
        \"\"\"What a system shows in reports.\"\"\"

        picture: list[Picture] = Field([], description="pictures, in the order of the page")

    report = validated(Document.read(path, "report file"), ReportFile)   # a ReportFile, or a NavfmuError

The description of a required entry completes "expected ...". What a schema cannot say (names that must exist in a
system, two entries that exclude each other) its reader checks afterwards, with ``document.error(sentence, *place)``.
A row in ``navfmu/cli/schema.py`` makes ``navfmu schema KIND`` print the schema for editors.

This module imports pydantic (0.1 s): import it, and modules of such classes, where a file is read and not before.
"""

from __future__ import annotations

import re
from datetime import date, time
from typing import Annotated, Any, ClassVar, TypeVar, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, ValidationError, WithJsonSchema

from navfmu.errors import NavfmuError, nearest
from navfmu.files.toml import Document, Place

__all__ = ["Field", "Number", "Table", "Texts", "json_schema", "validated"]

Number = Annotated[int | float, WithJsonSchema({"type": "number"})]  # stays an int where one is written
Texts = list[str]
FEW = 6  # entries that a table may have, which a sentence tells


class Table(BaseModel):
    """A table of a TOML file; entries that it does not declare are refused."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    noun: ClassVar[str] = ""  # with it, sentences about such a table begin with "fault 'x': ", from its entry "id"


M = TypeVar("M", bound=Table)


def validated(document: Document, model: type[M]) -> M:
    """The content of a document as ``model``, or a sentence with file, line and, for a wrong name, the nearest one."""
    try:
        return model.model_validate(document.content)
    except ValidationError as error:
        problems = _by_place(error, document.content)
    place = min(problems, key=lambda place: (_is_missing(problems[place]), document.line(*place)))  # a typo is both
    raise _sentence(document, model, place, problems[place])


def _by_place(error: ValidationError, content: Any) -> dict[Place, list[dict[str, Any]]]:
    """Problems by place in the document; pydantic's places also name the branches of unions that it tried."""
    found: dict[Place, list[dict[str, Any]]] = {}
    for problem in error.errors(include_url=False):
        place, value = [], content
        for part in problem["loc"]:
            inside = isinstance(value, dict) and part in value
            if inside or (isinstance(value, list) and isinstance(part, int)):
                place.append(part)
                value = value[part]
            elif problem["type"] == "missing" and part == problem["loc"][-1]:
                place.append(part)
        found.setdefault(tuple(place), []).append(problem)
    deepest = {place for place in found if not any(other[: len(place)] == place != other for other in found)}
    return {place: problems for place, problems in found.items() if place in deepest}  # a union's branch that fits best


def _sentence(document: Document, model: type[Table], place: Place, problems: list[dict[str, Any]]) -> NavfmuError:
    """The sentence about the problems at one place."""
    table, entry, where = _table(document.content, model, place)
    key = next((str(part) for part in reversed(place) if isinstance(part, str)), "")
    value, kinds = problems[0]["input"], {problem["type"] for problem in problems}
    noun = table.noun or next((str(part) for part in reversed(where) if isinstance(part, str)), "file")
    name = entry.get("id") if table.noun and isinstance(entry.get("id"), str) else None
    if _is_missing(problems):
        if not where:
            about = _field(table, key).description
            return document.error(f"has no '{key}'{f'; expected {about}' if about else ''}")
        subject = f"{noun} '{name}'" if name else f"this {noun}"
        return document.error(f"{subject} has no '{key}'", *place)
    label = f"{noun} '{name}': " if name else ""
    if kinds == {"extra_forbidden"}:
        known = [field.alias or name for name, field in table.model_fields.items()]
        hint = nearest(key, known) or (f"; expected {' or '.join(known)}" if len(known) <= FEW else "")
        return document.error(f"{label}unknown entry '{key}'{hint}", *place)
    said = next((problem["ctx"]["error"] for problem in problems if problem["type"] == "value_error"), None)
    if said is not None:  # from a validator of the class: its sentence; that of an entry goes on after the name
        subject = "" if place == where else f"'{key}' "
        return document.error(f"{label}{subject}{said}", *place)
    if value == [] and "too_short" in kinds:
        field = _field(table, key)
        out = "" if field is not None and field.is_required() else f"; or leave '{key}' out"
        return document.error(f"{label}'{key}' is an empty list, expected at least one{out}", *place)
    if not isinstance(value, list) and key == place[-1] and _of_tables(_field(table, key)):
        names = ".".join(part for part in place if isinstance(part, str))
        return document.error(f"{label}'{key}' is written as tables: [[{names}]]", *place)
    wanted = dict.fromkeys(_expected(problem) for problem in problems)
    expected = " or ".join(words for words in wanted if words != WHOLE or NUMBER not in wanted)
    verb = "holds" if isinstance(place[-1], int) else "is"
    return document.error(f"{label}'{key}' {verb} {_shown(value)}, expected {expected}", *place)


def _is_missing(problems: list[dict[str, Any]]) -> bool:
    return problems[0]["type"] == "missing"


def _table(content: Any, model: type[Table], place: Place) -> tuple[type[Table], dict[str, Any], Place]:
    """The innermost table around a place, or at it: its class, its content and its own place."""
    found, depth, field, value = (model, content), 0, None, content
    for number, part in enumerate(place, 1):
        if isinstance(part, str):
            field = _field(found[0], part)
            if field is None or part not in value:
                break
        value = value[part]
        kind = None if field is None else _inner(field.annotation, value)
        if kind is not None and isinstance(value, dict) and (isinstance(part, int) or not _of_tables(field)):
            found, depth, field = (kind, value), number, None
    return *found, place[:depth]


def _field(table: type[Table], key: str) -> Any:
    return next((field for name, field in table.model_fields.items() if key == (field.alias or name)), None)


def _inner(annotation: Any, value: Any = None) -> type[Table] | None:
    """The class of tables in an annotation such as ``list[Case] | None``; of several the one of the value's kind."""
    classes = _classes(annotation)
    of_kind = (c for c in classes if isinstance(value, dict) and value.get("kind") in _literals(c))
    return next(of_kind, classes[0] if classes else None)


def _classes(annotation: Any) -> list[type[Table]]:
    if isinstance(annotation, type) and get_origin(annotation) is None:
        return [annotation] if issubclass(annotation, Table) else []
    return [kind for part in get_args(annotation) for kind in _classes(part)]


def _literals(table: type[Table]) -> tuple[Any, ...]:
    """The kinds that a class of tables is for."""
    field = _field(table, "kind")
    return () if field is None else get_args(field.annotation)


def _of_tables(field: Any) -> bool:
    """Whether an entry is a list of tables."""
    kinds = () if field is None else (field.annotation, *get_args(field.annotation))
    return any(get_origin(kind) is list and _inner(kind) is not None for kind in kinds)


WHOLE, NUMBER = "a whole number", "a number"
_WORDS = {
    "string_type": "a text",
    "int_type": WHOLE,
    "float_type": NUMBER,
    "bool_type": "true or false",
    "list_type": "a list",
    "dict_type": "a table",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "finite_number": "a finite number",
    "string_too_short": "a text that is not empty",
    "greater_than": "more than {gt:g}",
    "greater_than_equal": "at least {ge:g}",
    "less_than": "less than {lt:g}",
    "less_than_equal": "at most {le:g}",
    "literal_error": "{expected}",
}


def _expected(problem: dict[str, Any]) -> str:
    words, context = _WORDS.get(problem["type"]), problem.get("ctx", {})
    if words is None:
        return problem["msg"][:1].lower() + problem["msg"][1:]
    hint = nearest(problem["input"], re.findall("'([^']*)'", context["expected"])) if "expected" in context else ""
    return words.format(**context) + hint


def _shown(value: Any) -> str:
    """A value as a file has it, shortened."""
    text = str(value).lower() if isinstance(value, bool) else repr(value)
    text = value.isoformat() if isinstance(value, date | time) else text
    return text if len(text) <= 60 else f"{text[:57]}..."


# ---- for editors -----------------------------------------------------------------------------------------------------


def json_schema(model: type[Table]) -> dict[str, Any]:
    """The JSON schema of a kind of file."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **_plain(model.model_json_schema())}


def _plain(node: Any) -> Any:
    """A schema without pydantic's titles, which only repeat names, and without null as a value or a default."""
    if isinstance(node, list):
        return [_plain(item) for item in node if item != {"type": "null"}]
    if not isinstance(node, dict):
        return node
    kept = {k: _plain(v) for k, v in node.items() if not (k == "title" and isinstance(v, str))}
    if kept.get("default", 0) is None:
        del kept["default"]
    if len(kept.get("anyOf", ())) == 1:
        kept |= kept.pop("anyOf")[0]
    return kept
