"""``navfmu figures``: the figures of a source beside our own."""

from __future__ import annotations

import sys

import click


@click.command("figures")
@click.argument("collection", required=False)
@click.option("--only", multiple=True, metavar="ROW", help="Do this row; may be repeated, or names with commas.")
@click.option("--list", "listing", is_flag=True, help="Show what rows there are, and do nothing.")
@click.option("--seed", type=click.IntRange(0, 2147483647), default=1, show_default=True, metavar="N",
              help="Decides all that is random.")  # fmt: skip
@click.option("--jobs", type=click.IntRange(min=1), metavar="N", help="Rows at the same time; default: one per core.")
@click.option("--out", metavar="DIR", help="Folder of report and pictures; default: results/figures-COLLECTION.")
def command(
    collection: str | None, only: tuple[str, ...], listing: bool, seed: int, jobs: int | None, out: str | None
) -> None:
    """Find the figures of COLLECTION again, and say of each whether it agrees, or why it does not.

    Each row has a claim of its source, our figures beside the printed ones with a tolerance and the reason for it, and
    a picture. Finished rows are kept. The exit code is 1 when a figure differs and nobody knows why, or a row failed.

    \b
    navfmu figures --list
    navfmu figures thesis --out results/thesis
    navfmu figures thesis --only T13,T30 --seed 7
    """
    from navfmu.errors import NavfmuError
    from navfmu.figures import collection as collections
    from navfmu.figures.report import FILES, write_report
    from navfmu.figures.running import run
    from navfmu.figures.show import listed, show
    from navfmu.system.results_folder import check_results
    from navfmu.terminal.progress import Progress

    known = collections.names()
    if collection is None and not listing:
        have = f"there are {', '.join(known)}" if known else f"no package of {collections.SPACE} is installed"
        raise NavfmuError(f"which collection of figures? ({have}; --list shows their rows)")
    chosen = tuple(name.strip() for text in only for name in text.split(","))
    if listing:
        for one in map(collections.collection, known if collection is None else [collection]):
            listed(one, one.chosen(chosen))
        return
    found = collections.collection(collection)
    rows = found.chosen(chosen)
    folder = check_results(out if out is not None else f"results/figures-{found.name}", "figures", *FILES)
    with Progress(f"figures of {found.name}") as progress:
        outcome = run(found, rows, seed, folder, jobs, progress)
    show(outcome, write_report(outcome, folder))
    if not outcome.passed:
        sys.exit(1)
