"""``python -m system_ssp``: write each system's documents (.ssd, .ssv) beside its system.py, from the FMUs in dist/."""

from __future__ import annotations

from pathlib import Path

import click

from navfmu.ssp.discovery import sources
from navfmu.terminal import interrupt, refusal

HERE = Path(__file__).resolve().parent


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
def main() -> None:
    """Write each system's documents (.ssd, .ssv) beside its system.py, from the FMUs in dist/."""
    with refusal.as_a_sentence("system_ssp"), interrupt.as_a_sentence():
        write()


def write() -> None:
    """Write the documents, and print what was written."""
    for folder, source in sources(HERE, HERE.parent / "dist").items():
        for path in source.write(folder, fmus=False):  # the FMUs are found among the shipped ones
            click.echo(path.relative_to(HERE.parent))


if __name__ == "__main__":
    main(prog_name="python -m system_ssp")
