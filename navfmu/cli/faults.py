"""``navfmu faults``: what in a system can fail, and how."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import click
from rich.text import Text

from navfmu.cli import options
from navfmu.errors import NavfmuError, nearest
from navfmu.faults.types import TYPES
from navfmu.fmi import names
from navfmu.terminal.console import console, say
from navfmu.terminal.table import Column, Kind, Table

if TYPE_CHECKING:
    from navfmu.engine.catalogue import Target


@click.command("faults")
@click.argument("system")
@click.argument("targets", nargs=-1)
@click.option("--variant", metavar="V", help="A sibling of the main system.")
@click.option("--type", "kind", metavar="TYPE", help="Only what supports this type of fault, and that type alone.")
@options.strict
def command(system: str, targets: tuple[str, ...], variant: str | None, kind: str | None, strict: bool) -> None:
    """Show what in a system can fail, and how.

    TARGETS narrow it: components, signals, or patterns such as 'gps.*'. For one signal or bundle alone a fault file is
    printed to begin with: 'navfmu faults backup_navigator gps.fix > faults.toml'. So is one for a component whose steps
    are lost: 'navfmu faults backup_navigator gps --type lost_step > faults.toml'.
    """
    from navfmu.cli.skeleton import skeleton
    from navfmu.engine.catalogue import catalogue
    from navfmu.engine.component import Component
    from navfmu.system.system import System

    loaded = System.load(system, variant, strict=strict)
    components = [Component(name, fmu) for name, fmu in loaded.fmus.items()]
    known = catalogue(components, {names.split(link.target): link.source for link in loaded.links})
    found = _of_type(_chosen(known, targets), kind)
    alone = "." in "".join(targets) or len(found) == 1  # a component stands for its signals, too
    if alone and len(targets) == 1 and found[0].name == targets[0]:
        click.echo(skeleton(found[0]), nl=False)
    else:
        _show(found)


def _chosen(known: Sequence[Target], wanted: Sequence[str]) -> list[Target]:
    """The targets that are meant; one that is named comes first."""
    found: dict[str, Target] = {}
    for name in wanted:
        meant = sorted((t for t in known if names.stands_for(name, t.name)), key=lambda target: target.name != name)
        if not meant:
            hint = names.hint(name, names.short(target.name for target in known))
            raise NavfmuError(f"nothing that can fail has the name '{name}'{hint}")
        found |= {target.name: target for target in meant}
    return list(found.values()) if wanted else list(known)


def _of_type(found: list[Target], kind: str | None) -> list[Target]:
    """The targets that support a type of fault, as if there were no other."""
    if kind is None:
        return found
    if kind not in TYPES:
        raise NavfmuError(f"unknown type '{kind}'{nearest(kind, TYPES)} (types: {', '.join(TYPES)})")
    able = [replace(target, types=(kind,)) for target in found if kind in target.types]
    if not able:
        raise NavfmuError(f"no target of these supports the type '{kind}', which acts on {TYPES[kind].targets}")
    return able


def _show(found: Sequence[Target]) -> None:
    """Targets in tables, one for each kind that supports the same types of fault."""
    out = console()
    groups: dict[tuple[str, tuple[str, ...]], list[Target]] = {}
    for target in found:
        groups.setdefault((target.what, target.types), []).append(target)
    order = sorted(groups, key=lambda group: next(n for n, end in enumerate(ORDER) if group[0].endswith(end)))
    for what, types in order:
        targets = groups[what, types]
        many = what if len(targets) == 1 else f"{what}s"
        say(out, Text.assemble((f"{len(targets)} {many}", "bold"), f": {', '.join(types)}"), hang=2)
        columns = [Column("target", Kind.NAME), Column("unit", Kind.WORD), Column("description", Kind.SENTENCE)]
        out.print(Table(columns, [[_name(target), target.unit, target.description] for target in targets]))


ORDER = ("fault input", "bundle output", "output", "bundle connected input", "connected input", "unconnected input", "")


def _name(target: Target) -> str:
    """The name, and of an array how many elements it has."""
    count = len(target.elements)
    return f"{target.name} [{count}]" if count > 1 and not target.what.startswith("bundle") else target.name
