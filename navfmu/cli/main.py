"""The command line. Every command stands in a file of its own and is imported when it runs, so that help is quick."""

from __future__ import annotations

from typing import Any

import click

from navfmu import __version__
from navfmu.cli.group import Group
from navfmu.terminal import interrupt, refusal

COMMANDS = {  # command -> module, and its line in the list of commands
    "allan": ("navfmu.cli.allan", "Tell the errors of an inertial unit at rest apart."),
    "analyse": ("navfmu.cli.analyse", "Say how good a navigator is, and why it is no better."),
    "cache": ("navfmu.cli.cache", "Show or empty the folder of what is kept to be quick."),
    "calibrate": ("navfmu.cli.calibrate", "Find the errors of a sensor in a recording."),
    "campaign": ("navfmu.cli.campaign", "Run variants x cases x seeds against requirements."),
    "coverage": ("navfmu.cli.coverage", "Show how many stations are heard, and how they cross."),
    "faults": ("navfmu.cli.faults", "Show what in a system can fail, and how."),
    "figures": ("navfmu.cli.figures", "Find the figures of a source again, and say where they differ."),
    "info": ("navfmu.cli.info", "Show what an FMU or a system consists of."),
    "new": ("navfmu.cli.new", "Write a component of your own to start from."),
    "orbits": ("navfmu.cli.orbits", "Make a table of orbits of satellites from RINEX, YUMA or SEM files."),
    "plot": ("navfmu.cli.plot", "Draw signals of a recording."),
    "replay": ("navfmu.cli.replay", "Make an FMU from recorded samples of a sensor."),
    "run": ("navfmu.cli.run", "Run a system once."),
    "sabotage": ("navfmu.cli.sabotage", "Build faults into a system, for masters that know no faults."),
    "schema": ("navfmu.cli.schema", "Print the JSON schema of a campaign, fault or report file, for editors."),
    "stations": ("navfmu.cli.stations", "Choose stations of a navaid file for an FMU."),
    "sweep": ("navfmu.cli.sweep", "Run a system at several step sizes, and compare."),
    "table": ("navfmu.cli.table", "Show and replace the tables that an FMU carries."),
    "track": ("navfmu.cli.track", "Make an FMU from a recorded track."),
}


class _Commands(Group):
    """Commands; a problem that the user can mend is one sentence and exit code 2."""

    modules = COMMANDS

    def invoke(self, ctx: click.Context) -> Any:
        with interrupt.as_a_sentence():
            return super().invoke(ctx)

    def main(self, *args: Any, **kwargs: Any) -> Any:
        with refusal.as_a_sentence("navfmu"):
            return super().main(*args, **kwargs)


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="navfmu", message="%(prog)s %(version)s")
def main() -> None:
    """Run systems of navigation components (FMUs), sweep their step size, and inject failures."""
