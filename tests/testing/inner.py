"""A pytest in another process, in a folder with systems and one test file."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from textwrap import dedent

from tests.campaign.wreck import wreck
from tests.components import systems
from tests.foreign import stepper

ROOT = Path(__file__).parents[2]


@dataclass
class Ended:
    """How it ended."""

    code: int
    out: str

    @property
    def counts(self) -> dict[str, int]:
        """From its last line, without warnings: {"failed": 2, "passed": 1}."""
        last = re.findall(r"^=+ .* in [\d.]+s.*$", self.out, re.M)[-1]
        return {what: int(count) for count, what in re.findall(r"(\d+) (failed|passed|errors?|x\w+)", last)}

    def of(self, test: str) -> str:
        """What is told of one failed test."""
        heading = re.search(rf"^_+ (?:ERROR at \w+ of )?{re.escape(test)} _+$", self.out, re.M)
        assert heading, f"nothing is told of {test}:\n{self.out}"
        rest = self.out[heading.end() :]
        return re.split(r"^(?:_+ .* _+|=+ .* =+)$", rest, maxsplit=1, flags=re.M)[0]

    def row(self, test: str, word: str) -> str:
        """A line of the section that the plugin adds: "plot", "repeat" ..."""
        section = self.of(test).split(" navfmu -")[1]
        (found,) = re.findall(rf"^{word} +(.*)$", section, re.M)
        return found


class Folder:
    """A folder with tracker.ssp, probe.fmu, stepper.fmu and tests."""

    def __init__(self, path: Path) -> None:
        self.path = path
        path.mkdir()
        shutil.copy(systems.tracker(), path)
        wreck(path)
        stepper.write(path / "stepper.fmu")

    def pytest(self, text: str, *options: str, name: str = "test_it.py", cwd: Path | None = None) -> Ended:
        """Run pytest on a file with this text, with the plugin and xdist and no other."""
        file = self.path / name
        file.write_text(dedent(text))
        environment = {
            k: v for k, v in os.environ.items() if not k.startswith("PYTEST") and k not in ("CI", "BUILD_NUMBER")
        }
        environment |= {"PYTHONPATH": str(ROOT), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "COLUMNS": "80"}
        plugins = ("-p", "navfmu.testing.plugin", "-p", "no:cacheprovider")
        command = [sys.executable, "-m", "pytest", *plugins, f"--basetemp={self.path / 'temporary'}", *options]
        done = subprocess.run(
            [*command, str(file)], cwd=cwd or self.path, env=environment, capture_output=True, text=True, timeout=300
        )
        return Ended(done.returncode, done.stdout + done.stderr)
