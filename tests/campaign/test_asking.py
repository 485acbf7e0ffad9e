"""Before many runs a campaign asks, where somebody can answer."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from navfmu.campaign import load_campaign
from navfmu.cli.main import main
from navfmu.errors import NavfmuError
from tests.campaign.axes import CASES, HEAD, loaded, written

AXIS = '\n[[axis]]\nvary = "parameter.lag.tau"\nlow = 1.0\nhigh = 2.0\ncount = {count}\n'


def called(file: Path, *more: str):
    return CliRunner().invoke(main, ["campaign", str(file), "--out", str(file.parent / "out"), *more])


def test_without_a_terminal_many_runs_are_an_error_that_names_the_way(tmp_path):
    file = written(tmp_path, CASES + AXIS.format(count=334))
    result = called(file)
    assert result.exit_code == 2 and not (tmp_path / "out").exists()
    assert result.stderr == f"navfmu: {file}: has 1002 runs, more than 1000; --yes flies them\n"


@pytest.mark.parametrize("more", [["--yes", "--ask-above", "5"], ["--ask-above", "6"]])
def test_yes_and_another_number_fly_them(tmp_path, more):
    file = written(tmp_path, CASES + AXIS.format(count=2))
    result = called(file, "--workers", "thread", *more)
    assert result.exit_code == 0 and "6 runs of 2 s" in result.output
    refused = called(file, "--ask-above", "5")
    assert refused.exit_code == 2 and "has 6 runs, more than 5; --yes" in refused.stderr


@pytest.mark.skipif(os.name == "nt", reason="terminals of Unix")
@pytest.mark.parametrize(("answer", "code", "said"), [("y\n", 0, "report: "), ("\n", 2, "nothing was flown"),
                                                      ("\x03", 130, "interrupted")])  # fmt: skip
def test_on_a_terminal_it_asks(tmp_path, answer, code, said):
    import pty

    file = written(tmp_path, CASES)
    words = [sys.executable, "-m", "navfmu", "campaign", str(file), "--out", str(tmp_path / "out"), "--ask-above", "2"]
    process, terminal = pty.fork()
    if process == 0:
        os.execv(sys.executable, words)
    seen = b""
    try:
        while b"[y/N]" not in seen:
            seen += os.read(terminal, 4096)
        assert not (tmp_path / "out").exists()
        os.write(terminal, answer.encode())
        while True:
            seen += os.read(terminal, 4096)
    except OSError:  # the process has closed the terminal
        pass
    ended = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
    text = " ".join(seen.decode().split())
    assert "has 3 runs, more than 2. Fly them? [y/N]" in text and said in text and ended == code, text
    assert (tmp_path / "out").exists() == (code == 0)


def test_searches_count_at_their_longest(tmp_path):
    text = 'seeds = "1-3"\n' + CASES + '\n[[axis]]\nvary = "fault.D.rate"\nlow = 0.0\nhigh = 8.0\nsearch = "R"\n'
    text += 'tolerance = 1.0\n\n[[requirement]]\nid = "R"\nsignal = "lag.y"\nat_most = 100.0\n'
    said = []
    campaign = loaded(tmp_path, text, allow=said.append)
    assert said == [campaign.size] == [3 * (1 + 2 * (2 + 3))]  # nominal, and 8 m halved three times in two cases


def test_too_many_runs_are_told_at_once(tmp_path):
    """They are counted, not made."""
    text = CASES + "".join(
        f'\n[[axis]]\nvary = "parameter.{name}"\nlow = 1.0\nhigh = 2.0\ncount = 1_000_000\n'
        for name in ("lag.tau", "truth.amplitude", "truth.time_constant")
    )
    begun = time.monotonic()
    with pytest.raises(NavfmuError, match=r"has 3 000 000 000 000 000 000 runs, more than 1 000 000"):
        loaded(tmp_path, text)
    assert time.monotonic() - begun < 5.0
    faults = "".join(f'[[fault]]\nid = "F{k}"\ntarget = "lag.y"\ntype = "bias"\nvalue = {k}\n' for k in range(1, 1500))
    file = written(tmp_path, '\n[[case]]\nname = "c"\npairs = "many.toml"\n', HEAD)
    (tmp_path / "many.toml").write_text(faults)
    with pytest.raises(NavfmuError, match=r"line 7: 'pairs' makes 1 122 751 pairs of 1 499 faults, more than"):
        load_campaign(file)


def test_help_names_the_number(tmp_path):
    done = subprocess.run([sys.executable, "-m", "navfmu", "campaign", "--help"], capture_output=True, text=True)
    assert "--ask-above" in done.stdout and "1000" in done.stdout and "--junit" in done.stdout
