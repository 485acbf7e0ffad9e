"""``navfmu sabotage``: a system with its faults built in, for other masters."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from navfmu.cli.options import load, system_options, tell

if TYPE_CHECKING:
    from navfmu.sabotage.system import Sabotaged


@click.command("sabotage")
@system_options
@click.argument("faults_", metavar="[FAULTS]...", nargs=-1)
@click.option("--step", metavar="TIME", help="Communication step size of the master that will run it.")
@click.option("--out", required=True, metavar="FILE", help="The .ssp to write.")
@click.option("--direct", is_flag=True, help="For masters that pass values on within a communication point.")
@click.option("--platforms", default="host", show_default=True, help="host, all, or names with commas.")
def command(
    system: str, faults_: tuple[str, ...], out: str, platforms: str, direct: bool, expect: str | None, **given: Any
) -> None:
    """Build faults into a system, for masters that know no faults.

    SYSTEM is an .ssp, an .ssd, a folder, an .fmu, or a shipped system by its name; FAULTS are fault files (TOML), or
    names of those inside the system. The package that is written has FMUs, saboteurs, inserted in the connections on
    which the faults act. Inputs that nothing else drives are driven by one. It needs the extra 'build' of navfmu.
    """
    from navfmu.sabotage.system import sabotage
    from navfmu.system.result import check_file
    from navfmu.terminal.progress import Progress

    file = check_file(out, ".ssp")
    loaded, given = load(system, given | {"signals": (), "faults": (*faults_, *given["faults"])})
    experiment = loaded.experiment(**given)
    if expect is not None:
        experiment.expect(expect)
    with Progress("building saboteurs") as progress:
        written = sabotage(experiment, file, platforms.split(","), direct, progress)
    tell(written.notes)
    _print(written, out)


def _print(written: Sabotaged, out: str) -> None:
    from rich.text import Text

    from navfmu.fmi.names import folded
    from navfmu.terminal.console import console
    from navfmu.terminal.table import Column, Kind, Table

    screen = console()
    columns = [Column("saboteur", Kind.NAME), Column("faults", Kind.WORD), Column("passes on", Kind.NAME)]
    rows = [[one.name, ", ".join(one.faults), ", ".join(folded(one.outputs.values()))] for one in written.saboteurs]
    screen.print(Table(columns, rows))
    screen.print(Text(f"wrote {out}"), soft_wrap=True)
