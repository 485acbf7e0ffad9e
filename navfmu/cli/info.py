"""What ``navfmu info`` and ``navfmu run`` print."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.console import Console
from rich.table import Table

from navfmu.errors import NavfmuError
from navfmu.fmi.fmu import Description, Variable, binaries, describe, platforms
from navfmu.ssp import reader
from navfmu.system import shipped
from navfmu.terminal.console import console

if TYPE_CHECKING:
    import pandas

    from navfmu.system.system import System

SUMMARY = 40  # columns of a recording that are listed


@click.command("info")
@click.argument("file")
@click.option("--variant", metavar="V", help="A sibling of the main system.")
def command(file: str, variant: str | None) -> None:
    """Show what an FMU or a system consists of."""
    show(file, variant)


def show(file: str, variant: str | None = None) -> None:
    """Describe an FMU or a system."""
    path = shipped.system(file)
    if path.suffix.lower() == ".fmu":
        if variant is not None:
            raise NavfmuError(f"{path}: a single FMU has no variants")
        _show_fmu(path)
    else:
        from navfmu.system.system import System

        _show_system(System.load(path, variant), path)


def _show_fmu(path: Path) -> None:
    about, out = describe(path), console()
    has = binaries(path)
    here = "yes" if any(name in has for name in platforms()) else "NO"
    out.print(f"[bold]{about.model_name}[/]  {about.description}", soft_wrap=True)
    out.print(f"file        {path}", soft_wrap=True)
    out.print(f"FMI         {about.fmi_version} co-simulation, made by {about.generation_tool or 'an unnamed tool'}")
    out.print(f"guid        {about.guid}")
    out.print(f"binaries    {', '.join(has) or 'none'}; this machine ({platforms()[0]}): {here}", soft_wrap=True)
    able = {
        "saves and restores its state": about.can_get_and_set_state,
        "serialises it": about.can_serialize_state,
        "interpolates inputs": about.can_interpolate_inputs,
        "takes variable steps": about.can_handle_variable_step,
        "needs another tool to run": about.needs_execution_tool,
    }
    out.print(f"abilities   {', '.join(name for name, can in able.items() if can) or 'none declared'}", soft_wrap=True)
    bundles = _bundles(about)
    if bundles:
        out.print(f"bundles     {', '.join(bundles)} (with valid, sequence and time_of_validity)", soft_wrap=True)
    inputs = [v for v in about.variables if v.causality == "input"]
    for chosen, title in (
        ([v for v in inputs if not v.fault], "inputs"),
        ([v for v in inputs if v.fault], "fault inputs, which say how it can fail"),
        ([v for v in about.variables if v.causality == "output"], "outputs"),
        ([v for v in about.variables if v.causality == "parameter"], "parameters"),
    ):
        if chosen:
            out.print(_variables(chosen, about, f"{len(chosen)} {title}"))


def _bundles(about: Description) -> list[str]:
    """Output bundles, the targets of dropouts."""
    outputs = {v.name for v in about.variables if v.causality == "output"}
    return sorted(n.removesuffix(".valid") for n in outputs if n.endswith(".valid") and f"{n[:-5]}sequence" in outputs)


def _variables(variables: list[Variable], about: Description, title: str) -> Table:
    table = Table(title=title, title_justify="left", box=None, pad_edge=False, header_style="dim")
    for heading, justify in (
        ("name", "left"),
        ("type", "left"),
        ("unit", "left"),
        ("start", "right"),
        ("range", "left"),
    ):
        table.add_column(heading, justify=justify, no_wrap=heading == "name")
    table.add_column("description", ratio=1)
    for v in variables:
        table.add_row(_escape(v.name), v.type, v.unit or "", _start(v, about), _range(v), _escape(v.description))
    return table


def _escape(text: str) -> str:
    from rich.markup import escape

    return escape(text)


def _start(variable: Variable, about: Description) -> str:
    if variable.start is None:
        return ""
    if isinstance(variable.start, bool):
        return "true" if variable.start else "false"
    if variable.type != "Real":
        return str(variable.start)
    text = f"{variable.start:.6g}"
    display = about.display_units.get(variable.unit or "", {}).get(variable.display_unit or "")
    if display and variable.display_unit != variable.unit:
        text += f" = {display[0] * variable.start + display[1]:.6g} {variable.display_unit}"
    return text


def _range(variable: Variable) -> str:
    if variable.min is None and variable.max is None:
        return ""
    low = "" if variable.min is None else f"{variable.min:.6g}"
    high = "" if variable.max is None else f"{variable.max:.6g}"
    return f"{low} .. {high}"


def _show_system(system: System, path: Path) -> None:
    out, structure = console(), system.structure
    out.print(f"[bold]{structure.name}[/]  {structure.description}", soft_wrap=True)
    out.print(f"file        {path}", soft_wrap=True)
    siblings = reader.variants(path) if path.suffix.lower() != ".ssd" else []
    out.print(f"variants    {', '.join(siblings) or 'none'}", soft_wrap=True)
    stop, step = structure.stop_time, structure.step
    out.print(f"experiment  stop {_seconds(stop)}, step {_seconds(step)}")
    _show_attachments(out, structure.file.parent)
    table = Table(title=f"{len(system.fmus)} components", title_justify="left", box=None, pad_edge=False)
    table.add_column("name")
    table.add_column("FMU")
    for heading in ("inputs", "outputs", "parameters", "set here"):
        table.add_column(heading, justify="right")
    table.add_column("description", ratio=1)
    for name, fmu in system.fmus.items():
        counts = [
            str(sum(v.causality == c for v in fmu.description.variables)) for c in ("input", "output", "parameter")
        ]
        values = str(len(system.values[name]))
        table.add_row(name, fmu.path.name, *counts, values, _escape(fmu.description.description))
    out.print(table)
    _show_connections(out, system)
    _show_free_inputs(out, system)
    for title, lines in (("notes", structure.notes), ("has no effect here", structure.ignored)):
        if lines:
            out.print(f"[bold]{title}[/]")
        for line in lines:
            out.print(f"  {_escape(line)}", soft_wrap=True)


def _show_attachments(out: Console, folder: Path) -> None:
    for kind in ("faults", "campaigns"):
        names = sorted(file.stem for place in (folder / "extra" / kind, folder / kind) for file in place.glob("*.toml"))
        if names:
            out.print(f"{kind:<11} {', '.join(names)}", soft_wrap=True)


def _seconds(value: float | None) -> str:
    return "not given" if value is None else f"{value:g} s"


def _show_connections(out: Console, system: System) -> None:
    """Connections by pairs of components, arrays and bundles folded."""
    pairs: dict[tuple[str, str], list[str]] = {}
    for link in system.links:
        (a, output), (b, _) = link.source.split(".", 1), link.target.split(".", 1)
        name = output.split("[")[0]
        if link.scaled:
            name += f" (times {link.factor:g}" + (f" plus {link.offset:g})" if link.offset else ")")
        names = pairs.setdefault((a, b), [])
        if name not in names:
            names.append(name)
    if not pairs:
        return
    table = Table(title=f"{len(system.links)} connections", title_justify="left", box=None, pad_edge=False)
    for heading in ("from", "to", "signals"):
        table.add_column(heading)
    for (a, b), names in pairs.items():
        table.add_row(a, b, _escape(", ".join(names)))
    out.print(table)


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
            failing.setdefault(name.split("[")[0], variable.description.removeprefix("fault: ") + unit)
    if failing:
        out.print("[bold]fault inputs[/] (a fault of type 'input' drives them)")
        width = max(map(len, failing))
        for name, description in failing.items():
            out.print(f"  {name:<{width}}  {_escape(description)}", soft_wrap=True)
    others = [name for name, variable in free if not variable.fault]
    if others:
        out.print("[bold]other unconnected inputs[/] (a fault of type 'input' can drive them, too)")
        out.print(f"  {_escape(', '.join(others))}", soft_wrap=True)


def summarise(frame: pandas.DataFrame, file: str | None) -> None:
    """The recording in a few numbers for each signal, and where it went."""
    out, units = console(), frame.attrs["units"]
    about = frame.attrs["provenance"]
    seed = "the system's own" if about["seed"] is None else about["seed"]
    out.print(f"{about['stop']:g} s in steps of {about['step']:g} s, {about['algorithm']}, seed: {seed}")
    table = Table(box=None, pad_edge=False)
    table.add_column("signal", no_wrap=True)
    table.add_column("unit")
    for heading in ("first", "least", "mean", "greatest", "last"):
        table.add_column(heading, justify="right")
    for name in list(frame.columns)[:SUMMARY]:
        values = frame[name].astype(float)
        numbers = (values.iloc[0], values.min(), values.mean(), values.max(), values.iloc[-1])
        table.add_row(_escape(name), units.get(name) or "", *(f"{x:.6g}" for x in numbers))
    out.print(table)
    if len(frame.columns) > SUMMARY:
        out.print(f"... and {len(frame.columns) - SUMMARY} more signals")
    if file is not None:
        out.print(f"wrote {len(frame)} rows to {file}", soft_wrap=True)
