"""``navfmu analyse``: a command for each analysis."""

from __future__ import annotations

import click

from navfmu.cli.group import Group

LINES = {
    "navfmu.cli.analyse_budget": "Errors, or what is claimed, by their sources.",
    "navfmu.cli.analyse_covariance": "What a navigator claims, beside the errors of many runs.",
    "navfmu.cli.analyse_fix": "How well distances and bearings fix a position.",
    "navfmu.cli.analyse_observability": "Which errors distances along a track tell.",
    "navfmu.cli.analyse_sensitivity": "What each parameter that makes errors does, per unit.",
}
COMMANDS = {module.rpartition("_")[2]: (module, line) for module, line in LINES.items()}
"""A command has the name of its module."""


class _Commands(Group):
    modules = COMMANDS


@click.group("analyse", cls=_Commands)
def command() -> None:
    """Say how good a navigator is, and why it is no better."""
