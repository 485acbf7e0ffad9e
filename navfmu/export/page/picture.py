"""The picture of an FMU's response, drawn for its documentation."""

from __future__ import annotations

import io
from itertools import cycle
from typing import Any

from navfmu.export.description import display
from navfmu.export.page.response import Response
from navfmu.export.record import ir
from navfmu.report.finite import drawn

_COLOURS = 10  # more curves than that are not told apart


def picture(model: ir.Model, response: Response) -> bytes:
    """Return a PNG of the outputs over time, in their display units; vectors share one pair of axes.

    Of an array of more numbers than there are colours some are drawn, of a square matrix those of its diagonal.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    shown = panels(model, response)
    rows = -(-len(shown) // 2)
    figure = Figure(figsize=(9.0, 0.6 + 1.9 * rows), dpi=100, layout="constrained")
    FigureCanvasAgg(figure)
    for place, (title, curves) in enumerate(shown.items()):
        axes = figure.add_subplot(rows, 2 if len(shown) > 1 else 1, place + 1)
        colours = cycle(f"C{i}" for i in range(_COLOURS))
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
        if place >= len(shown) - 2:
            axes.set_xlabel("time (s)", fontsize=8)
    stream = io.BytesIO()
    figure.savefig(stream, format="png", metadata={"Software": None})
    return stream.getvalue()


def panels(model: ir.Model, response: Response) -> dict[str, dict[str, Any]]:
    """Return the curves by label for each pair of axes: those of the example, then its outputs."""
    found = {title: dict(curves) for title, curves in response.panels.items()}
    groups: dict[str, list[int]] = {}
    for column, index in enumerate(response.indices):
        groups.setdefault(model.elements[index].variable.name, []).append(column)
    for name, columns in list(groups.items())[: max(10 - len(found), 1)]:
        chosen, curves = _chosen(model, response, columns), {}
        for column in chosen:
            element = model.elements[response.indices[column]]
            variable = element.variable
            scale, offset = display(variable, 1.0)[0] - display(variable, 0.0)[0], display(variable, 0.0)[0]
            curves["".join(element.subscripts)] = drawn(scale * response.values[:, column] + offset)
        unit = display(variable, 0.0)[1]
        title = f"{name} ({unit})" if unit else name
        found[title if chosen == columns else f"{title}, {len(chosen)} of {len(columns)}"] = curves
    return found


def _chosen(model: ir.Model, response: Response, columns: list[int]) -> list[int]:
    """Return the columns of one variable that are drawn."""
    if len(columns) <= _COLOURS:
        return columns
    places = {column: model.elements[response.indices[column]].place[-2:] for column in columns}
    shape = model.elements[response.indices[columns[0]]].variable.shape[-2:]
    diagonal = [column for column in columns if len(set(places[column])) == 1]
    return (diagonal if len(shape) == 2 and len(set(shape)) == 1 else columns)[:_COLOURS]
