"""Sentences break between words: a path or the name of a signal is whole, so that it can be found and copied."""

from __future__ import annotations

import io
import os
import re
import subprocess
import sys

import pytest
from rich.console import Console
from rich.text import Text

from navfmu.terminal.console import say
from navfmu.terminal.table import Column, Kind, Table

PATH = "results/a_long_name_of_a_campaign/runs/" + "0123456789abcdef" * 2 + ".parquet"
SENTENCE = f"flown again: {PATH}: is damaged: 'navigator.solution.velocity_n[1]' differs, and 'evaluation.error' too"


@pytest.mark.parametrize("width", [40, 60, 80])
@pytest.mark.parametrize("text", [SENTENCE, Text.assemble(("flown", "red"), SENTENCE[5:])])
def test_words_are_whole(width, text, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(width))
    out = Console(file=io.StringIO(), width=width)
    say(out, text, indent=2, hang=2)
    lines = out.file.getvalue().splitlines()
    assert " ".join(line.strip() for line in lines) == SENTENCE
    assert all(len(line) <= width or len(line.split()) == 1 for line in lines)
    assert lines[0].startswith("  f") and all(line.startswith("    ") for line in lines[1:])


def test_a_sentence_of_a_table_goes_below_before_its_words_are_broken():
    columns = [Column("name", Kind.NAME), Column("value"), Column("about", Kind.SENTENCE)]
    out = Console(file=io.StringIO(), width=60)
    out.print(
        Table(columns, [["a_component.with_a_signal", "12345.678", "see navigator.solution.velocity_n[1] there"]])
    )
    assert "navigator.solution.velocity_n[1]" in out.file.getvalue()
    assert max(map(len, out.file.getvalue().splitlines())) <= 66


@pytest.mark.skipif(os.name == "nt", reason="terminals of Unix")
@pytest.mark.parametrize("width", [40, 80])
def test_a_refusal_on_a_terminal(width, tmp_path):
    import pty

    name = tmp_path / "faults_of_a_long_name" / "that_are_not_there.toml"
    command = [sys.executable, "-m", "navfmu", "campaign", str(name), "--seeds", "1-8"]
    reading, writing = pty.openpty()
    process = subprocess.Popen(command, stderr=writing, env=os.environ | {"COLUMNS": str(width)})
    assert process.wait(timeout=60) == 2
    os.close(writing)
    said = os.read(reading, 10_000).decode()
    os.close(reading)
    assert str(name) in said
    assert all(len(line) <= width or len(line.split()) == 1 for line in re.split(r"\r?\n", said))
