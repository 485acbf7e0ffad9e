"""Writes systems: a Python description of components, connections, parameters and variants becomes an SSP.

    source = SystemSource("backup_navigator", fmus="dist", stop_time=2100, step=0.01)
    source.component("imu", "imu.fmu")
    source.connect("aircraft.rate", "imu.rate")          # arrays and bundles connect member by member
    source.parameters("imu", {"gyro_drift_sigma": "1 deg/h"}, name="imu_tactical")
    source.variant("scanning", parameters={"dme": {"mode": 3}})
    source.write("system")                               # a folder that runs
    source.pack("dist/backup_navigator.ssp")             # the same as one file

The result is the subset of SSP that other hosts read too: flat, no connectors at the root, only connectors that are
connected inputs or outputs, the same unit at both ends, and one parameter set for each component, always named
``initialValues`` (libcosim applies the first set of a component, Ecos the sets of one name).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any
from xml.sax.saxutils import escape

from navfmu.errors import NavfmuError, nearest
from navfmu.files.archive import zipped
from navfmu.files.characters import illegal
from navfmu.files.reading import read_bytes, what_is
from navfmu.files.writing import write_file
from navfmu.fmi.description import Description, Variable
from navfmu.fmi.fmu import describe
from navfmu.fmi.names import folded, is_element, members
from navfmu.fmi.units import BASE, Unit, conversion
from navfmu.fmi.values import expand
from navfmu.ssp.document import MAIN, NAMESPACES, OMS, OSP, PARAMETER_SET, RESOURCES
from navfmu.ssp.reader import read_parameters
from navfmu.ssp.structure import Setting


@dataclass
class _Variant:
    description: str
    stop_time: float | None
    step: float | None
    components: dict[str, Path] = field(default_factory=dict)
    connections: dict[tuple[str, str], tuple[str, str]] = field(default_factory=dict)  # input -> output
    values: dict[str, dict[str, Any]] = field(default_factory=dict)  # component -> variable -> value
    set_names: dict[str, str] = field(default_factory=dict)  # component -> file name of its parameter set


class SystemSource:
    """A system under construction. Every mistake is a sentence at the call that made it."""

    def __init__(
        self,
        name: str,
        *,
        fmus: str | Path = ".",
        description: str = "",
        stop_time: float | None = None,
        step: float | None = None,
    ) -> None:
        """``fmus``: folder of the FMU files; ``stop_time`` (s) and ``step`` (s) are the suggested experiment."""
        _check_text("SystemSource: name", name)
        _check_text(f"{name}: description", description)
        self.name = name
        self.folder = Path(fmus)
        self._base = _Variant(description, stop_time, step)
        self._variants: dict[str, _Variant] = {}
        self._extra: dict[str, bytes] = {}
        self._descriptions: dict[Path, Description] = {}

    def component(self, name: str, fmu: str | Path) -> SystemSource:
        """Add an instance of an FMU; the order of components is the order in the document."""
        if name in self._base.components:
            raise NavfmuError(f"{self.name}: there are two components named '{name}'")
        self._add(self._base, name, fmu)
        return self

    def connect(self, start: str, end: str) -> SystemSource:
        """Connect an output to an input; arrays element by element, bundles by the names of the input's members."""
        where = f"{self.name}: connection '{start}' -> '{end}'"
        for input_, output in self._pairs(start, end, self._base.components, where).items():
            if input_ in self._base.connections:
                raise NavfmuError(f"{where}: input '{'.'.join(input_)}' is connected already")
            self._base.connections[input_] = output
        return self

    def parameters(
        self, component: str, values: Mapping[str, Any] | str | Path, name: str | None = None
    ) -> SystemSource:
        """Give a component parameters (or start values of inputs); ``name`` names the file of its parameter set.

        ``values`` may be the path of an .ssv, one of those beside the built FMUs for example, whose name is then the
        default.
        """
        if isinstance(values, str | Path):
            name = name or Path(values).stem
            values = {
                s.name: _in_own_unit(self._of(component, self._base.components), s) for s in read_parameters(values)
            }
        self._set(self._base, component, values, name)
        return self

    def variant(
        self,
        name: str,
        *,
        parameters: Mapping[str, Mapping[str, Any]] | None = None,
        sets: Mapping[str, str] | None = None,
        components: Mapping[str, str | Path] | None = None,
        connections: Mapping[str, str] | None = None,
        description: str = "",
        stop_time: float | None = None,
        step: float | None = None,
    ) -> SystemSource:
        """Add a sibling system that differs in what is laid over the base: parameters, FMUs of components, connections.

        ``connections`` are outputs by the inputs that they feed, in the place of those of the base or beside them; with
        them ``components`` may be new ones. ``sets`` names the file of a component's parameter set where
        ``component_variant`` does not say enough.
        """
        _check_text(f"{self.name}: variant", name)
        _check_text(f"{self.name}: variant '{name}': description", description)
        if name in self._variants or f"{name}.ssd" == MAIN:
            raise NavfmuError(f"{self.name}: there are two variants named '{name}'")
        variant = _Variant(description, stop_time, step)
        named = {end.partition(".")[0] for pair in (connections or {}).items() for end in pair}
        for component, fmu in (components or {}).items():
            if component not in named:
                self._known(component, self._base.components)
            self._add(variant, component, fmu)
        for end, start in (connections or {}).items():
            where = f"{self.name}: variant '{name}': connection '{start}' -> '{end}'"
            variant.connections |= self._pairs(start, end, self._base.components | variant.components, where)
        for component, values in (parameters or {}).items():
            self._set(variant, component, values, (sets or {}).get(component) or f"{component}_{name}")
        self._variants[name] = variant
        return self

    def attach(self, name: str, file: str | Path) -> SystemSource:
        """Carry a file along, for example ``faults/gps_lost.toml``; it lands under ``extra/`` of the package."""
        where = f"{self.name}: attachment '{name}'"
        path = PurePosixPath(name)
        if path.is_absolute() or ".." in path.parts or "\\" in name or not path.name:
            raise NavfmuError(f"{where}: expected a name such as faults/gps_lost.toml")
        try:
            self._extra[f"extra/{path}"] = read_bytes(file, "a file")
        except NavfmuError as error:
            raise NavfmuError(f"{where}: {error}") from None
        return self

    @property
    def variants(self) -> tuple[str, ...]:
        """Names of the variants beside the base system."""
        return tuple(self._variants)

    def files(self) -> dict[str, bytes]:
        """All documents by relative path, without the FMUs: the same text for the same calls."""
        files: dict[str, bytes] = {}
        for name in (None, *self._variants):
            for path, text in self._documents(name).items():
                if files.setdefault(path, text) != text:
                    raise NavfmuError(
                        f"{self.name}: two different parameter sets are named '{Path(path).stem}': name them apart"
                    )
        return files

    def write(self, folder: str | Path, *, fmus: bool = True) -> list[Path]:
        """Write the system into a folder, ready to run, and return the paths.

        The FMUs go to ``resources/``, attachments to ``extra/``; ``fmus=False`` writes the documents alone. A file that
        has not changed stays untouched.
        """
        written = []
        for name, content in (self._content(None) if fmus else self.files()).items():
            path = Path(folder) / name
            if what_is(path) != "a file" or path.read_bytes() != content:
                write_file(path, content)
            written.append(path)
        return written

    def pack(self, file: str | Path, variant: str | None = None) -> Path:
        """Pack documents, FMUs and attachments into an .ssp; with ``variant`` only that one, as its main system.

        The same content gives the same bytes.
        """
        return write_file(file, zipped(self._content(variant), stored=".fmu"))

    def _content(self, variant: str | None) -> dict[str, bytes]:
        """Everything by relative path, the main document first: of the whole system, or of one variant alone."""
        if variant is None:
            entries = self.files()
            used = {f for v in (None, *self._variants) for f in self._components(v).values()}
        else:
            entries = self._documents(variant)
            entries = {(MAIN if name.endswith(".ssd") else name): content for name, content in entries.items()}
            used = set(self._components(variant).values())
        entries |= self._extra
        for fmu in used:
            name = f"{RESOURCES}/{fmu.name}"
            content = fmu.read_bytes()
            if entries.setdefault(name, content) != content:
                raise NavfmuError(f"{self.name}: two different FMUs are named {fmu.name}")
        return {name: entries[name] for name in sorted(entries, key=lambda name: (name != MAIN, name))}

    # -- what was said so far ------------------------------------------------------------------------------------

    def _file(self, fmu: str | Path) -> Path:
        _check_text(f"{self.name}: file name of an FMU", Path(fmu).name)
        return self.folder / fmu

    def _describe(self, path: Path) -> Description:
        if path not in self._descriptions:
            self._descriptions[path] = describe(path)
        return self._descriptions[path]

    def _add(self, to: _Variant, name: str, fmu: str | Path) -> None:
        if not name or "." in name:
            raise NavfmuError(f"{self.name}: component name '{name}' must not be empty or contain a dot")
        _check_text(f"{self.name}: component", name)
        to.components[name] = self._file(fmu)
        self._describe(to.components[name])

    def _pairs(
        self, start: str, end: str, components: Mapping[str, Path], where: str
    ) -> dict[tuple[str, str], tuple[str, str]]:
        """Outputs by the inputs that they feed, each (component, variable), of a connection of arrays or bundles."""
        (source, output), (target, input_) = self._split(start, where), self._split(end, where)
        outputs = members(self._of(source, components), output, {"output"}, where)
        inputs = members(self._of(target, components), input_, {"input"}, where)
        found = {}
        for suffix, variable in inputs.items():
            other = outputs.get(suffix)
            if other is None:
                has = ", ".join(folded(found.name for found in outputs.values()))
                raise NavfmuError(f"{where}: '{start}' has no '{suffix.lstrip('.') or end}'; it has: {has}")
            _check_pair(other, variable, where)
            found[target, variable.name] = source, other.name
        if all(map(is_element, inputs)) and len(outputs) != len(inputs):
            raise NavfmuError(f"{where}: the output has {len(outputs)} elements, the input {len(inputs)}")
        return found

    def _known(self, component: str, known: Mapping[str, Path]) -> None:
        if component not in known:
            raise NavfmuError(f"{self.name}: there is no component '{component}'{nearest(component, known)}")

    def _of(self, component: str, components: Mapping[str, Path]) -> Description:
        self._known(component, components)
        return self._describe(components[component])

    def _split(self, name: str, where: str) -> tuple[str, str]:
        component, dot, variable = name.partition(".")
        if not dot:
            raise NavfmuError(f"{where}: '{name}' is not of the form component.variable")
        return component, variable

    def _components(self, variant: str | None) -> dict[str, Path]:
        if variant is None:
            return self._base.components
        if variant not in self._variants:
            raise NavfmuError(f"{self.name}: there is no variant '{variant}'{nearest(variant, self._variants)}")
        return self._base.components | self._variants[variant].components

    def _set(self, variant: _Variant, component: str, values: Mapping[str, Any], name: str | None) -> None:
        description = self._of(component, self._base.components | variant.components)
        flat = expand(description, values, f"{self.name}: {component}")
        for key, value in flat.items():
            if isinstance(value, str):
                _check_text(f"{self.name}: {component}: '{key}'", value)
        variant.values.setdefault(component, {}).update(flat)
        if name is not None:
            _check_text(f"{self.name}: {component}: name of the parameter set", name)
            variant.set_names[component] = name

    # -- the documents -------------------------------------------------------------------------------------------

    def _documents(self, variant: str | None) -> dict[str, bytes]:
        special = self._variants.get(variant, _Variant("", None, None))
        components = self._components(variant)
        files: dict[str, bytes] = {}
        bindings: dict[str, str] = {}
        for component in components:
            values = self._base.values.get(component, {}) | special.values.get(component, {})
            if component in special.components:  # another FMU: what it does not know does not apply
                known = self._of(component, components).by_name
                values = {key: value for key, value in values.items() if key in known}
            if values:
                name = special.set_names.get(component) or self._base.set_names.get(component) or component
                if component in special.components and component not in special.set_names:
                    name = f"{component}_{variant}"
                bindings[component] = f"{RESOURCES}/{name}.ssv"
                files[bindings[component]] = values_document(self._of(component, components), values, name)
        files[MAIN if variant is None else f"{variant}.ssd"] = self._system_document(variant, special, bindings)
        return files

    def _system_document(self, variant: str | None, special: _Variant, bindings: dict[str, str]) -> bytes:
        stop_time = special.stop_time if special.stop_time is not None else self._base.stop_time
        step = special.step if special.step is not None else self._base.step
        units: dict[str, Unit] = {}
        lines = [
            '<?xml version="1.0" encoding="UTF-8"?>',
            _open(
                "ssd:SystemStructureDescription",
                version="1.0",
                name=f"{self.name}_{variant}" if variant else self.name,
                **_xmlns("oms", "osp", "ssc", "ssd"),
            ),
            "  " + _open("ssd:System", name=self.name, description=special.description or self._base.description),
            "    <ssd:Elements>",
        ]
        connections = self._base.connections | special.connections
        for component, path in self._components(variant).items():
            lines += self._component(component, path, connections.keys(), bindings.get(component), units)
        lines.append("    </ssd:Elements>")
        if connections:
            lines.append("    <ssd:Connections>")
            for (end, input_), (start, output) in connections.items():
                self._check_still_there(variant, start, output, end, input_)
                connection = {
                    "startElement": start, "startConnector": output, "endElement": end, "endConnector": input_
                }  # fmt: skip
                lines.append("      " + _open("ssd:Connection", close=True, **connection))
            lines.append("    </ssd:Connections>")
        if step is not None:
            suggested = (self._describe(path).tolerance for path in self._components(variant).values())
            lines += _simulation(step, min((t for t in suggested if t is not None), default=1e-6))
        lines.append("  </ssd:System>")
        lines += _unit_lines("ssd:Units", units)
        if stop_time is not None or step is not None:
            lines += _experiment(stop_time, step)
        lines.append("</ssd:SystemStructureDescription>")
        return ("\n".join(lines) + "\n").encode()

    def _component(
        self, name: str, path: Path, fed: Collection[tuple[str, str]], binding: str | None, units: dict[str, Unit]
    ) -> list[str]:
        description = self._describe(path)
        head = {
            "name": name,
            "type": "application/x-fmu-sharedlibrary",
            "source": f"{RESOURCES}/{path.name}",
            "implementation": "CoSimulation",
            "description": description.description,
        }
        lines = ["      " + _open("ssd:Component", **head)]
        shown = [
            variable
            for variable in description.variables
            if variable.causality == "output" or (variable.causality == "input" and (name, variable.name) in fed)
        ]
        if shown:
            lines.append("        <ssd:Connectors>")
            for variable in shown:
                lines.append("          " + _open("ssd:Connector", name=variable.name, kind=variable.causality))
                lines.append("            " + _type(variable))
                lines.append("          </ssd:Connector>")
                _note_unit(units, variable, description)
            lines.append("        </ssd:Connectors>")
        if binding:
            lines.append("        <ssd:ParameterBindings>")
            lines.append("          " + _open("ssd:ParameterBinding", close=True, source=binding))
            lines.append("        </ssd:ParameterBindings>")
        lines.append("      </ssd:Component>")
        return lines

    def _check_still_there(self, variant: str | None, start: str, output: str, end: str, input_: str) -> None:
        where = f"{self.name}, variant {variant}: connection '{start}.{output}' -> '{end}.{input_}'"
        source = self._of(start, self._components(variant)).variable(output, where)
        target = self._of(end, self._components(variant)).variable(input_, where)
        _check_pair(source, target, where)


def values_document(description: Description, values: Mapping[str, Any], text: str) -> bytes:
    """The .ssv of an FMU: ``values`` by name of the variable, and a ``text`` that says what they are."""
    units: dict[str, Unit] = {}
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        _open("ssv:ParameterSet", version="1.0", name=PARAMETER_SET, description=text, **_xmlns("ssc", "ssv")),
        "  <ssv:Parameters>",
    ]
    for variable in description.variables:
        if variable.name in values:
            lines.append("    " + _open("ssv:Parameter", name=variable.name))
            lines.append("      " + _value(variable, values[variable.name]))
            lines.append("    </ssv:Parameter>")
            _note_unit(units, variable, description)
    lines.append("  </ssv:Parameters>")
    lines += _unit_lines("ssv:Units", units)
    lines.append("</ssv:ParameterSet>")
    return ("\n".join(lines) + "\n").encode()


def _in_own_unit(description: Description, setting: Setting) -> Any:
    """The value of a setting in the unit of its variable; one that the FMU does not have is refused later."""
    variable = description.by_name.get(setting.name)
    if variable is None or setting.type != "Real":
        return setting.value
    own, where = description.units.get(variable.unit or ""), f"{setting.where}: '{setting.name}'"
    factor, offset = conversion(setting.unit, own, where, difference=variable.relative)
    return factor * setting.value + offset


def _check_pair(source: Variable, target: Variable, where: str) -> None:
    if source.type != target.type:
        raise NavfmuError(f"{where}: '{source.name}' is {source.type}, '{target.name}' is {target.type}")
    if source.relative != target.relative:
        kinds = ["a difference (relativeQuantity)" if v.relative else "none" for v in (source, target)]
        raise NavfmuError(f"{where}: '{source.name}' is {kinds[0]}, '{target.name}' is {kinds[1]}")
    if source.unit != target.unit:
        raise NavfmuError(
            f"{where}: '{source.name}' is in {source.unit or 'no unit'}, "
            f"'{target.name}' in {target.unit or 'no unit'}; "
            "a system that other hosts run needs the same unit at both ends"
        )


def _xmlns(*prefixes: str) -> dict[str, str]:
    return {f"xmlns:{prefix}": NAMESPACES[prefix] for prefix in prefixes}


def _open(element: str, close: bool = False, **attributes: str) -> str:
    text = "".join(f' {key}="{_attribute(value)}"' for key, value in attributes.items() if value)
    return f"<{element}{text}{'/' if close else ''}>"


def _attribute(text: str) -> str:
    return escape(text, {'"': "&quot;", "\n": "&#10;", "\r": "&#13;", "\t": "&#9;"})


def _type(variable: Variable) -> str:
    if variable.type == "Real":
        return _open("ssc:Real", close=True, unit=variable.unit or "")
    return f"<ssc:{variable.type}/>"


def _value(variable: Variable, value: Any) -> str:
    if variable.type == "Real":
        return _open("ssv:Real", close=True, value=repr(float(value)), unit=variable.unit or "")
    if variable.type == "Boolean":
        return _open("ssv:Boolean", close=True, value="true" if value else "false")
    return f'<ssv:{variable.type} value="{_attribute(str(value))}"/>'


def _note_unit(units: dict[str, Unit], variable: Variable, description: Description) -> None:
    if variable.type == "Real" and variable.unit:
        units.setdefault(variable.unit, description.units.get(variable.unit) or Unit(variable.unit))


def _unit_lines(element: str, units: dict[str, Unit]) -> list[str]:
    if not units:
        return []
    lines = [f"  <{element}>"]
    for name in sorted(units):
        unit = units[name]
        powers = {base: str(power) for base, power in zip(BASE, unit.exponents or (), strict=False) if power}
        if unit.factor != 1.0:
            powers["factor"] = repr(unit.factor)
        if unit.offset != 0.0:
            powers["offset"] = repr(unit.offset)
        lines += [f"    {_open('ssc:Unit', name=name)}", f"      {_open('ssc:BaseUnit', close=True, **powers)}"]
        lines.append("    </ssc:Unit>")
    return [*lines, f"  </{element}>"]


def _simulation(step: float, tolerance: float) -> list[str]:
    """The annotation of the system with which OMSimulator's command line runs it.

    Without a tolerance it would give FMUs one of 0.
    """
    master = {"description": "oms-ma", "stepSize": repr(float(step)), "relativeTolerance": repr(float(tolerance))}
    return [
        "    <ssd:Annotations>",
        f'      <ssc:Annotation type="{OMS}">',
        "        <oms:Annotations>",
        "          <oms:SimulationInformation>",
        "            " + _open("oms:FixedStepMaster", close=True, **master),
        "          </oms:SimulationInformation>",
        "        </oms:Annotations>",
        "      </ssc:Annotation>",
        "    </ssd:Annotations>",
    ]


def _experiment(stop_time: float | None, step: float | None) -> list[str]:
    """Start and stop time; the step stands in the annotation that libcosim reads."""
    attributes = {"startTime": "0.0"} | ({} if stop_time is None else {"stopTime": repr(float(stop_time))})
    if step is None:
        return ["  " + _open("ssd:DefaultExperiment", close=True, **attributes)]
    return [
        "  " + _open("ssd:DefaultExperiment", **attributes),
        "    <ssd:Annotations>",
        f'      <ssc:Annotation type="{OSP}">',
        "        <osp:Algorithm>",  # libcosim takes an attribute here for the algorithm's name
        "          " + _open("osp:FixedStepAlgorithm", close=True, baseStepSize=repr(float(step))),
        "        </osp:Algorithm>",
        "      </ssc:Annotation>",
        "    </ssd:Annotations>",
        "  </ssd:DefaultExperiment>",
    ]


def _check_text(where: str, text: str) -> None:
    """Refuse what an XML document cannot hold."""
    if wrong := illegal(text):
        raise NavfmuError(f"{where}: the text {text!r} has the character {wrong}, which XML cannot hold")
