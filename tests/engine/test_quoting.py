"""What FMUs and files say is passed on in one line that does nothing to a terminal, at a length that one can read."""

from __future__ import annotations

import ctypes
import html
import subprocess
import sys
import warnings
from ctypes import c_char_p, c_int, c_void_p

import pytest
from click.testing import CliRunner

from navfmu import NavfmuError, NavfmuWarning, System
from navfmu.cli.main import main
from navfmu.engine import compiled, reference
from navfmu.engine.loading import engine_library
from navfmu.engine.plan import make_plan
from navfmu.engine.recording import RunError
from navfmu.engine.structures import Callbacks, Log
from navfmu.errors import LENGTH, quoted, visible
from tests.campaign.wreck import SHOUT, wreck
from tests.components import systems
from tests.engine.probe import probe

BEGINNING, END = r"red \x1b[31m,\nnew line,\x07 bell xxx", f"xxx... {200_000 - LENGTH} more characters"
FAIL_STEP, WARN_STEP = 0, 4


def test_control_characters_are_visible():
    text = "a\x1b[2J\x9b\u202eb\n\ud800\u2028c"
    assert visible(text) == r"a\x1b[2J\x9b\u202eb\n\ud800\u2028c" == visible(visible(text))
    assert visible("Höhe ü 高度 \U0001f6e9") == "Höhe ü 高度 \U0001f6e9"
    assert visible("a\u00a0b") == "a\u00a0b"  # a space that does not break is one


def test_what_is_quoted_has_a_length():
    assert quoted(" x\n") == "x" and quoted("x" * LENGTH) == "x" * LENGTH
    assert quoted("x" * (LENGTH + 1)) == "x" * LENGTH + "... 1 more characters"
    assert quoted("x", 7) == "x... 7 more characters"


def shouting(engine, call):
    component = probe("loud", fail_status=SHOUT, fail_at=0.2, fail_call=call)
    return engine.run(make_plan([component], [], step=0.1, stop=0.5))


@pytest.mark.parametrize("engine", [compiled, reference])
def test_a_loud_fmu(engine):
    (note,) = shouting(engine, WARN_STEP).notes
    assert note.startswith(f"component 'loud' warned 4 times, at last: {BEGINNING}") and note.endswith(END)
    with pytest.raises(RunError) as caught:
        shouting(engine, FAIL_STEP)
    sentence = str(caught.value)
    assert sentence.startswith(f"component 'loud': {BEGINNING}") and f"{END} (fmi2DoStep returned Error" in sentence
    assert sentence.isprintable() and len(sentence) < 2 * LENGTH


def test_characters_are_counted_and_none_is_halved():
    """They need up to four bytes; the engine keeps 2047 bytes of a message."""
    log = Log()
    callbacks = Callbacks()
    engine_library().prepare_callbacks(callbacks, log)
    call = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)(callbacks.logger)

    def say(text):
        call(ctypes.addressof(log), b"a", 1, b"", text.encode())

    say("x" + "€" * 3000)
    assert log.warned() == "x" + "€" * (LENGTH - 1) + f"... {3001 - LENGTH} more characters"
    for count in range(660, 690):  # up to what there is room for
        say("€" * count)
        assert log.warned() == "€" * LENGTH + f"... {count - LENGTH} more characters"


def test_console_report_campaign_and_python_pass_it_on_alike(tmp_path):
    wreck(tmp_path)
    given = {"probe.fail_status": SHOUT, "probe.fail_at": 0.75, "probe.fail_call": WARN_STEP}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", NavfmuWarning)
        System.load(tmp_path / "probe.fmu").run(stop=1.0, step=0.1, parameters=given)
    (note,) = [str(warning.message) for warning in caught]
    assert BEGINNING in note and note.endswith(END) and note.isprintable()
    words = [sys.executable, "-m", "navfmu", "run", "probe.fmu", "--stop", "1", "--step", "0.1", "--report", "r"]
    words += [word for name, value in given.items() for word in ("--set", f"{name}={value}")]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stderr == f"note: {note}\n"
    assert f"<li>{note}</li>" in html.unescape((tmp_path / "r" / "report.html").read_text())
    text = 'system = "probe.fmu"\nstop = 1\nstep = 0.1\n[[case]]\nname = "loud"\n[case.parameters]\n'
    text += "".join(f'"{name}" = {value}\n' for name, value in (given | {"probe.fail_call": FAIL_STEP}).items())
    (tmp_path / "c.toml").write_text(text)
    done = subprocess.run([*words[:3], "campaign", "c.toml"], cwd=tmp_path, capture_output=True, text=True, check=True)
    said = " ".join(done.stdout.split())  # lines break between words
    assert BEGINNING in said and END in said and "\x1b" not in said
    assert "\x1b" not in (tmp_path / "results" / "c" / "report.html").read_text()


def test_texts_of_files_do_nothing_to_a_terminal(tmp_path):
    (tmp_path / "f.toml").write_text('[[fault]]\nid = "F"\ntarget = "lag\\u001b[2J.y\\n"\ntype = "bias"\nvalue = 1\n')
    result = CliRunner().invoke(main, ["run", str(systems.tracker()), "--faults", str(tmp_path / "f.toml")])
    assert result.exit_code == 2 and r"there is no component 'lag\x1b[2J'" in result.stderr
    assert result.stderr.count("\n") == 1 and "\x1b" not in result.stderr
    (tmp_path / "r.csv").write_text('time,"a\x1b[2J\nb"\n0,1\n1,2\n')
    result = CliRunner().invoke(main, ["plot", str(tmp_path / "r.csv")])
    assert result.exit_code == 0 and r"a\x1b[2J b" in result.stdout and "\x1b" not in result.stdout
    (tmp_path / "r.parquet").write_bytes(b"PAR1\n\x1b[2J\n" * 9 + b"PAR1")
    result = CliRunner().invoke(main, ["plot", str(tmp_path / "r.parquet")])
    assert result.exit_code == 2 and result.stderr.count("\n") == 1 and "\x1b" not in result.stderr


def test_lines_of_a_compiler_stay_lines():
    assert str(NavfmuError("it failed:\x1b", "a.c:1: error\nmore")) == "it failed:\\x1b\na.c:1: error\nmore"
