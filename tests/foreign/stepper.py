"""The test FMU ``stepper.c``, which takes FMI at its word where others do not: as a component, and as a file."""

from __future__ import annotations

import zipfile
from functools import cache
from pathlib import Path
from typing import Any

from navfmu.engine.component import Component
from navfmu.fmi.fmu import Fmu, library_suffix, load, platforms
from tests.engine.probe import compile_fmu
from tests.ssp import fmus

#: Outputs: the numbers (from 1) of the inputs on which each depends; None: it does not say.
Dependencies = dict[str, str | None]
DEPENDENCIES: Dependencies = {"x": "", "direct": "1", "fixed": "", "double": "8", "not": "10"}


@cache
def library() -> Path:
    """The compiled FMU; kept between test runs."""
    return compile_fmu(Path(__file__).with_name("stepper.c"))


def description(dependencies: Dependencies = DEPENDENCIES, identifier: str = "stepper", **flags: str) -> str:
    """Its model description; ``flags`` are attributes of CoSimulation."""
    calculated = {"initial": "calculated"}
    variables = [
        fmus.variable("u", "input", reference=0, start="0"),
        fmus.variable("x", "output", reference=1, **calculated),
        fmus.variable("direct", "output", reference=2, **calculated),
        fmus.variable("fixed", "output", reference=3, **calculated),
        fmus.variable("gain", "parameter", reference=4, start="1"),
        fmus.variable("bias", "parameter", reference=5, start="0"),
        fmus.variable("ends_at", "parameter", reference=6, start="1e9"),
        fmus.variable("number", "input", "Integer", 0),
        fmus.variable("double", "output", "Integer", 1, **calculated),
        fmus.variable("flag", "input", "Boolean", 0),
        fmus.variable("not", "output", "Boolean", 1, **calculated),
        fmus.variable("stubborn", "parameter", "Boolean", 2),
        fmus.variable("seed", "parameter", "Integer", 2, start="0"),
        fmus.variable("spread", "parameter", reference=7, start="0"),
        fmus.variable("longest", "parameter", reference=8, start="1e9"),
        fmus.variable("most", "parameter", reference=9, start="1e9"),
    ]
    text = fmus.describe(identifier, variables)
    attributes = " ".join(f'{name}="{value}"' for name, value in flags.items())
    text = text.replace("<CoSimulation ", f"<CoSimulation {attributes} ")
    begin, end = text.index("<ModelStructure>"), text.index("</ModelStructure>")
    names = ["u", "x", "direct", "fixed", "gain", "bias", "ends_at", "number", "double", "flag", "not"]
    outputs = "".join(f'<Unknown index="{names.index(name) + 1}"/>' for name in DEPENDENCIES)
    unknowns = "".join(
        f'<Unknown index="{names.index(name) + 1}"{"" if on is None else f""" dependencies="{on}" """}/>'
        for name, on in dependencies.items()
    )
    structure = f"<Outputs>{outputs}</Outputs><InitialUnknowns>{unknowns}</InitialUnknowns>"
    return text[:begin] + "<ModelStructure>" + structure + text[end:]


@cache
def bare() -> Path:
    """The same without the functions of states and slopes."""
    return compile_fmu(Path(__file__).with_name("bare.c"))


def write(path: Path, *, identifier: str = "stepper", binary: Path | None = None, **options: Any) -> Path:
    """The FMU as a file."""
    contents = (binary or library()).read_bytes()
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", description(identifier=identifier, **options))
        archive.writestr(f"binaries/{platforms()[0]}/{identifier}{library_suffix()}", contents)
    return path


def stepper(name: str, file: Path | Fmu, **start: Any) -> Component:
    """A component of an FMU that ``write`` has made."""
    return Component(name, file if isinstance(file, Fmu) else load(file), start)
