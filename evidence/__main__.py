"""``python -m evidence [NAME ...] --out DIR``: do the long runs and write one report."""

from __future__ import annotations

import importlib
import sys
import time
from pathlib import Path

import click

from navfmu.errors import NavfmuError, nearest
from navfmu.files.writing import write_file
from navfmu.report.page import Page
from navfmu.system.result import check_folder

SECTIONS = ("headline", "step_sizes", "closure", "real_flights", "speed")


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--out", default="results/evidence", show_default=True, help="Folder of runs and report.")
def main(names: tuple[str, ...], out: str) -> None:
    """Show what the project claims: headline, step_sizes, closure, real_flights, speed; all, or those NAMEd."""
    folder = Path(out)
    page = Page("navfmu: evidence", "What the project claims, measured by the long runs of this repository.")
    try:
        check_folder(folder)
        for name in names:
            if name not in SECTIONS:
                raise NavfmuError(f"there is no section '{name}'{nearest(name, SECTIONS)} ({', '.join(SECTIONS)})")
        for name in names or SECTIONS:
            began = time.monotonic()
            importlib.import_module(f"evidence.{name}").run(folder, page)
            click.echo(f"{name}: {time.monotonic() - began:.0f} s")
        report = write_file(folder / "evidence.html", page.html().encode())
    except NavfmuError as error:
        click.echo(f"evidence: {error}", err=True)
        sys.exit(2)
    click.echo(f"report: {report}")


if __name__ == "__main__":
    main(prog_name="python -m evidence")
