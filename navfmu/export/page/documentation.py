"""documentation/index.html of an FMU: what it computes, every parameter with its source, and what it looks like."""

from __future__ import annotations

import base64
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from navfmu import __version__
from navfmu.export.description import display
from navfmu.export.page.equations import equations
from navfmu.export.page.picture import picture
from navfmu.export.page.prose import Piece, blocks, pieces
from navfmu.export.page.response import Response
from navfmu.export.record import ir
from navfmu.files.characters import shown as shown_characters
from navfmu.report.template import fill

_KEPT = "\N{NO-BREAK SPACE}"  # where no line ends
_TEMPLATE = Path(__file__).parent / "templates" / "documentation.html.j2"


def page(model: ir.Model, response: Response | None = None, classes: Iterable[type] = (), *, twin: bool = False) -> str:
    """Return the page as one HTML document without references to anything outside.

    ``classes`` is the component class, if it is at hand: then the equations that its tasks call are shown too.
    ``twin`` says that this is the page of the Python twin.
    """
    kinds = {"input": "Inputs", "output": "Outputs", "parameter": "Parameters", "local": "States"}
    variables = {title: [_row(v) for v in model.variables if v.causality == c] for c, title in kinds.items()}
    shown = None
    if response is not None and (response.indices or response.panels):
        shown = {
            "text": pieces(response.example.text),
            "caption": pieces(_caption(model, response)),
            "picture": base64.b64encode(picture(model, response)).decode(),
        }
    html = fill(
        _TEMPLATE,
        model=model,
        text=list(blocks(model.documentation.get("text", ""))),
        response=shown,
        variables={title: rows for title, rows in variables.items() if rows or title != "States"},
        tasks=list(_tasks(model)),
        equations=[
            (equation, list(blocks(equation.text))) for component in classes for equation in equations(component, model)
        ],
        twin=twin,
        version=__version__,
    )
    return shown_characters(html)  # also those of the docstrings of equations


def _caption(model: ir.Model, response: Response) -> str:
    """What was set, what steps and how often data comes in the run of the picture."""
    example = response.example
    values = example.values
    words = f"{response.time[-1]:.6g} s with "
    if values:
        known = {name: model.elements[places[0]].variable for name, (places, _) in ir.named(model.variables).items()}
        short = {name: value for name, value in values.items() if np.size(value) <= 3}
        told = [f"`{name} = {_shown(known[name], value)}`" for name, value in short.items()]
        if long := [f"`{name}`" for name in values if name not in short]:
            told.append("values of its own for " + ", ".join(long))
        words += ", ".join(told) + " and otherwise "
    words += "the start values"
    if response.stepped:
        heights: dict[str, list[str]] = {}
        units: dict[str, str] = {}
        for index, height in response.stepped.items():
            variable = model.elements[index].variable
            shown, units[variable.name] = display(variable, height)
            heights.setdefault(variable.name, []).append(f"{shown - display(variable, 0.0)[0]:.4g}")
        steps = [
            f"`{name}` by {of[0] if len(set(of)) == 1 else '[' + ', '.join(of) + ']'} {units[name]}".rstrip()
            for name, of in heights.items()
        ]
        words += f"; at {response.time[-1] / 5:.6g} s (dotted) inputs step: {', '.join(steps)}"
    often = [f"`{name}` every {example.periods[name]:g} s" for name in response.fed if name in example.periods]
    always = ", ".join(f"`{name}`" for name in response.fed if name not in example.periods)
    often += [f"{always} at every communication point"] if always else []
    if often:
        words += f". New data comes in {', in '.join(often)}"
    return f"{words}.{_without_value(model, response)}"


def _without_value(model: ir.Model, response: Response) -> str:
    """What the picture ends without, or "": a curve that is missing needs a word."""
    ended = [i for i, value in zip(response.indices, response.values[-1], strict=True) if not np.isfinite(value)]
    names = dict.fromkeys(f"`{model.elements[i].variable.name}`" for i in ended)
    return f" Without a finite value at the end: {', '.join(names)}." if names else ""


def _shown(variable: ir.Variable, value: Any) -> str:
    """Return a value, or some of a vector, with its display unit; names as they are."""
    if variable.type == "String" or variable.enumeration:
        text = ", ".join(
            given if isinstance(given, str) else _value(variable, given) for given in np.ravel(value).tolist()
        )
        return f"[{text}]" if np.ndim(value) else text
    numbers = [display(variable, float(number)) for number in np.ravel(value)]
    text = ", ".join(f"{number:.6g}" for number, _ in numbers)
    return f"{f'[{text}]' if np.ndim(value) else text} {numbers[0][1]}".rstrip()


def _row(variable: ir.Variable) -> dict[str, Any]:
    elements = variable.elements()
    first, last = elements[0], elements[-1]
    bundle, own = (f"{a}…{b}" if a else "" for a, b in zip(first.subscripts, last.subscripts, strict=True))
    member = variable.name.removeprefix(variable.bundle or "")
    unit = variable.unit or ("Enumeration" if variable.enumeration else variable.type.replace("Real", ""))
    starts = (
        ["calculated"]
        if variable.initial == "calculated"
        else [*variable.texts] or [_value(variable, x) for x in variable.start]
    )
    start = starts[0] if len(set(starts)) == 1 else ", ".join(starts[:8]) + (", …" if len(starts) > 8 else "")
    limits = ""
    if first.min is not None or first.max is not None:
        limits = " … ".join("" if value is None else _value(variable, value) for value in (first.min, first.max))
    if variable.type == "String":
        limits = f"at most {variable.longest} bytes"
    if variable.enumeration:
        limits = ", ".join(f"{name} = {number}".replace(" ", _KEPT) for name, number in variable.enumeration.items)
    tunable = variable.causality == "parameter" and variable.variability == "tunable"
    remarks = " (tunable)" * tunable + " (a difference)" * variable.difference
    return {
        "name": f"{variable.bundle or ''}{bundle}{member}{own}",
        "unit": "" if unit == "1" else unit,
        "start": start,
        "limits": limits,
        "meaning": pieces(variable.description + remarks),
    }


def _value(variable: ir.Variable, value: float) -> str:
    if variable.type == "Boolean":
        return "true" if value else "false"
    if variable.enumeration:
        return next(name for name, number in variable.enumeration.items if number == value)
    text = f"{value:.6g}" if variable.type == "Real" else str(round(value))
    number, unit = display(variable, value)
    if variable.display_unit and variable.display_unit != variable.unit and value:
        text += f" ({number:.6g} {unit})"
    return text


def _alike(model: ir.Model) -> Iterable[tuple[str, list[ir.Task]]]:
    """Yield the tasks, those of one method for an array of bundles together, and what they are called."""
    groups: dict[Any, list[ir.Task]] = {}
    for number, task in enumerate(model.tasks):
        bundle = None if task.sequence is None else model.elements[task.sequence].variable.bundle
        groups.setdefault(bundle or number, []).append(task)
    for tasks in groups.values():
        first, last = tasks[0].name, tasks[-1].name
        yield first if first == last else f"{first}…{last}", tasks


def _tasks(model: ir.Model) -> Iterable[dict[str, Any]]:
    told = {task["name"]: task for task in model.documentation.get("tasks", ())}
    for name, tasks in _alike(model):
        task, about = tasks[0], told.get(tasks[0].name, {})
        yield {
            "name": name,
            "when": _when(model, task),
            "text": list(blocks(about.get("text", ""))),
            "source": about.get("source", ""),
        }


def _when(model: ir.Model, task: ir.Task) -> list[Piece]:
    if task.kind == "every":
        period = model.elements[task.clock.period]
        what = f"every `{period.name}` ({period.start:g} s unless set), "
        if task.clock.offset is None:
            return pieces(f"{what}at k times that period")
        offset = model.elements[task.clock.offset]
        return pieces(f"{what}at `{offset.name}` ({offset.start:g} s unless set) and k times that period")
    if task.kind == "on_new":
        sequence = model.elements[task.sequence]
        last = sequence.variable.elements()[-1]
        own = (
            f"its own of `{sequence.bundle}` to `{last.bundle}`" if sequence.variable.shape else f"`{sequence.bundle}`"
        )
        return pieces(f"at the first tick that sees new data in {own}")
    return pieces("at t = 0, when initialisation ends")
