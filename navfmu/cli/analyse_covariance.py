"""``navfmu analyse covariance``: what a navigator claims, beside the errors of many runs."""

from __future__ import annotations

from typing import Any

import click

from navfmu.cli.analysing import analyse, analysis_options


@click.command("covariance")
@analysis_options
def command(system: str, **given: Any) -> None:
    """Run SYSTEM with each seed, and compare its errors with the covariance that its navigator claims for them.

    From 10 seeds on it says whether the claim is consistent with the errors.

    \b
    navfmu analyse covariance backup_navigator --faults gps_lost --seeds 1-40 --from 300 --out DIR
    """
    from navfmu.analysis.covariance import covariance, finding

    analyse("covariance", system, given, lambda *asked: finding(covariance(*asked)))
