"""``python -m navfmu.export [NAME ...]``: build the FMUs of a folder of components."""

from __future__ import annotations

import time
from pathlib import Path

import click

from navfmu.terminal import interrupt, refusal


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("names", metavar="[NAME]...", nargs=-1)
@click.option(
    "--folder",
    "folders",
    default=["fmus"],
    multiple=True,
    show_default=True,
    help="Folder whose modules define components; may be given again.",
)
@click.option(
    "--out", default="dist", show_default=True, help="Folder for the FMUs; the Python twins go to OUT/python."
)
@click.option(
    "--platforms",
    default="host",
    show_default=True,
    help="host, all, or a list such as x86_64-linux,win64.",
)
@click.option("--twins/--no-twins", default=True, show_default=True, help="Build the Python twins too.")
@click.option(
    "--pictures/--no-pictures",
    default=True,
    show_default=True,
    help="Draw icons, and run each FMU's example for its page.",
)
@click.option("--systems", help="Folder of systems to pack into OUT/*.ssp when all FMUs are built.")
@click.option("--jobs", type=click.IntRange(min=1), help="Compilers at a time; as many as there are processors.")
def main(
    names: tuple[str, ...],
    folders: tuple[str, ...],
    out: str,
    platforms: str,
    twins: bool,
    pictures: bool,
    systems: str | None,
    jobs: int | None,
) -> None:
    """Build FMUs from components: all that the modules in a folder define, or only those NAMEd.

    An FMU that has not changed is taken from the cache. A component that needs a Python package has a PythonFMU only,
    and where that package is not installed none.
    """
    with refusal.as_a_sentence("navfmu.export"), interrupt.as_a_sentence():
        _build(names, folders, Path(out), platforms, twins, pictures, jobs)
        if systems and not names:
            from navfmu.ssp.discovery import pack

            for path in pack(systems, out):
                click.echo(path)


def _build(
    names: tuple[str, ...],
    folders: tuple[str, ...],
    out: Path,
    platforms: str,
    twins: bool,
    pictures: bool,
    jobs: int | None,
) -> None:
    from navfmu.export.build import build_all
    from navfmu.export.discovery import choose, components
    from navfmu.export.needs import missing
    from navfmu.export.parameter_sets import write
    from navfmu.terminal.progress import Progress

    started = time.monotonic()
    chosen = choose(components(*folders), names)
    if not names:
        of_python = {component: missing(component) for component in chosen if component.needs}
        for component, lacking in of_python.items():
            if not twins or lacking:
                why = f"this Python has no {' and '.join(lacking)}" if lacking else "it is a Python twin only"
                click.echo(f"{component.layout.name}: not built, {why}")
                chosen.remove(component)
    with Progress("building FMUs") as progress:
        folder_of_twins = out / "python" if twins else None
        built = build_all(chosen, out, platforms.split(","), jobs, progress, folder_of_twins, pictures)
    sets = [path for component in chosen for path in write(component, out)]
    for item in built:
        state = "unchanged" if item.unchanged else f"{item.path.stat().st_size / 1000:.0f} kB"
        click.echo(f"{item.path}  {state}")
    if sets:
        click.echo(f"{sets[0].parent}  {len(sets)} parameter sets")
    fresh = sum(not item.unchanged for item in built)
    click.echo(f"{len(built)} FMUs, {fresh} built anew, in {time.monotonic() - started:.1f} s")


if __name__ == "__main__":
    main(prog_name="python -m navfmu.export")
