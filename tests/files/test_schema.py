"""Declared files: the first mistake is a sentence with its line, whatever the declaration."""

from __future__ import annotations

from typing import ClassVar, Literal

import pytest

from navfmu.errors import NavfmuError
from navfmu.files.schema import Field, Number, Table, Texts, json_schema, validated
from navfmu.files.toml import Document


class Part(Table):
    noun: ClassVar[str] = "part"

    id: str
    size: float = Field(1.0, gt=0, le=100)
    begin: Number | None = Field(None, alias="from")
    kind: Literal["small", "large"] = "small"


class Group(Table):
    name: str
    members: str | Texts = Field([])
    part: list[Part] | None = Field(None, min_length=1)


class File(Table):
    title: str = Field(description="a text for people")
    seeds: str | list[int] = "1"
    wanted: bool = True
    values: dict[str, Number] = Field({})
    group: list[Group] = Field([])


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "f.toml: has no 'title'; expected a text for people"),
        ("titel = 'x'", "f.toml, line 1: unknown entry 'titel'; did you mean 'title'?"),
        ("title = 3", "f.toml, line 1: 'title' is 3, expected a text"),
        ("title = 'x'\nseeds = true", "f.toml, line 2: 'seeds' is true, expected a text or a list"),
        ("title = 'x'\nseeds = [1,\n'b']", "f.toml, line 3: 'seeds' holds 'b', expected a whole number"),
        ("title = 'x'\nwanted = 1", "f.toml, line 2: 'wanted' is 1, expected true or false"),
        ("title = 'x'\n[values]\na = 1\nb = 'c'", "f.toml, line 4: 'b' is 'c', expected a number"),
        ("title = 'x'\n[group]\n", "f.toml, line 2: 'group' is written as tables: [[group]]"),
        ("title = 'x'\ngroup = 3", "f.toml, line 2: 'group' is written as tables: [[group]]"),
        ("title = 'x'\n[[group]]\n", "f.toml, line 2: this group has no 'name'"),
        ("title = 'x'\n[[group]]\nname = 'g'\nmembers = ['a', 2]", "line 4: 'members' holds 2, expected a text"),
        ("title = 'x'\n[[group]]\nname = 'g'\npart = {}", "line 4: 'part' is written as tables: [[group.part]]"),
        ("title = 'x'\n[[group]]\nname = 'g'\npart = []", "f.toml, line 4: 'part' is an empty list, expected at least"),
        ("title = 'x'\n[[group]]\nname = 'g'\n[[group.part]]\n", "f.toml, line 4: this part has no 'id'"),
        ("title = 'x'\n[[group]]\nname = 'g'\n[[group.part]]\nid = 'p'\nfrmo = 1",
         "f.toml, line 6: part 'p': unknown entry 'frmo'; did you mean 'from'?"),
        ("title = 'x'\n[[group]]\nname = 'g'\n[[group.part]]\nid = 'p'\nbegin = 1", "part 'p': unknown entry 'begin'"),
        ("title = 'x'\n[[group]]\nname = 'g'\n[[group.part]]\nid = 'p'\nsize = 0", "'size' is 0, expected more than 0"),
        ("title = 'x'\n[[group]]\nname = 'g'\n[[group.part]]\nid = 'p'\nkind = 'lrge'",
         "part 'p': 'kind' is 'lrge', expected 'small' or 'large'; did you mean 'large'?"),
        ("title = 'x'\nwanted = 1\nsede = 3", "f.toml, line 2"),  # the first one in the file
    ],
)  # fmt: skip
def test_a_mistake_is_a_sentence(text, sentence):
    with pytest.raises(NavfmuError) as caught:
        validated(Document(text, "f.toml"), File)
    assert sentence in str(caught.value)


def test_what_is_right_is_read_with_its_own_types():
    text = "title = 'x'\nvalues = {a = 1, b = 1.0}\n[[group]]\nname = 'g'\n[[group.part]]\nid = 'p'\nfrom = 3"
    file = validated(Document(text, "f.toml"), File)
    assert [type(value) for value in file.values.values()] == [int, float]
    assert file.group[0].part[0].begin == 3 and file.seeds == "1"


def test_the_schema_for_editors_knows_no_null():
    schema = json_schema(File)
    assert "null" not in str(schema) and "ge" not in schema["$defs"]["Part"]["properties"]["size"]
    assert schema["required"] == ["title"] and schema["additionalProperties"] is False
    assert schema["$defs"]["Part"]["properties"]["from"] == {"type": "number"}
