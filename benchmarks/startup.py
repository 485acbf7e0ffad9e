"""How long it takes until ``navfmu run --help`` has answered, beside a Python that does nothing.

Goal: under 0.3 s.
"""

from __future__ import annotations

import subprocess
import sys
import time

from benchmarks.contest import Contest, compete, main

COMMANDS = {
    "python -c pass": [sys.executable, "-c", "pass"],
    "navfmu run --help": [sys.executable, "-m", "navfmu", "run", "--help"],
}


def _timed(command: list[str]) -> float:
    before = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - before


def run(rounds: int = 7) -> list[Contest]:
    contenders = {name: (lambda c=command: _timed(c)) for name, command in COMMANDS.items()}
    contest = compete("start-up", "process", contenders, rounds, "Whole processes, files in memory.")
    seconds = contest.median("navfmu run --help")
    contest.claim("Start-up: navfmu run --help has answered", 0.3, seconds, at_least=False, unit="s")
    return [contest]


if __name__ == "__main__":
    main(run)
