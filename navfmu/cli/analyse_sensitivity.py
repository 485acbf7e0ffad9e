"""``navfmu analyse sensitivity``: the response of the error to each parameter that makes errors."""

from __future__ import annotations

from typing import Any

import click

from navfmu.cli.analysing import analyse, analysis_options


@click.command("sensitivity")
@analysis_options
def command(system: str, **given: Any) -> None:
    """Run SYSTEM with each parameter of errors alone, whole and half: what does it do to the error, per unit?

    \b
    navfmu analyse sensitivity backup_navigator --faults gps_lost --seeds 1-10 --from 300 --out DIR
    """
    from navfmu.analysis.sensitivity import finding, sensitivity

    analyse("sensitivity", system, given, lambda *asked: finding(sensitivity(*asked)))
