"""``python -m evidence [NAME ...] --out DIR``: do the long runs and write one report."""

from __future__ import annotations

import importlib
import sys
import time
from collections.abc import Mapping
from pathlib import Path

import click

from evidence.section import Section
from navfmu.errors import NavfmuError, nearest
from navfmu.files.writing import write_file
from navfmu.report.page import Page
from navfmu.system.result import check_folder
from navfmu.terminal import interrupt, refusal

SECTIONS = (
    "headline",
    "fmea",
    "step_sizes",
    "closure",
    "real_flights",
    "jammed_flights",
    "flown_navigation",
    "navigators",
    "inertial_navigation",
    "reference_trajectory",
    "sensors",
    "jsbsim",
    "expressions",
    "figures",
    "public_fmus",
    "speed",
)


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--out", default="results/evidence", show_default=True, help="Folder of runs and report.")
def main(names: tuple[str, ...], out: str) -> None:
    """Show what the project claims: all of it, or the sections NAMEd.

    There are headline, fmea, step_sizes, closure, real_flights, jammed_flights, flown_navigation, navigators,
    inertial_navigation, reference_trajectory, sensors, jsbsim, expressions, figures, public_fmus and speed.
    The exit code is 1 when a claim is missed.
    """
    folder = Path(out)
    with refusal.as_a_sentence("evidence"), interrupt.as_a_sentence():
        check_folder(folder)
        for name in names:
            if name not in SECTIONS:
                raise NavfmuError(f"there is no section '{name}'{nearest(name, SECTIONS)} ({', '.join(SECTIONS)})")
        sections = {}
        for name in names or SECTIONS:
            began = time.monotonic()
            sections[name] = importlib.import_module(f"evidence.{name}").run(folder)
            click.echo(f"{name}: {time.monotonic() - began:.0f} s")
        report = write_file(folder / "evidence.html", page(sections).html().encode())
    show(sections)
    click.echo(f"report: {report}")
    if not all(claim.holds for section in sections.values() for claim in section.claims):
        sys.exit(1)


def page(sections: Mapping[str, Section]) -> Page:
    """The claims, then the sections."""
    made = Page("navfmu: evidence", "What the project claims, measured by the long runs of this repository.")
    made.heading("Claims")
    made.text(summary(sections))
    claims = [claim for section in sections.values() for claim in section.claims]
    if claims:
        made.table(
            ["claim", "measured", "bound", "verdict"],
            [[claim.text, claim.finding, claim.limit, claim.verdict] for claim in claims],
            lambda row, column: None if column < 3 else "good" if claims[row].holds else "bad",
        )
    for section in sections.values():
        section.write(made)
    return made


def summary(sections: Mapping[str, Section]) -> str:
    """How many claims hold, and what was not measured."""
    claims = [claim for section in sections.values() for claim in section.claims]
    held = sum(claim.holds for claim in claims)
    text = f"{held} of {len(claims)} claims hold" + (f", {len(claims) - held} MISSED." if held < len(claims) else ".")
    for name, section in sections.items():
        if section.left_out:
            text += f" Not measured: {name}, because {section.left_out}."
    return text


def show(sections: Mapping[str, Section]) -> None:
    """The claims in the terminal, and what was not measured."""
    from rich.text import Text

    from navfmu.terminal.console import console, say
    from navfmu.terminal.table import Column, Kind, Table

    out = console()
    columns = [Column("verdict", Kind.WORD), Column("measured"), Column("bound"), Column("claim", Kind.SENTENCE)]
    rows = [
        [Text(c.verdict, style="green" if c.holds else "red"), c.finding, c.limit, c.text]
        for section in sections.values()
        for c in section.claims
    ]
    if rows:
        out.print(Table(columns, rows))
    say(out, summary(sections))


if __name__ == "__main__":
    main(prog_name="python -m evidence")
