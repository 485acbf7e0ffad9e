"""``navfmu info``: what an FMU or a system consists of."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.console import Console
from rich.text import Text

from navfmu.cli import options
from navfmu.errors import NavfmuError
from navfmu.files.archive import open_archive, read_entry
from navfmu.fmi import names
from navfmu.fmi.description import Description, Variable, refuse_lenient
from navfmu.fmi.fmu import binaries, describe, platforms
from navfmu.recorded.page import ACCOUNT
from navfmu.ssp import reader
from navfmu.system import shipped
from navfmu.system.display import Display
from navfmu.terminal.console import console, say
from navfmu.terminal.table import Column, Kind, Table

if TYPE_CHECKING:
    from navfmu.system.system import System


_ELEMENT = re.compile(r"\[\d+(,\d+)*\]$")


@click.command("info")
@click.argument("file")
@click.option("--variant", metavar="V", help="A sibling of the main system.")
@options.strict
def command(file: str, variant: str | None, strict: bool) -> None:
    """Show what an FMU or a system consists of."""
    show(file, variant, strict)


def show(file: str, variant: str | None = None, strict: bool = False) -> None:
    """Describe an FMU or a system."""
    path = shipped.system(file)
    if path.suffix.lower() == ".fmu":
        if variant is not None:
            raise NavfmuError(f"{path}: a single FMU has no variants")
        _show_fmu(path, strict)
    else:
        from navfmu.system.system import System

        _show_system(System.load(path, variant, strict=strict), path)


def _show_fmu(path: Path, strict: bool) -> None:
    about, out = describe(path), console()
    if strict:
        refuse_lenient(str(path), about.lenient)
    has = binaries(path)
    here = "yes" if any(name in has for name in platforms()) else "NO"
    say(out, Text.assemble((about.model_name, "bold"), f"  {about.description}"))
    out.print(Text(f"file        {path}"), soft_wrap=True)
    _line(out, "FMI", f"{about.fmi_version} co-simulation, made by {about.generation_tool or 'an unnamed tool'}")
    _line(out, "guid", about.guid)
    _line(out, "binaries", f"{', '.join(has) or 'none'}; this machine ({platforms()[0]}): {here}")
    able = {
        "saves and restores its state": about.can_get_and_set_state,
        "serialises it": about.can_serialize_state,
        "interpolates inputs": about.can_interpolate_inputs,
        "takes variable steps": about.can_handle_variable_step,
        "needs another tool to run": about.needs_execution_tool,
    }
    _line(out, "abilities", ", ".join(name for name, can in able.items() if can) or "none declared")
    bundles = names.bundles(about)  # the targets of dropouts
    if bundles:
        _line(out, "bundles", f"{', '.join(names.folded(bundles))} (with valid, sequence and time_of_validity)")
    inputs = [v for v in about.variables if v.causality == "input"]
    for chosen, title in (
        ([v for v in inputs if not v.fault], "inputs"),
        ([v for v in inputs if v.fault], "fault inputs, which say how it can fail"),
        ([v for v in about.variables if v.causality == "output"], "outputs"),
        ([v for v in about.variables if v.causality == "parameter"], "parameters"),
    ):
        if chosen:
            out.print(_variables(chosen, about, f"{len(chosen)} {title}"))
    _list(out, "recording, as it was imported", _account(path))
    _list(out, "read leniently", about.lenient)


def _account(path: Path) -> list[str]:
    """What was said of the recording that an FMU plays, without the numbers; nothing if it plays none."""
    with open_archive(path, "FMU") as archive:
        text = read_entry(archive, ACCOUNT, path).decode() if ACCOUNT in archive.namelist() else ""
    return [line for line in text.split("\n\n")[1].splitlines() if line] if text.count("\n\n") else []


def _line(out: Console, name: str, text: str) -> None:
    """A name and what is said of it, which wraps beside the name."""
    say(out, f"{name:<11} {text}", hang=12)


def _variables(variables: list[Variable], about: Description, title: str) -> Table:
    columns = [
        Column("name", Kind.NAME),
        Column("type", Kind.WORD),
        Column("unit", Kind.WORD),
        Column("start"),
        Column("range", Kind.WORD),
        Column("description", Kind.SENTENCE),
    ]
    shown = [
        (
            v.name,
            "Enumeration" if v.enumeration else v.type,
            v.unit or "",
            _start(v, about),
            _range(v, about),
            v.description,
        )
        for v in variables
    ]
    return Table(columns, [[name, *rest] for name, rest in _alike(shown)], title)


def _alike(rows: Sequence[tuple[str, ...]]) -> Iterator[tuple[str, list[str]]]:
    """Names of rows one after the other that are elements of one array, and what else they say."""
    for (_, *rest), group in itertools.groupby(rows, key=lambda row: (_ELEMENT.sub("[]", row[0]), *row[1:])):
        for name in _elements([row[0] for row in group]):
            yield name, rest


def _elements(elements: Sequence[str]) -> Iterator[str]:
    """Names of elements in their order as one, rate[1..3] or matrix[1..2,1..3]; each where some between are missing."""
    indices = [names.subscript(element) for element in elements]
    ends = list(zip(map(min, zip(*indices, strict=True)), map(max, zip(*indices, strict=True)), strict=True))
    if len(elements) == 1 or math.prod(last - first + 1 for first, last in ends) != len(elements):
        yield from elements
    else:
        between = (str(first) if first == last else f"{first}..{last}" for first, last in ends)
        yield f"{names.array(elements[0])}[{','.join(between)}]"


def _start(variable: Variable, about: Description) -> str:
    if variable.start is None:
        return ""
    if isinstance(variable.start, bool):
        return "true" if variable.start else "false"
    if variable.type != "Real":
        names = {number: name for name, number in about.items(variable).items()}
        return names.get(variable.start, str(variable.start))
    text, show = f"{variable.start:.6g}", Display.of(variable, about)
    return text if show.unit == (variable.unit or "") else f"{text} = {show.text(variable.start)} {show.unit}"


def _range(variable: Variable, about: Description) -> str:
    if items := about.items(variable):
        return ", ".join(f"{name} = {number}" for name, number in items.items())
    if variable.min is None and variable.max is None:
        return ""
    low = "" if variable.min is None else f"{variable.min:.6g}"
    high = "" if variable.max is None else f"{variable.max:.6g}"
    return f"{low} .. {high}"


def _show_system(system: System, path: Path) -> None:
    out, structure = console(), system.structure
    say(out, Text.assemble((structure.name, "bold"), f"  {structure.description}"))
    out.print(Text(f"file        {path}"), soft_wrap=True)
    siblings = reader.variants(path) if path.suffix.lower() != ".ssd" else []
    _line(out, "variants", ", ".join(siblings) or "none")
    stop, step = structure.stop_time, structure.step
    _line(out, "experiment", f"stop {_seconds(stop)}, step {_seconds(step)}")
    _show_attachments(out, structure.file.parent)
    columns = [Column("name", Kind.NAME), Column("FMU", Kind.NAME)]
    columns += map(Column, ("inputs", "outputs", "parameters", "set here"))
    rows = []
    for name, fmu in system.fmus.items():
        counts = [
            str(sum(v.causality == c for v in fmu.description.variables)) for c in ("input", "output", "parameter")
        ]
        rows.append([name, fmu.path.name, *counts, str(len(system.values[name])), fmu.description.description])
    out.print(Table([*columns, Column("description", Kind.SENTENCE)], rows, f"{len(system.fmus)} components", keys=1))
    _show_connections(out, system)
    _show_free_inputs(out, system)
    _list(out, "notes", structure.notes)
    _list(out, "has no effect here", structure.ignored)
    _list(out, "read leniently", system.lenient)


def _list(out: Console, title: str, lines: Sequence[str]) -> None:
    """Sentences under a title; nothing if there are none."""
    if lines:
        say(out, Text(title, style="bold"))
    for line in lines:
        say(out, line, indent=2)


def _show_attachments(out: Console, folder: Path) -> None:
    for kind in ("faults", "campaigns"):
        names = sorted(file.stem for place in (folder / "extra" / kind, folder / kind) for file in place.glob("*.toml"))
        if names:
            _line(out, kind, ", ".join(names))


def _seconds(value: float | None) -> str:
    return "not given" if value is None else f"{value:g} s"


def _show_connections(out: Console, system: System) -> None:
    """Connections by pairs of components, arrays and bundles folded."""
    pairs: dict[tuple[str, str], dict[str, list[str]]] = {}
    for link in system.links:
        (a, output), (b, _) = names.split(link.source), names.split(link.target)
        scaled = f" (times {link.factor:g}" + (f" plus {link.offset:g})" if link.offset else ")")
        pairs.setdefault((a, b), {}).setdefault(scaled if link.scaled else "", []).append(output)
    if not pairs:
        return
    columns = [Column("from", Kind.NAME), Column("to", Kind.NAME), Column("signals", Kind.SENTENCE)]
    rows = (
        [a, b, ", ".join(f"{name}{scaled}" for scaled, found in signals.items() for name in names.folded(found))]
        for (a, b), signals in pairs.items()
    )
    out.print(Table(columns, rows, f"{len(system.links)} connections"))


def _show_free_inputs(out: Console, system: System) -> None:
    fed = {link.target for link in system.links}
    free = [
        (f"{name}.{v.name}", v)
        for name, fmu in system.fmus.items()
        for v in fmu.description.variables
        if v.causality == "input" and f"{name}.{v.name}" not in fed
    ]
    failing: dict[str, str] = {}  # an array is one line
    for name, variable in free:
        if variable.fault:
            unit = f" ({variable.unit})" if variable.unit else ""
            failing.setdefault(names.array(name), variable.description.removeprefix("fault: ") + unit)
    if failing:
        say(out, Text.assemble(("fault inputs", "bold"), " (a fault of type 'input' drives them)"))
        out.print(Table([Column("", Kind.NAME), Column("", Kind.SENTENCE)], failing.items()))
    others = [name for name, variable in free if not variable.fault]
    if others:
        about = " (a fault of type 'input' can drive them, too)"
        say(out, Text.assemble(("other unconnected inputs", "bold"), about))
        say(out, ", ".join(names.folded(others)), indent=2)
