"""Reads modelDescription.xml with FMPy, which validates it; takes about 30 ms."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from navfmu.errors import NavfmuError
from navfmu.files.archive import open_archive, read_entry
from navfmu.files.markup import parse


def read(path: Path) -> dict[str, Any]:
    """The model description of an FMU as plain data, validated."""
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

    kind = "Integer" if variable.type == "Enumeration" else variable.type
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
            variable.type == "Enumeration",
        ]
    except ValueError as error:
        raise NavfmuError(f"{where}: variable '{variable.name}': {error}") from None


def _value(kind: str, text: Any) -> float | int | bool | str | None:
    if text is None:
        return None
    if kind == "Real":
        return float(text)
    if kind == "Integer":
        return int(text)
    if kind == "Boolean":
        return str(text).lower() in ("true", "1")
    return str(text)


def _float(text: Any) -> float | None:
    return None if text is None else float(text)
