"""``navfmu sweep``: the same experiment at several step sizes."""

from __future__ import annotations

from typing import Any

import click

from navfmu.cli.options import load, numbers, system_options, tell


@click.command("sweep")
@system_options
@click.option("--steps", required=True, metavar="A,B,C", help="Communication step sizes to compare, s.")
@click.option("--signals", multiple=True, metavar="SIGNAL", help="Signals to compare; default: those of a run.")
@click.option("--tolerance", default=1.0, show_default=True, metavar="PERCENT",
              help="Error that the recommended step may cause, in percent of a signal's range.")  # fmt: skip
@click.option("--jobs", type=click.IntRange(min=1), metavar="N", help="Runs at the same time; default: one per core.")
@click.option("--out", metavar="DIR", help="Write table, picture and report into this folder.")
def command(
    system: str, steps: str, tolerance: float, jobs: int | None, out: str | None, expect: str | None, **given: Any
) -> None:
    """Run SYSTEM at several step sizes with both algorithms and the same noise, and compare."""
    from navfmu.sweep.report import FILES, write_report
    from navfmu.sweep.show import show
    from navfmu.sweep.sweep import sweep
    from navfmu.system.results_folder import check_results
    from navfmu.terminal.progress import Progress

    folder = None if out is None else check_results(out, "a sweep", *FILES)
    sizes = numbers(steps, "--steps")
    loaded, given = load(system, given)
    experiment = loaded.experiment(step=min(sizes), **given)
    if expect is not None:
        experiment.expect(expect)
    with Progress(f"{loaded.name}, step sizes") as progress:
        result = sweep(experiment, sizes, tolerance / 100.0, jobs, progress)
    tell(result.notes)
    report = None if folder is None else write_report(result, folder)
    show(result, report)
