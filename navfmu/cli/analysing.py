"""What the commands of ``navfmu analyse`` that run a system have in common."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from navfmu.cli.options import load, system_options, tell

if TYPE_CHECKING:
    from navfmu.analysis.finding import Finding


def analysis_options(command: Callable) -> Callable:
    """Options that say which system is analysed, over which runs and when, and where the answer goes."""
    options = [
        click.option("--step", metavar="TIME", help="Communication step; default: the system's."),
        click.option("--seeds", default="1", show_default=True, metavar="LIST", help="A run for each, as 1-40."),
        click.option("--from", "start", metavar="TIME", help="Points count from here on: seconds, or '5 min'."),
        click.option("--until", "end", metavar="TIME", help="Points count up to here."),
        click.option("--jobs", type=click.IntRange(min=1), metavar="N", help="Runs at a time; default: one per core."),
        click.option("--out", metavar="DIR", help="Write table, numbers, picture and report into this folder."),
    ]
    for option in reversed(options):
        command = option(command)
    return system_options(command)


def analyse(what: str, system: str, given: dict[str, Any], work: Callable[..., Finding]) -> None:
    """Do the ``work`` with an experiment, seeds, window, jobs and progress, and tell what it has found."""
    from navfmu.analysis.ensemble import Window
    from navfmu.analysis.finding import check, show, write
    from navfmu.campaign.seeds import parse_seeds
    from navfmu.errors import NavfmuError
    from navfmu.fmi.seconds import seconds
    from navfmu.terminal.progress import Progress

    out, jobs, expect = given.pop("out"), given.pop("jobs"), given.pop("expect")
    folder = check(out)
    if given["seed"] is not None:
        raise NavfmuError("--seed: an analysis has a run for each of its seeds; give them with --seeds")
    seeds = parse_seeds(given.pop("seeds"), lambda sentence: NavfmuError(f"--seeds: {sentence}"))
    start, end = given.pop("start"), given.pop("end")
    window = Window(
        0.0 if start is None else seconds(start, "--from"), float("inf") if end is None else seconds(end, "--until")
    )
    loaded, given = load(system, given | {"signals": ()})
    experiment = loaded.experiment(**given)
    if expect is not None:
        experiment.expect(expect)
    tell(experiment.notes)
    with Progress(f"{loaded.name}, {what}") as progress:
        found = work(experiment, seeds, window, jobs, progress)
    show(found, None if folder is None else write(found, folder))
