"""Parameter sets of single FMUs: .ssv files that a system, in any tool that reads SSP, binds to a component.

Each file of a component names all parameters that any of its sets names, those that are not its own with their start
values: so one set can take the place of another.
"""

from __future__ import annotations

from pathlib import Path

from navfmu.export.declaration.component import Component
from navfmu.files.writing import write_file
from navfmu.fmi.fmu import describe
from navfmu.fmi.values import expand
from navfmu.ssp.writer import values_document


def write(component: type[Component], folder: Path) -> list[Path]:
    """Write parameters/NAME_SET.ssv for each set of a component, beside its built FMU; return the paths."""
    sets = component.parameter_sets
    if not sets:
        return []
    name = component.layout.name
    description = describe(folder / f"{name}.fmu")
    own = {key: expand(description, of.values, f"{name}, parameter set '{key}'") for key, of in sets.items()}
    named = {variable for values in own.values() for variable in values}
    starts = {variable.name: variable.start for variable in description.variables if variable.name in named}
    return [
        write_file(
            folder / "parameters" / f"{name}_{key}.ssv",
            values_document(description, starts | values, sets[key].source),
        )
        for key, values in own.items()
    ]
