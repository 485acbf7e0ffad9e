"""``navfmu campaign``: variants x cases x seeds against requirements."""

from __future__ import annotations

import sys
from dataclasses import dataclass

import click


@click.command("campaign")
@click.argument("file")
@click.option("--jobs", type=click.IntRange(min=1), metavar="N", help="Runs at the same time; default: one per core.")
@click.option("--out", metavar="DIR", help="Folder of results and report; default: results/NAME.")
@click.option("--seeds", metavar="1-8", help="Use these seeds instead of those in the file.")
@click.option(
    "--strict",
    is_flag=True,
    help="Exit with code 1 unless every run ended well and every requirement holds, and "
    "refuse what is not as FMI and SSP have it, even if it is clear.",
)
@click.option("--timeout", type=float, metavar="S", help="A run that takes longer has failed, s.")
@click.option("--retry-failed", is_flag=True, help="Run those again that failed.")
@click.option("--yes", is_flag=True, help="Do not ask, however many runs there are.")
@click.option(
    "--ask-above",
    type=click.IntRange(min=0),
    default=1000,
    show_default=True,
    metavar="N",
    help="Ask before more runs than these.",
)
@click.option("--junit", metavar="FILE.xml", help="Write the verdicts as JUnit XML, for test servers.")
@click.option("--stmd", metavar="FILE.stmd",
              help="Write what was run, what came of it and the verdicts as SSP Traceability has it.")  # fmt: skip
@click.option("--workers", default="process", show_default=True, metavar="W",
              help="process: an FMU that crashes ends its own run only; thread: a little faster.")  # fmt: skip
def command(
    file: str,
    jobs: int | None,
    out: str | None,
    seeds: str | None,
    strict: bool,
    timeout: float | None,
    retry_failed: bool,
    yes: bool,
    ask_above: int,
    junit: str | None,
    stmd: str | None,
    workers: str,
) -> None:
    """Run the campaign of FILE.toml: variants x cases x seeds against requirements. Finished runs are kept."""
    from navfmu.campaign import load_campaign, run_campaign
    from navfmu.campaign.junit import write_junit
    from navfmu.campaign.show import show
    from navfmu.system.result import check_file
    from navfmu.system.results_folder import check_results
    from navfmu.terminal.progress import Progress

    folder = None if out is None else check_results(out, "a campaign")
    verdicts = None if junit is None else check_file(junit, ".xml")
    task = None if stmd is None else check_file(stmd, ".stmd")
    with Progress("checking") as progress:
        plan = load_campaign(
            file, seeds, strict=strict, allow=None if yes else Asking(file, ask_above), progress=progress
        )
    folder = folder or check_results(f"results/{plan.name}", "a campaign")
    with Progress(plan.name) as progress:
        outcome = run_campaign(
            plan, folder, jobs, progress, workers=workers, timeout=timeout, retry_failed=retry_failed
        )
    if verdicts is not None:
        write_junit(outcome, verdicts)
    if task is not None:
        from navfmu.campaign.traceability import write_task

        write_task(outcome, task)
    show(outcome)
    for what, written in (("verdicts as JUnit XML", verdicts), ("traceability", task)):
        if written is not None:
            click.echo(f"{what}: {written}")
    if strict and not outcome.passed:
        sys.exit(1)


@dataclass(frozen=True)
class Asking:
    """Asks before more than ``most`` runs; without a terminal nobody can answer."""

    file: str
    most: int

    def __call__(self, runs: int) -> None:
        """Raise what ends it unless the user wants so many."""
        from navfmu.errors import Interrupted, NavfmuError

        if runs <= self.most:
            return
        count = f"{self.file}: has {runs} runs, more than {self.most}"
        if not (sys.stdin.isatty() and sys.stderr.isatty()):
            raise NavfmuError(f"{count}; --yes flies them")
        try:
            wanted = click.confirm(f"{count}. Fly them?", err=True)
        except click.Abort:
            raise Interrupted("interrupted") from None
        if not wanted:
            raise NavfmuError(f"{count}; nothing was flown")
