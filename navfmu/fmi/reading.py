"""Reads modelDescription.xml with FMPy; takes about 30 ms.

What is not as FMI 2.0 has it, but clear all the same, is read; a sentence for each such habit stands in the
description, and ``--strict`` refuses it.
"""

from __future__ import annotations

import importlib.util
import io
import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from navfmu.errors import NavfmuError
from navfmu.files.archive import habits, open_archive, read_entry, zipped
from navfmu.files.markup import parse, validate
from navfmu.fmi.definitions import repeated
from navfmu.fmi.functions import lacking
from navfmu.fmi.units import BASE, Unit

NAME = "modelDescription.xml"
#: Problems of the schema that do not matter here: no outputs, and a date that nobody reads.
HARMLESS = r"Missing child element\(s\)|attribute 'generationDateAndTime'"
#: By causality: the variabilities that FMI allows, and ``initial`` where another stands there and it is not given.
COMBINATIONS = {
    "parameter": (("fixed", "tunable"), "exact"),
    "calculatedParameter": (("fixed", "tunable"), "calculated"),
    "output": (("constant", "discrete", "continuous"), "calculated"),
}


def read(path: Path) -> dict[str, Any]:
    """The model description of an FMU as plain data."""
    where, lenient = f"{path}: {NAME}", []
    with open_archive(path, "FMU") as archive:
        lenient += habits(archive)
        said: list[str] = []
        root = parse(read_entry(archive, NAME, path), where, said)
    version = root.get("fmiVersion")
    if root.tag != "fmiModelDescription" or version is None:
        raise NavfmuError(f"{where}: is not a model description: expected <fmiModelDescription fmiVersion=...>")
    if version != "2.0":
        raise NavfmuError(
            f"{where}: is for FMI {version}, expected FMI 2.0: FMUs of FMI 1 and FMI 3 cannot be run yet; "
            "export it for FMI 2.0 co-simulation"
        )
    if root.find("CoSimulation") is None:
        raise NavfmuError(f"{where}: has no CoSimulation element: the FMU offers model exchange only")
    validate(root, _schema(), where, said, HARMLESS)
    said += _leave_out_structure(root, where)
    model = _model(root, where)
    problems = [*repeated(root, where), *_problems(model, where)]
    lenient += [text.removeprefix(f"{path}: ") for text in said] + [f"{NAME}: {text}" for text in _alike(problems)]
    interface = model.coSimulation
    if not interface.modelIdentifier.isidentifier():
        lenient.append(f"{NAME}: modelIdentifier '{interface.modelIdentifier}' is not an identifier of the C language")
    identifier = _file_name(interface.modelIdentifier, where)
    abilities = {
        "can_get_and_set_state": bool(interface.canGetAndSetFMUstate),
        "can_serialize_state": bool(interface.canSerializeFMUstate),
        "can_interpolate_inputs": bool(interface.canInterpolateInputs),
        "can_handle_variable_step": bool(interface.canHandleVariableCommunicationStepSize),
    }
    with open_archive(path, "FMU") as archive:
        lenient += lacking(archive, path, identifier, abilities)
    differences, faults = _differences(root), _fault_inputs(root)
    units, display_units = _units(model, lenient), _display_units(model, lenient)
    experiment = model.defaultExperiment
    return {
        "fmi_version": version,
        "model_name": model.modelName,
        "guid": model.guid,
        "model_identifier": identifier,
        "description": model.description or "",
        "version": model.version or "",
        "generation_tool": model.generationTool or "",
        "needs_execution_tool": bool(interface.needsExecutionTool),
        "only_one_instance": bool(interface.canBeInstantiatedOnlyOncePerProcess),
        **abilities,
        "max_output_derivative_order": int(interface.maxOutputDerivativeOrder or 0),
        "stop_time": _float(experiment.stopTime) if experiment else None,
        "step_size": _float(experiment.stepSize) if experiment else None,
        "tolerance": _tolerance(experiment.tolerance, lenient) if experiment else None,
        "variables": [
            [*_variable(variable, where), variable.name in differences, variable.name in faults]
            for variable in model.modelVariables
        ],
        "units": units,
        "display_units": display_units,
        "enumerations": {
            kind.name: {item.name: int(item.value) for item in kind.items}
            for kind in model.typeDefinitions
            if kind.type == "Enumeration"
        },
        "dependencies": _dependencies(model),
        "lenient": lenient,
    }


def _schema() -> Path:
    """FMI's schema, as FMPy ships it."""
    package = importlib.util.find_spec("fmpy")
    return Path(package.origin).parent / "schema" / "fmi2" / "fmi2ModelDescription.xsd"


def _model(root: Any, where: str) -> Any:
    """FMPy's model description."""
    from fmpy.model_description import read_model_description
    from lxml import etree

    for variable in root.iterfind("ModelVariables/ScalarVariable"):
        allowed, initial = COMBINATIONS.get(variable.get("causality"), ((), ""))
        if allowed and variable.get("variability", "continuous") not in allowed and "initial" not in variable.attrib:
            variable.set("initial", initial)  # with it FMPy reads on and says later what is wrong
    try:
        return read_model_description(io.BytesIO(zipped({NAME: etree.tostring(root)})), validate=False)
    except Exception as error:  # FMPy raises Exception, KeyError, ... on contents it does not expect
        raise NavfmuError(f"{where}: cannot be read: {error}") from None


def _problems(model: Any, where: str) -> Iterator[str]:
    """What FMPy finds wrong; units that are not defined become known by name."""
    from fmpy.model_description import Unit
    from fmpy.validation import validate_model_description

    defined = {unit.name for unit in model.unitDefinitions}
    used: dict[str, None] = {}  # a set that keeps its order
    for variable in model.modelVariables:
        declared = variable.declaredType
        unit = variable.unit if variable.unit is not None or declared is None else declared.unit
        if unit is not None:
            used[unit] = None
        elif variable.displayUnit is not None:
            yield f'The variable "{variable.name}" has a display unit and no unit.'
            variable.displayUnit = None
        items = [int(item.value) for item in declared.items] if variable.type == "Enumeration" and declared else []
        if items and variable.start is not None and int(variable.start) not in items:
            yield f'The start value {variable.start} of the variable "{variable.name}" is no item of its enumeration.'
    unknown = [unit for unit in used if unit not in defined]
    if unknown:
        yield f"Not defined: unit{'s' if len(unknown) > 1 else ''} {', '.join(repr(unit) for unit in unknown)}."
    model.unitDefinitions += [Unit(name=unit) for unit in unknown]
    yield from (re.sub(r" \(line \d+\)", "", problem) for problem in validate_model_description(model))
    names = Counter(variable.name for variable in model.modelVariables)
    twice = next((name for name, count in names.items() if count > 1), None)
    if twice is not None:
        raise NavfmuError(f"{where}: two variables are named '{twice}'")


def _dependencies(model: Any) -> dict[str, list[str]]:
    """The inputs on which outputs depend while initialising, of those outputs for which ModelStructure says it.

    What it says of the outputs of a step holds for those that are not initial unknowns. A dependency on another
    unknown is one on the inputs of that.
    """
    said = {u.variable.name: u.dependencies for u in (*model.outputs, *model.initialUnknowns)}
    behind = {name: _inputs_behind(name, said) for name in (u.variable.name for u in model.outputs)}
    return {name: inputs for name, inputs in behind.items() if inputs is not None}


def _inputs_behind(name: str, said: Mapping[str, list[Any] | None]) -> list[str] | None:
    """The inputs behind an unknown; None where one on the way does not say on what it depends."""
    inputs: dict[str, None] = {}  # a set that keeps its order
    met, left = {name}, [name]
    while left:
        dependencies = said[left.pop()]
        if dependencies is None:
            return None
        for variable in dependencies:
            if variable.causality == "input":
                inputs[variable.name] = None
            elif variable.name in said and variable.name not in met:
                met.add(variable.name)
                left.append(variable.name)
    return list(inputs)


def _alike(problems: Iterable[str]) -> list[str]:
    """Problems that differ in names only become one sentence."""
    kinds: dict[str, list[str]] = {}
    for problem in problems:
        kinds.setdefault(re.sub(r'variable "[^"]*"', "", problem), []).append(problem)
    found = []
    for first, *others in kinds.values():
        more = f" ({len(others)} more like it)" if others else ""
        found.append(first[:1].lower() + first[1:].rstrip(".") + more)
    return found


def _file_name(name: str, where: str) -> str:
    if re.fullmatch(r"\w[\w .+-]*", name) is None:
        raise NavfmuError(f"{where}: modelIdentifier '{name}' is not an identifier of the C language")
    return name


def _units(model: Any, lenient: list[str]) -> dict[str, tuple[list[int] | None, float, float]]:
    """Exponents, factor and offset of units; of one that has no base unit, or no numbers to convert with, its name."""
    units: dict[str, tuple[list[int] | None, float, float]] = {}
    for unit in model.unitDefinitions:
        units[unit.name] = None, 1.0, 0.0
        base = unit.baseUnit
        if base is not None and _sound(f"unit '{unit.name}'", *_scale(base), lenient):
            units[unit.name] = [int(getattr(base, name) or 0) for name in BASE], *_scale(base)
    return units


def _display_units(model: Any, lenient: list[str]) -> dict[str, dict[str, tuple[float, float]]]:
    return {
        unit.name: {
            shown.name: _scale(shown)
            for shown in unit.displayUnits
            if _sound(f"display unit '{shown.name}'", *_scale(shown), lenient)
        }
        for unit in model.unitDefinitions
    }


def _scale(unit: Any) -> tuple[float, float]:
    return float(1.0 if unit.factor is None else unit.factor), float(unit.offset or 0.0)


def _sound(what: str, factor: float, offset: float, lenient: list[str]) -> bool:
    sound = Unit(what, None, factor, offset).sound
    if not sound:
        lenient.append(f"{NAME}: {what} has the factor {factor:g} and the offset {offset:g}: nothing can be converted")
    return sound


def _tolerance(text: Any, lenient: list[str]) -> float | None:
    """The tolerance that an FMU suggests, which is a positive number or none."""
    value = _float(text)
    if value is None or 0.0 < value < math.inf:
        return value
    lenient.append(f"{NAME}: the tolerance of its default experiment, {value:g}, is none and is left out")
    return None


def _leave_out_structure(root: Any, where: str) -> Iterator[str]:
    """Empty a ModelStructure that names variables which are not there, for example because it counts from 0."""
    count = len(root.findall("ModelVariables/ScalarVariable"))
    for unknown in root.iterfind("ModelStructure//Unknown"):
        for index in (unknown.get("index"), *(unknown.get("dependencies") or "").split()):
            if not 1 <= int(index) <= count:
                root.find("ModelStructure").clear()
                place = f"{where}, line {unknown.sourceline}: ModelStructure"
                yield f"{place} names the variable {index} of {count}, counted from 1: what it says is left out"
                return


def _differences(root: Any) -> set[str]:
    """Names of the variables that are differences, by themselves or by their types; FMPy reads it of types only."""
    yes, types = ("true", "1"), {}
    for declared in root.iterfind("TypeDefinitions/SimpleType"):
        real = declared.find("Real")
        types[declared.get("name")] = None if real is None else real.get("relativeQuantity")
    reals = root.iterfind("ModelVariables/ScalarVariable/Real")
    return {
        real.getparent().get("name")
        for real in reals
        if real.get("relativeQuantity", types.get(real.get("declaredType"))) in yes
    }


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
    variability = variable.variability or "continuous"
    try:
        return [
            variable.name,
            int(variable.valueReference),
            kind,
            variable.causality or "local",
            variability if kind == "Real" or variability != "continuous" else "discrete",
            variable.initial,
            None if variable.initial == "calculated" else _value(kind, variable.start),
            attribute("unit"),
            attribute("displayUnit"),
            _float(attribute("min")),
            _float(attribute("max")),
            _float(attribute("nominal")),
            variable.description or "",
            None if variable.type != "Enumeration" else declared.name if declared is not None else "an enumeration",
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
