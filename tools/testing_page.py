"""Write what a failed test looks like into ``docs/testing.md``, and its plot: ``python -m tools.testing_page``."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import textwrap
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parent.parent
PAGE, PICTURE = ROOT / "docs" / "testing.md", ROOT / "docs" / "testing.png"
COMMAND = ("pytest", "-q", "test_outage.py")
WRITTEN = re.compile(r"(<!-- written by .* -->\n```\n)(.*?)(```\n)", re.DOTALL)
WIDTH = 116  # columns; longer lines are broken between words
PLAIN = {  # what differs from machine to machine, and what stands for it
    r"\S+/navfmu/test_outage\.py/": "/tmp/pytest-of-you/pytest-0/navfmu/test_outage.py/",
    r"navfmu run ('[^']*'|\S+)": "navfmu run .venv/lib/python3.12/site-packages/navfmu/shipped/backup_navigator.ssp",
    r"--expect \S+": "--expect 3c47b1e95a20",
    r"in \d+\.\d+s": "in 3.14s",
}


@dataclass(frozen=True)
class Shown:
    """What the page shows: the output, and the plot of the test that failed."""

    text: str
    plot: bytes


def run(folder: Path) -> Shown:
    """Run the page's first example in a folder; a system of that name in it takes the place of the shipped one."""
    example = re.search(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)[1]
    (folder / "test_outage.py").write_text(example, encoding="utf-8")
    environment = {
        k: v for k, v in os.environ.items() if not k.startswith("PYTEST") and k not in ("CI", "BUILD_NUMBER")
    }
    environment |= {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "PYTHONPATH": str(ROOT), "COLUMNS": "80"}
    plugin = ("-p", "navfmu.testing.plugin", "-p", "no:cacheprovider", "--basetemp", str(folder / "kept"))
    done = subprocess.run(
        [sys.executable, "-m", *COMMAND, *plugin], cwd=folder, env=environment, capture_output=True, text=True
    )
    plots = sorted((folder / "kept").rglob("plot.png"))
    if done.returncode != 1 or len(plots) != 1:
        raise SystemExit(f"expected one failed test:\n{done.stdout}{done.stderr}")
    text = done.stdout
    for pattern, plain in PLAIN.items():
        text = re.sub(pattern, plain, text)
    lines = [f"$ {' '.join(COMMAND)}", *text.rstrip().splitlines()]
    return Shown("".join(f"{broken}\n" for line in lines for broken in _broken(line.rstrip())), plots[0].read_bytes())


def _broken(line: str) -> list[str]:
    whole = {"break_long_words": False, "break_on_hyphens": False, "drop_whitespace": True}
    return textwrap.wrap(line, WIDTH, subsequent_indent=12 * " ", **whole) if len(line) > WIDTH else [line]


def shown() -> str:
    """What the page shows now."""
    return WRITTEN.search(PAGE.read_text(encoding="utf-8"))[2]


def main() -> None:
    """Write page and picture, with the built system of ``dist``."""
    with TemporaryDirectory(prefix="navfmu-page-") as folder:
        made = run(Path(folder))
    text = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(WRITTEN.sub(lambda found: found[1] + made.text + found[3], text), encoding="utf-8")
    PICTURE.write_bytes(made.plot)
    print(f"wrote {PAGE} and {PICTURE}")


if __name__ == "__main__":
    main()
