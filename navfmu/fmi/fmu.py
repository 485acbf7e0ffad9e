"""One FMU on disk: its description, and its unpacked folder with the library for this machine.

The description is read and validated once with FMPy (about 30 ms) and kept beside the unpacked folder; later loads
of the same content take about a millisecond and import neither FMPy nor an XML parser.
"""

from __future__ import annotations

import json
import platform
import sys
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from navfmu.errors import NavfmuError, nearest
from navfmu.files import cache
from navfmu.files.archive import check_entries, open_archive, read_entry, unpack
from navfmu.files.digest import check_unchanged, content_hash
from navfmu.files.markup import parse
from navfmu.fmi.units import Unit

FORMAT = 2  # of the cached descriptions; raise it when their content changes
_memory: dict[tuple[str, int, int], Fmu] = {}


@dataclass(frozen=True, slots=True)
class Variable:
    """A scalar variable of a model description; ``start``, ``min``, ``max`` and ``nominal`` are numbers in ``unit``."""

    name: str
    reference: int
    type: str  # Real, Integer, Enumeration, Boolean, String
    causality: str
    variability: str
    initial: str | None
    start: float | int | bool | str | None
    unit: str | None
    display_unit: str | None
    min: float | None
    max: float | None
    nominal: float | None
    description: str
    fault: bool = False  # an input that the model declares as a way to fail


@dataclass(frozen=True)
class Description:
    """The part of modelDescription.xml that a master needs."""

    fmi_version: str
    model_name: str
    guid: str
    model_identifier: str
    description: str
    version: str
    generation_tool: str
    needs_execution_tool: bool
    only_one_instance: bool
    can_get_and_set_state: bool
    can_serialize_state: bool
    can_interpolate_inputs: bool
    can_handle_variable_step: bool
    max_output_derivative_order: int
    stop_time: float | None
    step_size: float | None
    variables: tuple[Variable, ...] = field(repr=False)
    units: dict[str, Unit] = field(repr=False)
    display_units: dict[str, dict[str, tuple[float, float]]] = field(repr=False)  # unit, display unit: factor, offset

    @cached_property
    def by_name(self) -> dict[str, Variable]:
        """Variables by name."""
        return {variable.name: variable for variable in self.variables}

    def variable(self, name: str, where: str) -> Variable:
        """The variable of that name, or a sentence with the nearest one."""
        found = self.by_name.get(name)
        if found is None:
            raise NavfmuError(f"{where}: {self.model_name} has no variable '{name}'{nearest(name, self.by_name)}")
        return found


@dataclass(frozen=True)
class Fmu:
    """An unpacked FMU whose library can be loaded on this machine."""

    path: Path  # the .fmu file
    digest: str  # SHA-256 of the file
    folder: Path  # unpacked
    library: Path
    description: Description = field(repr=False)


def platforms() -> tuple[str, ...]:
    """Names of this machine's folder under ``binaries``, preferred one first."""
    machine = platform.machine().lower()
    arm = machine in ("arm64", "aarch64")
    wide = sys.maxsize > 2**32
    if sys.platform == "win32":
        return ("aarch64-windows",) if arm else ("win64", "x86_64-windows") if wide else ("win32", "x86-windows")
    if sys.platform == "darwin":
        return ("aarch64-darwin", "darwin64") if arm else ("darwin64", "x86_64-darwin")
    return ("aarch64-linux", "linux-aarch64") if arm else ("linux64", "x86_64-linux") if wide else ("linux32",)


def library_suffix() -> str:
    """File name ending of shared libraries on this machine."""
    return {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def load(path: str | Path) -> Fmu:
    """Unpack an FMU for co-simulation and find its library for this machine."""
    path = Path(path)
    key = _identity(path)
    if key is not None and (known := _memory.get(key)) is not None and known.library.exists():
        return known
    digest = content_hash(path)
    description = _describe(path, digest)
    folder = unpack(path, "FMU", digest, _needed_here)
    fmu = Fmu(path, digest, folder, _library(path, folder, description), description)
    if key is not None:
        _memory[key] = fmu
    return fmu


def describe(path: str | Path) -> Description:
    """The description of an FMU, whether or not it has a library for this machine."""
    path = Path(path)
    return _describe(path, content_hash(path))


def binaries(path: str | Path) -> list[str]:
    """The platforms for which an FMU holds a library, by their folder names."""
    path = Path(path)
    with open_archive(path, "FMU") as archive:
        names = [entry.filename.split("/") for entry in check_entries(archive, path)]
        return sorted({parts[1] for parts in names if len(parts) > 2 and parts[0] == "binaries" and parts[2]})


def _identity(path: Path) -> tuple[str, int, int] | None:
    try:
        status = path.stat()
    except OSError:
        return None
    return str(path.resolve()), status.st_size, status.st_mtime_ns


def _needed_here(name: str) -> bool:
    """Whether an entry is of use on this machine: not the other platforms' binaries, sources and documentation."""
    parts = name.split("/")
    if parts[0] == "binaries" and len(parts) > 2:
        return parts[1] in platforms()
    return parts[0] not in ("sources", "documentation")


def _library(path: Path, folder: Path, description: Description) -> Path:
    for name in platforms():
        library = folder / "binaries" / name / (description.model_identifier + library_suffix())
        if library.is_file():
            return library
    found = binaries(path)
    has = ", ".join(found) if found else "none at all"
    raise NavfmuError(
        f"{path}: has no binary for this machine ({platforms()[0]}, {description.model_identifier}{library_suffix()}); "
        f"it has: {has}"
    )


def _describe(path: Path, digest: str) -> Description:
    key, name = f"{digest[:32]}.v{FORMAT}", "description.json"
    kept = cache.find("described", key)
    if kept is not None:
        with suppress(OSError, ValueError, KeyError, TypeError):
            return _from_json(json.loads((kept / name).read_bytes()))
    content = _read(path)
    check_unchanged(path, digest)
    with suppress(NavfmuError):  # a cache that cannot be written costs time, nothing else
        text = json.dumps(content, separators=(",", ":"))
        cache.keep("described", key, lambda folder: (folder / name).write_text(text, encoding="utf-8"))
    return _from_json(content)


def _from_json(content: dict[str, Any]) -> Description:
    values = dict(content)
    values["variables"] = tuple(Variable(*row) for row in content["variables"])
    values["units"] = {
        name: Unit(name, None if exponents is None else tuple(exponents), factor, offset)
        for name, (exponents, factor, offset) in content["units"].items()
    }
    values["display_units"] = {
        unit: {name: (factor, offset) for name, (factor, offset) in entries.items()}
        for unit, entries in content["display_units"].items()
    }
    return Description(**values)


def _read(path: Path) -> dict[str, Any]:
    """Parse and validate modelDescription.xml; the answer is plain data."""
    where = f"{path}: modelDescription.xml"
    with open_archive(path, "FMU") as archive:
        root = parse(read_entry(archive, "modelDescription.xml", path), where)
    version = root.get("fmiVersion")
    if root.tag != "fmiModelDescription" or version is None:
        raise NavfmuError(f"{where}: is not a model description: expected <fmiModelDescription fmiVersion=...>")
    if version != "2.0":
        raise NavfmuError(f"{where}: is for FMI {version}, expected FMI 2.0")
    model = _validated(path, where)
    if model.coSimulation is None:
        raise NavfmuError(f"{where}: has no CoSimulation element: the FMU offers model exchange only")
    interface = model.coSimulation
    faults = _fault_inputs(root)
    experiment = model.defaultExperiment
    return {
        "fmi_version": version,
        "model_name": model.modelName,
        "guid": model.guid,
        "model_identifier": _identifier(interface.modelIdentifier, where),
        "description": model.description or "",
        "version": model.version or "",
        "generation_tool": model.generationTool or "",
        "needs_execution_tool": bool(interface.needsExecutionTool),
        "only_one_instance": bool(interface.canBeInstantiatedOnlyOncePerProcess),
        "can_get_and_set_state": bool(interface.canGetAndSetFMUstate),
        "can_serialize_state": bool(interface.canSerializeFMUstate),
        "can_interpolate_inputs": bool(interface.canInterpolateInputs),
        "can_handle_variable_step": bool(interface.canHandleVariableCommunicationStepSize),
        "max_output_derivative_order": int(interface.maxOutputDerivativeOrder or 0),
        "stop_time": _float(experiment.stopTime) if experiment else None,
        "step_size": _float(experiment.stepSize) if experiment else None,
        "variables": [[*_variable(variable, where), variable.name in faults] for variable in model.modelVariables],
        "units": {unit.name: _unit(unit) for unit in model.unitDefinitions},
        "display_units": {
            unit.name: {d.name: (float(d.factor or 1.0), float(d.offset or 0.0)) for d in unit.displayUnits}
            for unit in model.unitDefinitions
        },
    }


def _validated(path: Path, where: str) -> Any:
    from fmpy.model_description import ValidationError, read_model_description

    try:
        return read_model_description(str(path))
    except ValidationError as error:
        problems = list(getattr(error, "problems", None) or [str(error)])
        if all(problem.endswith("has no start value.") for problem in problems):
            return read_model_description(str(path), validate=False)  # matters only for inputs that nothing feeds
        more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        raise NavfmuError(f"{where}: is not valid: {problems[0]}{more}") from None
    except KeyError as error:  # FMPy looks units and types up by name
        raise NavfmuError(f"{where}: refers to {error}, which it does not define") from None
    except Exception as error:  # FMPy raises Exception, KeyError, ... on contents it does not expect
        raise NavfmuError(f"{where}: cannot be read: {error}") from None


def _identifier(name: str, where: str) -> str:
    if not name or not all(c.isalnum() or c == "_" for c in name):
        raise NavfmuError(f"{where}: modelIdentifier '{name}' is not an identifier of the C language")
    return name


def _unit(unit: Any) -> tuple[list[int] | None, float, float]:
    base = unit.baseUnit
    if base is None:
        return None, 1.0, 0.0
    exponents = [int(getattr(base, name) or 0) for name in ("kg", "m", "s", "A", "K", "mol", "cd", "rad")]
    return exponents, float(base.factor if base.factor is not None else 1.0), float(base.offset or 0.0)


def _fault_inputs(root: Any) -> set[str]:
    """Names of the inputs that carry this project's annotation for faults."""
    marked = root.iterfind("ModelVariables/ScalarVariable[@causality='input']")
    return {v.get("name") for v in marked if v.find("Annotations/Tool[@name='navfmu']/fault") is not None}


def _variable(variable: Any, where: str) -> list[Any]:
    declared = variable.declaredType

    def attribute(name: str) -> Any:
        value = getattr(variable, name)
        return getattr(declared, name, None) if value is None and declared is not None else value

    kind = variable.type
    try:
        return [
            variable.name,
            int(variable.valueReference),
            kind,
            variable.causality or "local",
            variable.variability or "continuous",
            variable.initial,
            _value(kind, variable.start),
            attribute("unit"),
            attribute("displayUnit"),
            _float(attribute("min")),
            _float(attribute("max")),
            _float(attribute("nominal")),
            variable.description or "",
        ]
    except ValueError as error:
        raise NavfmuError(f"{where}: variable '{variable.name}': {error}") from None


def _value(kind: str, text: Any) -> float | int | bool | str | None:
    if text is None:
        return None
    if kind == "Real":
        return float(text)
    if kind in ("Integer", "Enumeration"):
        return int(text)
    if kind == "Boolean":
        return str(text).lower() in ("true", "1")
    return str(text)


def _float(text: Any) -> float | None:
    return None if text is None else float(text)
