"""``navfmu cache``: what the user's cache folder holds, and how to empty it."""

from __future__ import annotations

import click

LISTED = 5  # damaged entries that are named


@click.command("cache")
@click.option("--clear", is_flag=True, help="Remove everything in it; what is needed again is made anew.")
def command(clear: bool) -> None:
    """Show the cache folder: unpacked and built FMUs, systems and libraries. Every entry is verified.

    A damaged entry needs no care: it is made anew when it is needed. NAVFMU_CACHE names another folder.
    """
    from navfmu.files import cache

    click.echo(cache.folder())
    if clear:
        removed = cache.clear()
        click.echo(f"{removed} {'entry' if removed == 1 else 'entries'} removed")
        return
    _show(cache.holdings())


def _show(holdings: list) -> None:
    from rich.text import Text

    from navfmu.terminal.console import console
    from navfmu.terminal.table import Column, Kind, Table

    damaged = [entry for held in holdings for entry in held.damaged]
    rows = [[held.what, str(held.entries), _mb(held.bytes), str(len(held.damaged))] for held in holdings]
    total = sum(held.entries for held in holdings), sum(held.bytes for held in holdings)
    rows.append(["all", str(total[0]), _mb(total[1]), str(len(damaged))])
    table = Table([Column("kind", Kind.WORD), Column("entries"), Column("MB"), Column("damaged")], rows, keys=1)
    out = console()
    out.print(table)
    for entry in damaged[:LISTED]:
        out.print(Text(f"damaged: {entry}"), soft_wrap=True)
    if len(damaged) > LISTED:
        out.print(f"and {len(damaged) - LISTED} more")


def _mb(size: int) -> str:
    return f"{size / 1e6:.1f}"
