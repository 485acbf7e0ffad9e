"""Tables at all widths: names fold, sentences wrap, numbers stay whole."""

from __future__ import annotations

import io
import random

import pytest
from rich.console import Console
from rich.text import Text

from navfmu.terminal.console import console, say
from navfmu.terminal.table import Column, Kind, Table

COLUMNS = [
    Column("name", Kind.NAME), Column("unit", Kind.WORD), Column("first"), Column("largest difference"),
    Column("last"), Column("what it is", Kind.SENTENCE),
]  # fmt: skip


def rows(count=20):
    chosen = random.Random(1)
    sentence = "the component of velocity over ground in the direction of north, as the filter sees it"
    return [
        [f"navigator.solution.velocity_n[{i}]", "m/s", *(f"{chosen.gauss(0, 1e3):.6g}" for _ in range(3)), sentence]
        for i in range(count)
    ]


def printed(table, width):
    out = Console(file=io.StringIO(), width=width)
    out.print(table)
    return out.file.getvalue()


@pytest.mark.parametrize("width", [24, 30, 40, 50, 60, 70, 80, 100, 160, 300])
def test_numbers_are_whole_and_lines_fit(width):
    text = printed(Table(COLUMNS, rows(), "the title of a table that is longer than a narrow terminal"), width)
    words = text.split()
    for row in rows():
        assert all(number in words for number in row[2:5])
    assert max(map(len, text.splitlines())) <= width and "…" not in text
    assert words.count("component") == 20 and text.count("n[13]") >= 1


def test_a_wide_terminal_gets_one_line_for_each_row():
    assert len(printed(Table(COLUMNS, rows()), 300).splitlines()) == 2 + 20


def test_sentences_go_below_before_names_fold_or_columns_part():
    lines = printed(Table(COLUMNS, rows(2)), 80).splitlines()
    assert lines[2].startswith("navigator.solution.velocity_n[0]  m/s ") and lines[3].startswith("    the component")


def test_columns_that_do_not_fit_follow_with_the_names_repeated():
    table = Table([Column("name", Kind.NAME), *(Column(f"{i} s") for i in range(9))],
                  [["imu.rate", *(f"{i}.000001" for i in range(9))]])  # fmt: skip
    lines = printed(table, 40).splitlines()
    assert [line.split()[0] for line in lines] == ["name", "imu.rate"] * 3
    assert sum(("0.000001" in line) + ("8.000001" in line) for line in lines) == 2


def test_names_fold_after_their_dots():
    table = Table([Column("name", Kind.NAME), Column("value")], [["navigator.solution.latitude", "123456789012"]])
    assert printed(table, 34).splitlines()[1:] == ["navigator.solution.  123456789012", " latitude"]


def test_cells_are_no_markup_and_may_be_styled():
    table = Table([Column("name", Kind.NAME), Column("verdict", Kind.WORD)], [["a[red]", Text("holds", style="green")]])
    assert "a[red]  holds" in printed(table, 80)


def test_output_is_as_wide_as_columns_says_and_wide_in_a_file(monkeypatch):
    monkeypatch.setenv("COLUMNS", "72")
    assert console().width == 72
    monkeypatch.delenv("COLUMNS")  # as in a file
    assert console().width == 160


def test_sentences_wrap_in_a_terminal_and_are_one_line_in_a_file(monkeypatch, capsys):
    monkeypatch.delenv("COLUMNS", raising=False)
    sentence = "twelve words [x] that say something about 12.25 m of error and no more " * 4
    say(console(), sentence)
    assert len(capsys.readouterr().out.splitlines()) == 1
    monkeypatch.setenv("COLUMNS", "50")
    say(console(), sentence, indent=2)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) > 4 and max(map(len, lines)) <= 50 and all(line.startswith("  ") for line in lines)
    assert sum(line.count("[x]") for line in lines) == 4
