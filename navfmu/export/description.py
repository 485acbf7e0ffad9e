"""modelDescription.xml of FMI 2.0: everything a host shows and checks, from the lowered model alone."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from xml.sax.saxutils import quoteattr

from navfmu import __version__
from navfmu.constants import FOOT, KNOT, NAUTICAL_MILE, STANDARD_GRAVITY
from navfmu.errors import NavfmuError, nearest
from navfmu.export import life
from navfmu.export.printing.codegen import clocks, continuous_inputs
from navfmu.export.record import ir
from navfmu.export.record.arrays import tables_searched
from navfmu.export.record.graph import elements_used
from navfmu.fmi.units import BASE

#: Symbols that units are made of, such as m2/s3 or kg/m3: exponents of the base units (all factors are 1).
SYMBOLS: dict[str, dict[str, int]] = {
    "kg": {"kg": 1},
    "m": {"m": 1},
    "s": {"s": 1},
    "A": {"A": 1},
    "K": {"K": 1},
    "rad": {"rad": 1},
    "Hz": {"s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "T": {"kg": 1, "s": -2, "A": -1},
}
_BASE = ("kg", "m", "s", "A", "K", "rad")

_DEGREE = 57.29577951308232
#: Units that a host may show instead: displayed value = factor * value + offset.
DISPLAY_UNITS: dict[str, dict[str, tuple[float, float]]] = {
    "1": {"%": (100.0, 0.0), "ppm": (1e6, 0.0), "a": (1.0, 0.0)},
    "s": {"ms": (1e3, 0.0), "min": (1 / 60, 0.0), "h": (1 / 3600, 0.0)},
    "m": {"km": (1e-3, 0.0), "mm": (1e3, 0.0), "ft": (1 / FOOT, 0.0), "nmi": (1 / NAUTICAL_MILE, 0.0)},
    "m/s": {"kn": (1 / KNOT, 0.0), "km/h": (3.6, 0.0), "ft/min": (60 / FOOT, 0.0)},
    "m/s2": {"g": (1 / STANDARD_GRAVITY, 0.0), "mg": (1e3 / STANDARD_GRAVITY, 0.0)},
    "rad": {"deg": (_DEGREE, 0.0), "arcmin": (60 * _DEGREE, 0.0), "arcsec": (3600 * _DEGREE, 0.0)},
    "rad/s": {"deg/s": (_DEGREE, 0.0), "deg/h": (3600 * _DEGREE, 0.0), "deg/min": (60 * _DEGREE, 0.0)},
    "rad/s2": {"deg/s2": (_DEGREE, 0.0)},
    "Pa": {"hPa": (1e-2, 0.0), "inHg": (1 / 3386.389, 0.0)},
    "T": {"uT": (1e6, 0.0), "nT": (1e9, 0.0), "mG": (1e7, 0.0), "G": (1e4, 0.0)},
    "K": {"degC": (1.0, -273.15)},
    "V": {"mV": (1e3, 0.0)},
}

#: One part of a structured name: an identifier or anything in single quotes, and indices.
_PART = r"([A-Za-z_]\w*|'([^'\\]|\\.)+')(\[\d+(, ?\d+)*\])?"

_HEAD = '<?xml version="1.0" encoding="UTF-8"?>'


def describe(
    model: ir.Model,
    guid: str,
    *,
    sources: Sequence[str] = (),
    model_identifier: str | None = None,
    needs_execution_tool: bool = False,
    can_interpolate_inputs: bool = True,
) -> str:
    """Return modelDescription.xml of ``model``.

    The options are what a Python twin has otherwise: it needs a Python (``needs_execution_tool``), does not
    interpolate its inputs, and has no C ``sources``.
    """
    return "\n".join(
        _lines(model, guid, sources, model_identifier or model.name, needs_execution_tool, can_interpolate_inputs)
    )


def base_units(unit: str) -> dict[str, int]:
    """Return the exponents of the base units of an SI unit such as ``1``, ``m/s2``, ``N.m`` or ``rad2/s``."""
    exponents = dict.fromkeys(_BASE, 0)
    for match in re.finditer(r"(^|[./])([A-Za-z]+|1)(-?\d+)?(?=[./]|$)|(.)", unit or "?"):
        operator, symbol, power, rest = match.groups()
        if (
            rest
            or (symbol != "1" and symbol not in SYMBOLS)
            or (symbol == "1" and (power or operator))
            or (operator and not match.start())
        ):
            known = ["1", *SYMBOLS]
            raise NavfmuError(
                f"unknown unit '{unit}'; expected SI symbols with powers such as 'm/s2' or 'kg/m3', "
                f"made of {', '.join(known)}"
            )
        for name, exponent in SYMBOLS.get(symbol, {}).items():
            exponents[name] += exponent * int(power or 1) * (-1 if operator == "/" else 1)
    return {name: exponent for name, exponent in exponents.items() if exponent}


def check_units(model: ir.Model) -> None:
    """Raise when a unit is not SI (:func:`base_units`) or a display unit does not belong to it."""
    of_variables = [(f"variable '{v.name}'", v.unit or "1") for v in model.variables]
    of_tables = [
        (f"table '{table.name}', column '{column}'", unit)
        for table in model.tables
        for column, unit in zip(table.columns, table.units, strict=True)
    ]
    for what, unit in of_variables + of_tables:
        try:
            _base_of(model, unit)
        except NavfmuError as error:
            raise NavfmuError(f"component '{model.name}', {what}: {error}") from None
    for variable in model.variables:
        where = f"component '{model.name}', variable '{variable.name}'"
        unit, display = variable.unit, variable.display_unit
        if display is not None and display != unit and display not in DISPLAY_UNITS.get(unit or "", {}):
            known = DISPLAY_UNITS.get(unit or "", {})
            raise NavfmuError(
                f"{where}: unit '{unit}' cannot be displayed as '{display}'; "
                f"expected one of {', '.join([*known]) or 'no display unit'}{nearest(display, known)}"
            )


def display(variable: ir.Variable, value: float) -> tuple[float, str]:
    """Return a value in the variable's display unit, and that unit's name ("" for none)."""
    factor, offset = DISPLAY_UNITS.get(variable.unit or "", {}).get(variable.display_unit or "", (1.0, 0.0))
    offset = 0.0 if variable.difference else offset
    unit = variable.display_unit or variable.unit or ""
    return factor * value + offset, "" if unit == "1" else unit


def initial_unknowns(model: ir.Model) -> list[tuple[int, tuple[int, ...]]]:
    """Return the outputs calculated in initialisation, each with the variables that it depends on (indices in v).

    These are all that can be set then: inputs, parameters, states and outputs with a start value, and where random
    numbers are drawn, their seed and stream; where a table is searched, the string that names its file.
    """
    known = {i for v in model.variables if v.causality == "input" or v.initial == "exact" for i in v.indices}
    depends = {e.index: {e.index} & known for e in model.elements}
    strings = {v.name: v.index for v in model.variables if v.type == "String"}
    for task in model.tasks:
        if task.kind != "start":
            continue
        found = []
        every_used = elements_used(task.values, "v"), elements_used(task.values, "noise")
        for value, used, drawn in zip(task.values, *every_used, strict=True):
            seeds = {model.seed, model.stream} if drawn else set()
            names = {model.tables[i].named_by for i in tables_searched([value])} - {None}
            found.append(set().union(*(depends[i] for i in used | seeds | {strings[name] for name in names})))
        depends.update(zip(task.targets, found, strict=True))
    if model.through:
        seed = set() if model.seed is None else {model.seed}
        depends |= {index: seed.union(inputs) for index, inputs in model.through.dependencies.items()}
    return [
        (i, tuple(sorted(depends[i])))
        for v in model.variables
        if v.causality == "output" and v.initial == "calculated"
        for i in v.indices
    ]


def _lines(
    model: ir.Model, guid: str, sources: Sequence[str], identifier: str, needs_tool: bool, interpolate: bool
) -> Iterable[str]:
    check_units(model)
    yield _HEAD
    yield _tag(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0",
            "modelName": model.name,
            "guid": guid,
            "description": _one_line(model.description),
            "generationTool": f"navfmu {__version__}",
            "variableNamingConvention": "structured" if all(map(_is_structured, model.elements)) else "flat",
            "numberOfEventIndicators": 0,
        },
    )
    capabilities = {
        "modelIdentifier": identifier,
        "needsExecutionTool": needs_tool,
        "canHandleVariableCommunicationStepSize": model.through is None,
        "canInterpolateInputs": bool(interpolate and continuous_inputs(model)),
        "maxOutputDerivativeOrder": 0,
        "canRunAsynchronuously": False,
        "canBeInstantiatedOnlyOncePerProcess": False,
        "canNotUseMemoryManagementFunctions": True,
        "canGetAndSetFMUstate": not model.needs,
        "canSerializeFMUstate": not model.needs,
        "providesDirectionalDerivative": False,
    }
    yield "  " + _tag("CoSimulation", capabilities, closed=not sources)
    if sources:
        yield "    <SourceFiles>"
        yield from (f"      <File name={quoteattr(name)}/>" for name in sources)
        yield "    </SourceFiles>"
        yield "  </CoSimulation>"
    yield from _units(model)
    yield from _types(model)
    yield "  <LogCategories>"
    yield from (
        "    " + _tag("Category", {"name": n, "description": d}, closed=True) for n, d in life.categories().items()
    )
    yield "  </LogCategories>"
    periods = [model.elements[clock.period].start for clock in clocks(model)]
    step = min(periods, default=model.through.step if model.through else 0.01)
    experiment = {
        "startTime": 0.0,
        "stopTime": max(10.0, 100 * max(periods, default=0.01)),
        "tolerance": 1e-6,  # nothing inside integrates with one; hosts that want a tolerance take this
        "stepSize": step,
    }
    yield "  " + _tag("DefaultExperiment", experiment, closed=True)
    bundles = model.documentation.get("bundles") or {}
    if bundles:
        yield "  <VendorAnnotations>"
        yield '    <Tool name="navfmu">'
        yield "      <bundles>"
        for name, text in bundles.items():
            yield "        " + _tag("bundle", {"name": name, "description": _one_line(text) or None}, closed=True)
        yield "      </bundles>"
        yield "    </Tool>"
        yield "  </VendorAnnotations>"
    yield "  <ModelVariables>"
    elements = _depth_first(model.elements)
    for element in elements:
        yield from _variable(element)
    yield "  </ModelVariables>"
    yield from _structure(model, {element.index: place for place, element in enumerate(elements, 1)})
    yield "</fmiModelDescription>"
    yield ""


def _is_structured(element: ir.Element) -> bool:
    """Whether a name is one of the structured convention, FMI 2.0.4 section 2.2.9, without derivatives."""
    return re.fullmatch(rf"{_PART}(\.{_PART})*", element.name, flags=re.ASCII) is not None


def _depth_first(elements: Sequence[ir.Element]) -> list[ir.Element]:
    """The elements in the order of the structured convention: what belongs to one bundle is not parted by others."""
    paths = [re.findall(r"'(?:[^'\\]|\\.)+'|\[[^\]]*\]|\w+", element.name) for element in elements]
    first: dict[tuple[str, ...], int] = {}  # where what begins with these parts stands first
    for place, path in enumerate(paths):
        for depth in range(len(path)):
            first.setdefault(tuple(path[: depth + 1]), place)
    keys = [[first[tuple(path[: depth + 1])] for depth in range(len(path))] for path in paths]
    return [element for _, element in sorted(zip(keys, elements, strict=True), key=lambda pair: pair[0])]


def _units(model: ir.Model) -> Iterable[str]:
    used = sorted({v.unit for v in model.variables if v.unit is not None})
    if not used:
        return
    yield "  <UnitDefinitions>"
    for unit in used:
        yield f"    <Unit name={quoteattr(unit)}>"
        if (base := _base_of(model, unit)) is not None:
            yield "      " + _tag("BaseUnit", base, closed=True)
        for name, (factor, offset) in DISPLAY_UNITS.get(unit, {}).items():
            if any(v.unit == unit and v.display_unit == name for v in model.variables):
                numbers = {"name": name, "factor": factor, "offset": offset or None}
                yield "      " + _tag("DisplayUnit", numbers, closed=True)
        yield "    </Unit>"
    yield "  </UnitDefinitions>"


def _types(model: ir.Model) -> Iterable[str]:
    enumerations = dict.fromkeys(v.enumeration for v in model.variables if v.enumeration)
    if not enumerations:
        return
    yield "  <TypeDefinitions>"
    for enumeration in enumerations:
        yield f"    <SimpleType name={quoteattr(enumeration.name)}>"
        yield "      <Enumeration>"
        for name, number in enumeration.items:
            yield "        " + _tag("Item", {"name": name, "value": number}, closed=True)
        yield "      </Enumeration>"
        yield "    </SimpleType>"
    yield "  </TypeDefinitions>"


def _base_of(model: ir.Model, unit: str) -> Mapping[str, object] | None:
    """The attributes of a unit's definition; None: nothing is known but its name."""
    if unit not in model.units:
        return base_units(unit)
    own = model.units[unit]
    if own.exponents is None:
        return None
    powers = {name: power for name, power in zip(BASE, own.exponents, strict=True) if power}
    return powers | {"factor": own.factor if own.factor != 1.0 else None, "offset": own.offset or None}


def _variable(element: ir.Element) -> Iterable[str]:
    variable = element.variable
    attributes = {
        "name": element.name,
        "valueReference": element.index,
        "description": _one_line(variable.description + _bound(variable)) or None,
        "causality": variable.causality,
        "variability": variable.variability,
        "initial": variable.initial,
    }
    yield "    " + _tag("ScalarVariable", attributes)
    real, integer = variable.type == "Real", variable.type == "Integer"
    starts = variable.initial != "calculated"
    convert = {"Real": float, "Integer": round, "Boolean": bool, "String": lambda _: variable.texts[element.number]}

    def number(value: float | None) -> float | int | bool | str | None:
        return None if value is None else convert[variable.type](value)

    value = {
        "declaredType": variable.enumeration.name if variable.enumeration else None,
        "unit": variable.unit if real else None,
        "displayUnit": variable.display_unit if real and variable.display_unit != variable.unit else None,
        "relativeQuantity": True if variable.difference else None,
        "min": number(element.min) if real or integer else None,
        "max": number(element.max) if real or integer else None,
        "nominal": number(variable.nominal) if real else None,
        "start": number(element.start) if starts else None,
    }
    yield "      " + _tag("Enumeration" if variable.enumeration else variable.type, value, closed=True)
    if variable.fault:
        yield '      <Annotations><Tool name="navfmu"><fault/></Tool></Annotations>'
    yield "    </ScalarVariable>"


def _bound(variable: ir.Variable) -> str:
    """What FMI 2.0 has no attribute for."""
    return f" (at most {variable.longest} bytes)" if variable.type == "String" else ""


def _structure(model: ir.Model, places: Mapping[int, int]) -> Iterable[str]:
    """What depends on what, by the places of the variables in the list."""
    outputs = sorted((i for v in model.variables if v.causality == "output" for i in v.indices), key=places.get)
    if not outputs:
        yield "  <ModelStructure/>"
        return
    yield "  <ModelStructure>"
    yield "    <Outputs>"
    direct = model.through.dependencies if model.through and model.through.direct else {}
    for index in outputs:
        numbers = " ".join(map(str, sorted(places[i] for i in direct.get(index, ()))))
        yield f'      <Unknown index="{places[index]}" dependencies="{numbers}"/>'
    yield "    </Outputs>"
    unknowns = sorted(initial_unknowns(model), key=lambda unknown: places[unknown[0]])
    if unknowns:
        yield "    <InitialUnknowns>"
        for index, depends in unknowns:
            if model.needs:  # without dependencies: on all that is known
                yield f'      <Unknown index="{places[index]}"/>'
                continue
            numbers = " ".join(map(str, sorted(places[i] for i in depends)))
            yield f'      <Unknown index="{places[index]}" dependencies="{numbers}"/>'
        yield "    </InitialUnknowns>"
    yield "  </ModelStructure>"


def _tag(name: str, attributes: dict[str, object], closed: bool = False) -> str:
    words = [name]
    for key, value in attributes.items():
        if value is not None:
            text = str(value).lower() if isinstance(value, bool) else repr(value) if isinstance(value, float) else value
            words.append(f"{key}={quoteattr(str(text))}")
    return f"<{' '.join(words)}{'/' if closed else ''}>"


def _one_line(text: str) -> str:
    return " ".join(text.split())
