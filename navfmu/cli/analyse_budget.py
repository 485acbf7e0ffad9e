"""``navfmu analyse budget``: errors, or claims, by their sources."""

from __future__ import annotations

from typing import Any

import click

from navfmu.cli.analysing import analyse, analysis_options


@click.command("budget")
@analysis_options
@click.option("--of", "kind", default="errors", show_default=True, metavar="KIND",
              help="errors (of sensors, in runs with each seed) or claims (of the estimator, in one run).")  # fmt: skip
def command(system: str, kind: str, **given: Any) -> None:
    """Run SYSTEM with each source of errors alone, and with all but each: which of them makes the error?

    \b
    navfmu analyse budget backup_navigator --faults gps_lost --seeds 1-20 --from 300 --out DIR
    navfmu analyse budget backup_navigator --variant open_loop --of claims --faults gps_lost --from 300
    """
    from navfmu.analysis.budget import budget, finding

    analyse("budget", system, given, lambda experiment, *asked: finding(budget(experiment, kind, *asked)))
