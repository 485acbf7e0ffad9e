"""The command line. Every command imports what it needs when it runs, so that ``--help`` answers at once."""

from __future__ import annotations

import importlib
import re
import sys
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

import click

from navfmu import __version__
from navfmu.errors import NavfmuError

if TYPE_CHECKING:
    from navfmu.system.system import System

LAZY = {  # command -> module and attribute, and its line in the list of commands
    "track": ("navfmu.cli.track", "command", "Make an FMU from a recorded track."),
}


class _Commands(click.Group):
    """Commands; a problem that the user can mend is one sentence and exit code 2."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return sorted([*super().list_commands(ctx), *LAZY])

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name in LAZY:
            module, attribute, _ = LAZY[name]
            return getattr(importlib.import_module(module), attribute)
        return super().get_command(ctx, name)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        rows = []
        for name in self.list_commands(ctx):
            line = LAZY[name][2] if name in LAZY else super().get_command(ctx, name).get_short_help_str(100)
            rows.append((name, line))
        with formatter.section("Commands"):
            formatter.write_dl(rows)

    def resolve_command(self, ctx: click.Context, args: list[str]) -> tuple[Any, Any, list[str]]:
        if args and args[0] not in self.list_commands(ctx) and not args[0].startswith("-"):
            from navfmu.errors import nearest

            raise click.UsageError(f"there is no command '{args[0]}'{nearest(args[0], self.list_commands(ctx))}", ctx)
        return super().resolve_command(ctx, args)

    def main(self, *args: Any, **kwargs: Any) -> Any:
        try:
            return super().main(*args, **kwargs)
        except NavfmuError as error:
            click.echo(f"navfmu: {error}", err=True)
            sys.exit(error.exit_code)
        except BrokenPipeError:  # the reader of our output went away, as "head" does
            sys.stderr.close()
            sys.exit(1)


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="navfmu", message="%(prog)s %(version)s")
def main() -> None:
    """Run systems of navigation components (FMUs), sweep their step size, and inject failures."""


def _system_options(command: Callable) -> Callable:
    """Options that say which system is run and how; shared by ``run`` and ``sweep``."""
    options = [
        click.argument("system"),
        click.option("--variant", metavar="V", help="A sibling of the main system."),
        click.option("--set", "assignments", multiple=True, metavar="COMPONENT.PARAMETER=VALUE",
                     help="Change a parameter; a unit may follow the value: 'imu.gyro_drift_sigma=1 deg/h'."),
        click.option("--faults", multiple=True, metavar="FILE",
                     help="Fault file (TOML), or the name of one inside the system; may be repeated."),
        click.option("--fault", "entries", multiple=True, metavar="ENTRIES",
                     help="One fault: 'id = \"F1\", target = \"gps.jammed\", type = \"input\", start = 300'."),
        click.option("--stop", type=float, metavar="S", help="End of the run, s."),
        click.option("--seed", type=int, metavar="N", help="Seed of every component with noise, and of the faults."),
    ]  # fmt: skip
    for option in reversed(options):
        command = option(command)
    return command


@main.command()
@click.argument("file")
@click.option("--variant", metavar="V", help="A sibling of the main system.")
def info(file: str, variant: str | None) -> None:
    """Show what an FMU or a system consists of."""
    from navfmu.cli.info import show

    show(file, variant)


def _loaded(system: str, given: dict[str, Any]) -> tuple[System, dict[str, Any]]:
    """The system, and the arguments of an experiment, from the options that ``run`` and ``sweep`` share."""
    from navfmu.faults import parse_fault
    from navfmu.system.system import System

    loaded = System.load(system, given.pop("variant"))
    inline = [parse_fault(text, "--fault") for text in given.pop("entries")]
    given["faults"] = [*given["faults"], *inline]
    given["parameters"] = _assignments(given.pop("assignments"))
    given["record"] = _names(given.pop("signals")) or None
    return loaded, given


@main.command()
@_system_options
@click.option("--step", type=float, metavar="S", help="Communication step size, s.")
@click.option("--algorithm", default="gauss_seidel", show_default=True, metavar="A", help="gauss_seidel or jacobi.")
@click.option("--engine", default="compiled", show_default=True, metavar="E", help="compiled or reference.")
@click.option("--record", "signals", multiple=True, metavar="SIGNAL",
              help="Signal, array, bundle or pattern to record; may be repeated or a list with commas.")  # fmt: skip
@click.option("--record-period", type=float, metavar="S", help="Time between recorded values, s.")
@click.option("--out", metavar="FILE", help="Write the recording to FILE.parquet or FILE.csv.")
def run(system: str, out: str | None, **given: Any) -> None:
    """Run SYSTEM: an .ssp, an .ssd, a folder, an .fmu, or a shipped system by its name."""
    from navfmu.system import result
    from navfmu.terminal.progress import Progress

    if out is not None:
        result.check_target(out)
    loaded, given = _loaded(system, given)
    with Progress(loaded.name) as progress:
        frame = loaded.experiment(**given).run(progress)
    _warn(frame.attrs["notes"])
    if out is not None:
        result.write(frame, out)
    from navfmu.cli.info import summarise

    summarise(frame, out)


@main.command()
@_system_options
@click.option("--steps", required=True, metavar="A,B,C", help="Communication step sizes to compare, s.")
@click.option("--signals", multiple=True, metavar="SIGNAL", help="Signals to compare; default: those of a run.")
@click.option("--tolerance", default=1.0, show_default=True, metavar="PERCENT",
              help="Error that the recommended step may cause, in percent of a signal's range.")  # fmt: skip
@click.option("--jobs", type=click.IntRange(min=1), metavar="N", help="Runs at the same time; default: one per core.")
@click.option("--out", metavar="DIR", help="Write table, picture and report into this folder.")
def sweep(system: str, steps: str, tolerance: float, jobs: int | None, out: str | None, **given: Any) -> None:
    """Run SYSTEM at several step sizes with both algorithms and the same noise, and compare."""
    from navfmu.sweep.report import write_report
    from navfmu.sweep.sweep import show, sweep
    from navfmu.system.result import check_folder
    from navfmu.terminal.progress import Progress

    if out is not None:
        check_folder(out)
    numbers = _numbers(steps, "--steps")
    loaded, given = _loaded(system, given)
    experiment = loaded.experiment(step=min(numbers), **given)
    with Progress(f"{loaded.name}, step sizes") as progress:
        result = sweep(experiment, numbers, tolerance / 100.0, jobs, progress)
    _warn(result.notes)
    report = None if out is None else write_report(result, out)
    show(result, report)


@main.command()
@click.argument("file")
@click.option("--jobs", type=click.IntRange(min=1), metavar="N", help="Runs at the same time; default: one per core.")
@click.option("--out", metavar="DIR", help="Folder of results and report; default: results/NAME.")
@click.option("--seeds", metavar="1-8", help="Use these seeds instead of those in the file.")
@click.option("--strict", is_flag=True, help="Exit with code 1 when a requirement is violated.")
def campaign(file: str, jobs: int | None, out: str | None, seeds: str | None, strict: bool) -> None:
    """Run the campaign of FILE.toml: variants x faults x seeds against requirements. Finished runs are kept."""
    from navfmu.campaign import load_campaign, run_campaign
    from navfmu.campaign.show import show
    from navfmu.system.result import check_folder
    from navfmu.terminal.progress import Progress

    plan = load_campaign(file, seeds)
    folder = check_folder(out if out is not None else f"results/{plan.name}")
    with Progress(plan.name) as progress:
        outcome = run_campaign(plan, folder, jobs, progress)
    show(outcome)
    if strict and not outcome.passed:
        sys.exit(1)


def _names(signals: Iterable[str]) -> list[str]:
    """Names from repeated options and lists with commas; the comma in ``C[1,2]`` does not separate."""
    return [name.strip() for text in signals for name in re.split(r",(?![^\[]*\])", text) if name.strip()]


def _numbers(text: str, option: str) -> list[float]:
    values = []
    for part in text.split(","):
        try:
            values.append(float(part))
        except ValueError:
            raise NavfmuError(
                f"{option}: '{part.strip()}' is not a number; expected, for example, 0.01,0.1,1"
            ) from None
    return values


def _assignments(texts: Iterable[str]) -> dict[str, str]:
    parameters = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or "." not in name or not value.strip():
            raise NavfmuError(f"--set '{text}': expected component.parameter=value")
        if name.strip() in parameters:
            raise NavfmuError(f"--set '{text}': '{name.strip()}' is set twice")
        parameters[name.strip()] = value.strip()
    return parameters


def _warn(notes: Iterable[str]) -> None:
    for note in notes:
        click.echo(f"note: {note}", err=True)


if __name__ == "__main__":
    main()
