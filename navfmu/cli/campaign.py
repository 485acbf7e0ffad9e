"""``navfmu campaign``: variants x cases x seeds against requirements."""

from __future__ import annotations

import sys

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
    workers: str,
) -> None:
    """Run the campaign of FILE.toml: variants x cases x seeds against requirements. Finished runs are kept."""
    from navfmu.campaign import load_campaign, run_campaign
    from navfmu.campaign.show import show
    from navfmu.system.results_folder import check_results
    from navfmu.terminal.progress import Progress

    folder = None if out is None else check_results(out, "a campaign")
    plan = load_campaign(file, seeds, strict=strict)
    folder = folder or check_results(f"results/{plan.name}", "a campaign")
    with Progress(plan.name) as progress:
        outcome = run_campaign(
            plan, folder, jobs, progress, workers=workers, timeout=timeout, retry_failed=retry_failed
        )
    show(outcome)
    if strict and not outcome.passed:
        sys.exit(1)
