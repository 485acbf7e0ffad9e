"""documentation/index.html of an FMU: what it computes, every parameter with its source, and what it looks like."""

from __future__ import annotations

import ast
import base64
import html
import inspect
import io
import re
import sys
from collections.abc import Iterable
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from navfmu import __version__
from navfmu.export import ir
from navfmu.export.description import display
from navfmu.export.response import Response

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; color: #1c2733; }
h1 { margin-bottom: 0; } h2 { margin-top: 2.2rem; border-bottom: 1px solid #ccd5dd; } h3 { margin-bottom: 0.2rem; }
table { border-collapse: collapse; width: 100%; font-size: 0.9rem; }
th, td { text-align: left; vertical-align: top; padding: 0.25rem 0.8rem 0.25rem 0; border-bottom: 1px solid #e3e8ed; }
td:nth-child(-n+2) { white-space: nowrap; } td:nth-child(n+3) { max-width: 12rem; overflow-wrap: break-word; }
td:nth-child(5) { min-width: 14rem; max-width: none; }
dl { display: grid; grid-template-columns: max-content auto; gap: 0.2rem 1.2rem; margin: 0.6rem 1rem; }
dd { margin: 0; }
code, pre { font: 0.85rem/1.45 ui-monospace, monospace; }
pre { background: #f4f6f8; padding: 0.7rem 1rem; overflow-x: auto; border-radius: 4px; }
img { max-width: 100%; } .quiet { color: #5d6b78; } summary { cursor: pointer; color: #24567f; }
"""


def page(model: ir.Model, response: Response | None = None, classes: Iterable[type] = (), *, twin: bool = False) -> str:
    """Return the page as one HTML document without references to anything outside.

    ``classes`` is the component class, if it is at hand: then the equations that its tasks call are shown too.
    ``twin`` says that this is the page of the Python twin.
    """
    told = model.documentation
    parts = [f"<h1>{_escape(model.name)}</h1>", f'<p class="quiet">{_escape(model.description)}</p>']
    parts.append(_text(told.get("text", "")))
    if response is not None and (response.indices or response.panels):
        parts += ["<h2>Response</h2>", _caption(model, response), _image(picture(model, response))]
    parts += ["<h2>Inputs</h2>", _variables(model, "input")]
    parts += ["<h2>Outputs</h2>", _variables(model, "output")]
    parts += ["<h2>Parameters</h2>", _variables(model, "parameter")]
    if any(v.causality == "local" for v in model.variables):
        parts += ["<h2>States</h2>", _variables(model, "local")]
    parts += _tables(model)
    parts += ["<h2>When what is computed</h2>", *_tasks(model)]
    parts += _requirements(model)
    functions = [found for component in classes for found in _equations(component, model)]
    if functions:
        parts += ["<h2>Equations</h2>", *functions]
    parts += ["<h2>Interface</h2>", _interface(model, twin)]
    body = "\n".join(part for part in parts if part)
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{_escape(model.name)}</title>\n'
        f'<style>{_STYLE}</style>\n</head>\n<body>\n{body}\n<p class="quiet">Made by navfmu {__version__}.</p>\n'
        "</body>\n</html>\n"
    )


def picture(model: ir.Model, response: Response) -> bytes:
    """Return a PNG of the outputs over time, in their display units; vectors share one pair of axes."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    panels = _panels(model, response)
    rows = -(-len(panels) // 2)
    figure = Figure(figsize=(9.0, 0.6 + 1.9 * rows), dpi=100, layout="constrained")
    FigureCanvasAgg(figure)
    for place, (title, curves) in enumerate(panels.items()):
        axes = figure.add_subplot(rows, 2 if len(panels) > 1 else 1, place + 1)
        colours = iter(f"C{i}" for i in range(10))
        for label, curve in curves.items():
            dashed = label.startswith("~")
            style = {"color": "0.25", "linestyle": "--"} if dashed else {"color": next(colours)}
            name = label.lstrip("~").rstrip() or None
            axes.plot(response.time, curve, linewidth=0.9, label=name, **style)
        axes.set_title(title, fontsize=9, loc="left")
        axes.tick_params(labelsize=8)
        axes.ticklabel_format(axis="y", useOffset=False)
        axes.grid(alpha=0.3)
        axes.margins(x=0)
        axes.set_xlim(response.time[0], response.time[-1])
        if response.onset is not None:
            axes.axvline(response.onset, color="0.5", linewidth=0.8, linestyle=":")
        if axes.get_legend_handles_labels()[1]:
            axes.legend(fontsize=7, ncols=min(5, len(curves)), frameon=False)
        if place >= len(panels) - 2:
            axes.set_xlabel("time (s)", fontsize=8)
    stream = io.BytesIO()
    figure.savefig(stream, format="png", metadata={"Software": None})
    return stream.getvalue()


def _panels(model: ir.Model, response: Response) -> dict[str, dict[str, Any]]:
    """Return the curves by label for each pair of axes: those of the example, then its outputs."""
    panels = {title: dict(curves) for title, curves in response.panels.items()}
    groups: dict[str, list[int]] = {}
    for column, index in enumerate(response.indices):
        groups.setdefault(_base(model.variables[index].name), []).append(column)
    for name, columns in list(groups.items())[: max(10 - len(panels), 1)]:
        curves = {}
        for column in columns:
            variable = model.variables[response.indices[column]]
            scale, offset = display(variable, 1.0)[0] - display(variable, 0.0)[0], display(variable, 0.0)[0]
            curves[variable.name[len(name) :]] = scale * response.values[:, column] + offset
        unit = display(variable, 0.0)[1]
        panels[f"{name} ({unit})" if unit else name] = curves
    return panels


def _image(png: bytes) -> str:
    return f'<img alt="response" src="data:image/png;base64,{base64.b64encode(png).decode()}">'


def _caption(model: ir.Model, response: Response) -> str:
    example = response.example
    values = example.values
    words = f"{response.time[-1]:.6g} s with "
    if values:
        known = {name: v for v in reversed(model.variables) for name in (v.name, _base(v.name))}
        short = {name: value for name, value in values.items() if np.size(value) <= 3}
        told = [f"<code>{_escape(f'{name} = {_shown(known[name], value)}')}</code>" for name, value in short.items()]
        if long := [f"<code>{name}</code>" for name in values if name not in short]:
            told.append("values of its own for " + ", ".join(long))
        words += ", ".join(told) + " and otherwise "
    words += "the start values"
    if response.stepped:
        heights: dict[str, list[str]] = {}
        units: dict[str, str] = {}
        for index, height in response.stepped.items():
            variable = model.variables[index]
            name, (shown, unit) = _base(variable.name), display(variable, height)
            heights.setdefault(name, []).append(f"{shown - display(variable, 0.0)[0]:.4g}")
            units[name] = unit
        steps = [
            f"<code>{name}</code> by {of[0] if len(set(of)) == 1 else '[' + ', '.join(of) + ']'} {units[name]}".rstrip()
            for name, of in heights.items()
        ]
        words += f"; at {response.time[-1] / 5:.6g} s (dotted) inputs step: {', '.join(steps)}"
    often = [
        f"<code>{name}</code> every {example.periods[name]:g} s" for name in response.fed if name in example.periods
    ]
    always = ", ".join(f"<code>{name}</code>" for name in response.fed if name not in example.periods)
    often += [f"{always} at every communication point"] if always else []
    if often:
        words += f". New data comes in {', in '.join(often)}"
    text = f"<p>{_inline(example.text)}</p>\n" if example.text else ""
    return f'{text}<p class="quiet">{words}.</p>'


def _shown(variable: ir.Variable, value: Any) -> str:
    """Return a value, or some of a vector, with its display unit."""
    numbers = [display(variable, float(number)) for number in np.ravel(value)]
    text = ", ".join(f"{number:.6g}" for number, _ in numbers)
    return f"{f'[{text}]' if np.ndim(value) else text} {numbers[0][1]}".rstrip()


def _base(name: str) -> str:
    return re.sub(r"\[[\d,]+\]$", "", name)


def _variables(model: ir.Model, causality: str) -> str:
    groups: dict[str, list[ir.Variable]] = {}
    for variable in model.variables:
        if variable.causality == causality:
            groups.setdefault(_base(variable.name), []).append(variable)
    if not groups:
        return "<p>None.</p>"
    head = "<tr><th>Name</th><th>Unit</th><th>Start</th><th>Range</th><th>Meaning</th></tr>"
    return f"<table>\n{head}\n" + "\n".join(_row(name, group) for name, group in groups.items()) + "\n</table>"


def _row(name: str, group: list[ir.Variable]) -> str:
    first, last = group[0], group[-1]
    shown = (
        name if len(group) == 1 and first.name == name else f"{name}{first.name[len(name) :]}…{last.name[len(name) :]}"
    )
    unit = first.unit or {"Integer": "Integer", "Boolean": "Boolean"}.get(first.type, "")
    starts = [_value(v, v.start) for v in group] if first.initial != "calculated" else ["calculated"]
    start = starts[0] if len(set(starts)) == 1 else ", ".join(starts[:8]) + (", …" if len(starts) > 8 else "")
    low, high = first.min, first.max
    if low is None and high is None:
        limits = ""
    else:
        limits = " … ".join("" if value is None else _value(first, value) for value in (low, high))
    meaning = first.description
    if first.causality == "parameter" and first.variability == "tunable":
        meaning += " (tunable)"
    cells = f"<td><code>{_escape(shown)}</code></td><td>{_escape(unit if unit != '1' else '')}</td>"
    cells += f"<td>{_escape(start)}</td><td>{_escape(limits)}</td>"
    return f"<tr>{cells}<td>{_inline(meaning)}</td></tr>"


def _value(variable: ir.Variable, value: float) -> str:
    if variable.type == "Boolean":
        return "true" if value else "false"
    text = f"{value:.6g}" if variable.type == "Real" else str(round(value))
    number, unit = display(variable, value)
    if variable.display_unit and variable.display_unit != variable.unit and value:
        text += f" ({number:.6g} {unit})"
    return text


def _tables(model: ir.Model) -> list[str]:
    if not model.tables:
        return []
    rows = [
        f"<tr><td><code>resources/{_escape(t.name)}.csv</code></td><td>{len(t.rows)}</td><td>"
        + ", ".join(f"{_escape(c)} ({_escape(u)})" for c, u in zip(t.columns, t.units, strict=True))
        + "</td></tr>"
        for t in model.tables
    ]
    return ["<h2>Tables</h2>", "<table><tr><th>File</th><th>Rows</th><th>Columns</th></tr>", *rows, "</table>"]


def _tasks(model: ir.Model) -> Iterable[str]:
    told = {task["name"]: task for task in model.documentation.get("tasks", ())}
    for task in model.tasks:
        about = told.get(task.name, {})
        when = "at t = 0, when initialisation ends"
        if task.kind == "every":
            period = model.variables[task.period]
            when = f"every <code>{_escape(period.name)}</code> ({period.start:g} s unless set), at k times that period"
        elif task.kind == "on_new":
            bundle = model.variables[task.sequence].name.rpartition(".")[0]
            when = f"at the first tick that sees new data in <code>{_escape(bundle)}</code>"
        yield f"<h3><code>{_escape(task.name)}</code> <span class='quiet'>{when}</span></h3>"
        yield _text(about.get("text", ""))
        if about.get("source"):
            yield f"<details><summary>as declared</summary><pre>{_escape(about['source'])}</pre></details>"


def _requirements(model: ir.Model) -> list[str]:
    if not model.checks:
        return []
    rows = [f"<li>{_escape(check.message)}</li>" for check in model.checks]
    return ["<h2>Requirements</h2>", "<p>Initialisation fails with these words:</p>", "<ul>", *rows, "</ul>"]


def _interface(model: ir.Model, twin: bool) -> str:
    noise = ""
    if model.seed is not None:
        noise = (
            " Its noise depends on the parameters <code>seed</code> and <code>stream</code> and on the count of "
            "samples alone (Philox4x64-10, Box-Muller): the same seed gives the same noise at every communication "
            "step size; two instances of this FMU need two streams."
        )
    needs = (
        "<p>This is the <em>Python twin</em> of the native FMU of the same name, for tests and for a debugger: the "
        "same model, variables and numbers, run by PythonFMU. It needs a Python 3 with NumPy where it runs (the host "
        "loads that Python's library), is much slower, and does not interpolate its inputs. Where there is no "
        f"Python, or speed matters, use the native <code>{_escape(model.name)}.fmu</code>, which needs nothing.</p>\n"
        if twin
        else ""
    )
    inputs = (
        "All inputs are held over a step."
        if twin
        else "Continuous inputs follow their derivative where the host sets one; data in bundles is held."
    )
    return needs + (
        "<p>FMI 2.0 for co-simulation, any communication step size; the FMU samples at its own periods inside a step. "
        f"Outputs depend on the state alone. {inputs} "
        "The whole state can be saved, restored and serialised." + noise + "</p>"
    )


def _equations(component: type, model: ir.Model) -> Iterable[str]:
    """Yield the functions that a component's tasks call, and those that these call, each once, with their source."""
    seen: dict[str, FunctionType] = {}
    module = sys.modules.get(component.__module__)
    waiting = [(task.get("source", ""), module) for task in model.documentation.get("tasks", ())]
    while waiting:
        source, module = waiting.pop(0)
        for function in _called(source, module):
            name = f"{function.__module__.rpartition('.')[2]}.{function.__name__}"
            if name not in seen:
                seen[name] = function
                waiting.append((inspect.getsource(function), sys.modules[function.__module__]))
    for name, function in seen.items():
        yield f"<h3><code>{_escape(name)}{_escape(str(inspect.signature(function)))}</code></h3>"
        text, _, code = _split(inspect.getsource(function))
        yield _text(text)
        yield f"<details><summary>as computed</summary><pre>{_escape(code)}</pre></details>"


def _called(source: str, module: ModuleType | None) -> Iterable[FunctionType]:
    """Yield the project's own functions that a piece of source calls as ``module.name(...)`` or ``name(...)``."""
    for node in ast.walk(ast.parse(inspect.cleandoc("\n" + source))):
        if not isinstance(node, ast.Call):
            continue
        found: Any = None
        if isinstance(node.func, ast.Name):
            found = getattr(module, node.func.id, None)
        elif isinstance(node.func, ast.Attribute) and isinstance(node.func.value, ast.Name):
            found = getattr(getattr(module, node.func.value.id, None), node.func.attr, None)
        if isinstance(found, FunctionType) and not found.__module__.startswith(("navfmu", "numpy")):
            yield found


def _split(source: str) -> tuple[str, str, str]:
    """Split the source of a function into its docstring, its first line and its code without the docstring."""
    source = inspect.cleandoc("\n" + source)
    node = ast.parse(source).body[0]
    text = ast.get_docstring(node) or ""
    lines = source.splitlines()
    if text and isinstance(node, ast.FunctionDef):
        first = node.body[0]
        del lines[first.lineno - 1 : first.end_lineno]
    return text, lines[0], "\n".join(lines)


def _text(text: str) -> str:
    """Return paragraphs, lists of lines that begin with "- ", and indented blocks of a docstring as HTML."""
    parts = []
    for block in re.split(r"\n\s*\n", text.strip("\n")):
        lines = block.splitlines()
        if not block.strip():
            continue
        if all(line.startswith("  ") for line in lines):
            parts.append(f"<pre>{_escape(inspect.cleandoc(block))}</pre>")
        elif all(re.match(r"\S+( \S+)? {2,}\S|\s{4}", line) for line in lines):  # name, blanks, meaning
            items = re.split(r"\n(?=\S)", block)
            parts.append(
                "<dl>" + "".join("<dt><code>{}</code></dt><dd>{}</dd>".format(*_term(i)) for i in items) + "</dl>"
            )
        elif lines[0].lstrip().startswith(("- ", "* ")):
            items = re.split(r"^\s*[-*] ", block, flags=re.M)[1:]
            parts.append("<ul>" + "".join(f"<li>{_inline(item)}</li>" for item in items) + "</ul>")
        else:
            parts.append(f"<p>{_inline(block)}</p>")
    return "\n".join(parts)


def _term(item: str) -> tuple[str, str]:
    name, meaning = re.split(r" {2,}", item, maxsplit=1)
    return _escape(name), _inline(meaning)


def _inline(text: str) -> str:
    text = re.sub(r"`{1,2}([^`]+)`{1,2}", r"<code>\1</code>", _escape(" ".join(text.split())))
    return re.sub(r"(?<![\w*])\*(\S[^*<>]*?[\w.])\*(?![\w*])", r"<em>\1</em>", text)


def _escape(text: str) -> str:
    return html.escape(text, quote=False)
