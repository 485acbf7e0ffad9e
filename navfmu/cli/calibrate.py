"""``navfmu calibrate``: errors of a sensor from a recording, a command for each kind of sensor."""

from __future__ import annotations

import click

from navfmu.cli.group import Group

LINES = {
    "navfmu.cli.calibrate_delay": "How late velocities of a GPS receiver are, by an inertial unit.",
    "navfmu.cli.calibrate_gain": "The gain that three accelerometers have in common, at rest.",
    "navfmu.cli.calibrate_imu": "Errors of an inertial unit, from stands in several attitudes and turns.",
    "navfmu.cli.calibrate_magnetometer": "Hard iron, gains and soft iron of a triad that was turned.",
}
COMMANDS = {module.rpartition("_")[2]: (module, line) for module, line in LINES.items()}
"""A command has the name of its module."""


class _Commands(Group):
    modules = COMMANDS


@click.group("calibrate", cls=_Commands)
def command() -> None:
    """Find the errors of a sensor in a recording, for tables and for parameter sets."""
