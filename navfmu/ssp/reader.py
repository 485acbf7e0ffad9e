"""Reads systems: SSP 1.0 packages, folders and single SSD files, with parameter sets and mappings.

Everything in the documents either takes effect, or is an error, or is listed in ``Structure.ignored``. What is not as
SSP has it, but clear all the same, is read and listed in ``Structure.lenient``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from navfmu.errors import NavfmuError, nearest
from navfmu.files.archive import habits, open_archive, unpack
from navfmu.files.digest import content_hash
from navfmu.files.markup import parse, validate
from navfmu.files.reading import read_bytes, resolved, what_is
from navfmu.fmi.units import BASE, Unit
from navfmu.ssp import annotations
from navfmu.ssp.document import MAIN, NAMESPACES, SSP_1, schema
from navfmu.ssp.structure import Component, Connection, Connector, Setting, Structure

TYPES = ("Real", "Integer", "Boolean", "String", "Enumeration", "Binary")
UNSAID = ""  # the kind of a connector that only a connection names
MASTER = "ssd:System/ssd:Annotations/ssc:Annotation//oms:FixedStepMaster"
FMU_TYPE = "application/x-fmu-sharedlibrary"


def locate(path: str | Path) -> tuple[Path, Path]:
    """The folder that holds the documents, and the main SSD, of an .ssp, a folder or an .ssd."""
    path = Path(path)
    found = what_is(path)
    if found == "a folder":
        if what_is(path / MAIN) is None:
            raise NavfmuError(f"{path}: the folder has no {MAIN}")
        return path, path / MAIN
    if found is None:
        raise NavfmuError(f"{path}: no such file; expected an .ssp, an .ssd or a folder with {MAIN}")
    if path.suffix.lower() == ".ssd":
        return path.parent, path
    folder = unpack(path, "SSP", content_hash(path, "an .ssp, an .ssd or a folder"))
    if what_is(folder / MAIN) != "a file":
        raise NavfmuError(f"{path}: has no {MAIN}")
    return folder, folder / MAIN


def variants(path: str | Path) -> list[str]:
    """Names of the sibling systems beside the main one."""
    folder, _ = locate(path)
    return sorted(file.stem for file in folder.glob("*.ssd") if file.name != MAIN)


def read(
    path: str | Path, variant: str | None = None, find: Callable[[str], Path | None] = lambda name: None
) -> Structure:
    """Read one variant (the main system without a name); ``find`` locates FMUs that are not beside the documents."""
    folder, file = locate(path)
    if variant is not None:
        known = variants(path)
        file = folder / f"{variant}.ssd"
        if variant not in known:
            have = ", ".join(known) or "none"
            raise NavfmuError(f"{path}: has no variant '{variant}'{nearest(variant, known)} (it has: {have})")
    return _Reader(Path(path), folder, file, find).read()


def read_parameters(path: str | Path) -> list[Setting]:
    """Read the values of a parameter set, an .ssv by itself."""
    path = Path(path)
    reader = _Reader(path, path.parent, path, lambda name: None)
    return reader._settings(reader._parse(path, "SystemStructureParameterValues", "ssv"), str(path), "")


class _Reader:
    def __init__(self, origin: Path, folder: Path, file: Path, find: Callable[[str], Path | None]) -> None:
        self.origin, self.folder, self.file, self.find = origin, folder, file, find
        self.ignored: list[str] = []
        self.notes: list[str] = []
        self.lenient: list[str] = []
        self.units: dict[str, Unit] = {}
        self.enumerations: dict[str, dict[str, int]] = {}

    def read(self) -> Structure:
        if self.origin.is_file() and self.origin != self.file:
            with open_archive(self.origin, "SSP") as archive:
                self.lenient += [f"{self.origin}: {habit}" for habit in habits(archive)]
        root = self._parse(self.file, "SystemStructureDescription", "ssd")
        system = root.find("ssd:System", NAMESPACES)
        self.units = self._units(root.find("ssd:Units", NAMESPACES), self._label(self.file))
        self.enumerations = self._enumerations(root.find("ssd:Enumerations", NAMESPACES), self._label(self.file))
        self._note_unused(system)
        components = self._components(system)
        self._system_settings(system, components)
        connections = self._connections(system, components)
        stop_time, step = self._experiment(root)
        return Structure(
            name=root.get("name") or system.get("name"),
            description=system.get("description") or root.get("description") or "",
            file=self.file,
            origin=self.origin,
            components=components,
            connections=connections,
            stop_time=stop_time,
            step=step,
            ignored=self.ignored,
            notes=self.notes,
            lenient=self.lenient,
        )

    # -- files -------------------------------------------------------------------------------------------------

    def _label(self, file: Path) -> str:
        """A document's name for messages: inside a package, the package's name and the entry's."""
        try:
            inside = file.relative_to(self.folder).as_posix()
        except ValueError:
            return str(file)
        return f"{self.origin}: {inside}" if self.origin.is_file() and self.origin != file else str(file)

    def _parse(self, file: Path, rules: str, prefix: str) -> Any:
        label = self._label(file)
        expected = {"ssd": "SystemStructureDescription", "ssv": "ParameterSet", "ssm": "ParameterMapping"}[prefix]
        data = read_bytes(file, f"an XML document with <{prefix}:{expected}>")
        root = parse(data, label, self.lenient, NAMESPACES)
        self._rename(root, expected, NAMESPACES[prefix], label)
        if root.tag != f"{{{NAMESPACES[prefix]}}}{expected}":
            raise NavfmuError(f"{label}: expected <{prefix}:{expected}> of SSP 1.0, found <{root.tag}>")
        version = root.get("version", "1.0")
        if not version.startswith("1."):
            raise NavfmuError(
                f"{label}: is for SSP {version}, expected SSP 1.0: documents of SSP 2.0 cannot be read yet"
            )
        validate(root, schema(rules), label, self.lenient)
        read = (root.find(".//osp:FixedStepAlgorithm", NAMESPACES), root.find(MASTER, NAMESPACES))
        unread = annotations.unread(root, label, [element for element in read if element is not None])
        self.ignored += [line for line in unread if line not in self.ignored]
        return root

    def _rename(self, root: Any, expected: str, namespace: str, label: str) -> None:
        """Give a document whose namespace is no other one of SSP 1 the right one: many write SSP1/ParameterValues."""
        given, _, name = root.tag[1:].rpartition("}")
        if name == expected and given.startswith(SSP_1) and given not in NAMESPACES.values():
            self.lenient.append(f"{label}: its namespace is '{given}', expected '{namespace}'")
            for element in root.iter(f"{{{given}}}*"):
                element.tag = f"{{{namespace}}}{element.tag.rpartition('}')[2]}"

    def _resolve(self, source: str, where: str) -> Path:
        """A file beside the SSD; nothing outside its folder and nothing from a network."""
        parts = urlsplit(source)
        if parts.scheme or parts.netloc or parts.query or parts.fragment:
            raise NavfmuError(f"{where}: source '{source}' is not supported, expected a relative path")
        base, name = self.file.parent.resolve(), unquote(parts.path)
        if "\\" in name and not self._is_there(base / name, where):
            self.lenient.append(f"{where}: source '{source}' is written with \\ for /")
            name = name.replace("\\", "/")
        with _told(where):
            path = resolved(base / name)
        if self.origin.is_file() and self.origin != self.file and not path.is_relative_to(base):
            raise NavfmuError(f"{where}: source '{source}' lies outside the package")
        return path

    def _is_there(self, path: Path, where: str) -> bool:
        """Whether there is something at a path that the element at ``where`` names."""
        with _told(where):
            return what_is(path) is not None

    # -- elements ------------------------------------------------------------------------------------------------

    def _note_unused(self, system: Any) -> None:
        label = self._label(self.file)
        dictionaries = system.find("ssd:SignalDictionaries", NAMESPACES)
        if dictionaries is not None:
            self.ignored.append(f"{label}, line {dictionaries.sourceline}: signal dictionaries")
        for connector in system.iterfind("ssd:Connectors/ssd:Connector", NAMESPACES):
            self.ignored.append(
                f"{label}, line {connector.sourceline}: root connector '{connector.get('name')}' "
                f"({connector.get('kind')}): nothing outside the system uses it"
            )

    def _components(self, system: Any) -> dict[str, Component]:
        components: dict[str, Component] = {}
        elements = system.find("ssd:Elements", NAMESPACES)
        label = self._label(self.file)
        for element in elements if elements is not None else ():
            if not isinstance(element.tag, str):
                continue  # a comment
            kind = element.tag.rpartition("}")[2]
            where = f"{label}, line {element.sourceline}: {kind} '{element.get('name')}'"
            if kind == "System":
                raise NavfmuError(f"{where}: nested systems are not supported, expected a flat system of FMUs")
            if kind == "SignalDictionaryReference":
                raise NavfmuError(f"{where}: signal dictionaries are not supported, connect the components directly")
            if "." in element.get("name"):
                raise NavfmuError(f"{where}: expected a name without a dot: it stands between component and variable")
            component = self._component(element, where)
            if component.name in components:
                raise NavfmuError(f"{where}: the name is taken by another component")
            components[component.name] = component
        if not components:
            raise NavfmuError(f"{label}: the system has no components")
        return components

    def _component(self, element: Any, where: str) -> Component:
        kind = element.get("type", FMU_TYPE)
        if kind != FMU_TYPE:
            raise NavfmuError(f"{where}: type '{kind}' is not supported, expected {FMU_TYPE}")
        if element.get("implementation") == "ModelExchange":
            raise NavfmuError(f"{where}: asks for model exchange, expected co-simulation")
        source = element.get("source")
        path = self._resolve(source, where)
        if not self._is_there(path, where):
            packed = self.origin.is_file() and self.origin != self.file  # a package holds all that it needs
            known = None if packed else self.find(path.name)
            if known is None:
                raise NavfmuError(f"{where}: its FMU '{source}' is missing")
            self.notes.append(f"{element.get('name')}: '{source}' is not beside the document; {known} is used")
            path = known
        connectors: dict[str, Connector] = {}
        for item in element.iterfind("ssd:Connectors/ssd:Connector", NAMESPACES):
            connector = self._connector(item, where)
            place = f"{self._label(self.file)}, line {item.sourceline}: connector '{connector.name}'"
            self._add(connectors, connector.name, connector, place)
        settings = [
            setting
            for binding in element.iterfind("ssd:ParameterBindings/ssd:ParameterBinding", NAMESPACES)
            for setting in self._binding(binding, path)
        ]
        return Component(element.get("name"), path, connectors, settings, where, element.get("description") or "")

    def _connector(self, item: Any, where: str) -> Connector:
        name, kind, unit, items = item.get("name"), None, None, None
        for candidate in TYPES:
            found = item.find(f"ssc:{candidate}", NAMESPACES)
            if found is not None:
                kind = candidate
                unit = self._unit(found.get("unit"))
                items = self._items(kind, found.get("name"), f"{where}: connector '{name}'")
        return Connector(name, item.get("kind"), kind, unit, items)

    def _add(self, known: dict[Any, Any], name: Any, value: Any, where: str) -> None:
        """Add what has a name once; the same once more is put up with."""
        if known.get(name, value) != value:
            raise NavfmuError(f"{where}: stands here twice, and differs")
        if name in known:
            self.lenient.append(f"{where}: stands here twice")
        known[name] = value

    def _items(
        self, kind: str, name: str | None, where: str, known: Mapping[str, dict[str, int]] | None = None
    ) -> dict[str, int] | None:
        """The items of the enumeration that a connector or a parameter names."""
        if kind != "Enumeration" or not name:
            return None
        known = self.enumerations | (known or {})
        if name not in known:
            self.lenient.append(f"{where}: the enumeration '{name}' is not defined{nearest(name, known)}")
        return known.get(name)

    def _unit(self, name: str | None) -> Unit | None:
        if not name:
            return None
        return self.units.get(name) or Unit(name)

    # -- connections ---------------------------------------------------------------------------------------------

    def _connections(self, system: Any, components: dict[str, Component]) -> list[Connection]:
        connections: list[Connection] = []
        taken: dict[tuple[str, str], str] = {}
        label = self._label(self.file)
        for element in system.iterfind("ssd:Connections/ssd:Connection", NAMESPACES):
            where = f"{label}, line {element.sourceline}: connection"
            if element.get("startElement") is None or element.get("endElement") is None:
                self.ignored.append(f"{where} of a root connector")
                continue
            ends = [self._end(element, which, components, where) for which in ("start", "end")]
            if ends[0][2] in ("input", UNSAID) and ends[1][2] in ("output", UNSAID) and ends[0][2] != ends[1][2]:
                ends.reverse()  # SSP 1.0 does not say which end is the source; the kinds do
            start, end = (ends[0][:2], ends[1][:2])
            if end in taken:
                raise NavfmuError(f"{where}: '{'.'.join(end)}' has two sources; the other one is in {taken[end]}")
            taken[end] = f"line {element.sourceline}"
            factor, offset = _linear(element, where)
            convert = element.get("suppressUnitConversion") not in ("true", "1")
            connections.append(Connection(start, end, factor, offset, convert, where))
        return connections

    def _end(self, element: Any, which: str, components: dict[str, Component], where: str) -> tuple[str, str, str]:
        component, name = element.get(f"{which}Element"), element.get(f"{which}Connector")
        if component not in components:
            raise NavfmuError(f"{where}: there is no component '{component}'{nearest(component, components)}")
        connectors = components[component].connectors
        if name not in connectors:
            self.lenient.append(f"{where}: component '{component}' does not list a connector '{name}'")
            connectors[name] = Connector(name, UNSAID, None, None)
        return component, name, connectors[name].kind

    # -- values --------------------------------------------------------------------------------------------------

    def _system_settings(self, system: Any, components: dict[str, Component]) -> None:
        """Bindings of the system reach components as "component.variable" and win over theirs."""
        for binding in system.iterfind("ssd:ParameterBindings/ssd:ParameterBinding", NAMESPACES):
            for setting in self._binding(binding, None):
                component, _, name = setting.name.partition(".")
                if component not in components or not name:
                    self.ignored.append(f"{setting.where}: parameter '{setting.name}' matches no component")
                    continue
                components[component].settings.append(replace(setting, name=name))

    def _binding(self, binding: Any, component: Path | None) -> list[Setting]:
        where = f"{self._label(self.file)}, line {binding.sourceline}: parameter binding"
        _check_source(binding, "application/x-ssp-parameter-set", where)
        inline = binding.find("ssd:ParameterValues/ssv:ParameterSet", NAMESPACES)
        self._note_second(binding, inline)
        if binding.get("source"):
            file = self._resolve(binding.get("source"), where)
            if not self._is_there(file, where):
                raise NavfmuError(f"{where}: its parameter set '{binding.get('source')}' is missing")
            root, label = self._parse(file, "SystemStructureParameterValues", "ssv"), self._label(file)
        elif inline is not None:
            root, label = inline, self._label(self.file)
            validate(root, schema("SystemStructureParameterValues"), label, self.lenient)
        else:
            raise NavfmuError(f"{where}: has neither a source nor inline values")
        settings = self._settings(root, label, binding.get("prefix") or "")
        mapping = binding.find("ssd:ParameterMapping", NAMESPACES)
        return settings if mapping is None else self._mapped(settings, mapping, where)

    def _note_second(self, element: Any, inline: Any) -> None:
        """Of a source and a document inside, only the source is read."""
        if element.get("source") and inline is not None:
            kind = inline.tag.rpartition("}")[2]
            place = f"{self._label(self.file)}, line {inline.sourceline}"
            self.ignored.append(f"{place}: the {kind} inside an element that has the source '{element.get('source')}'")

    def _settings(self, root: Any, label: str, prefix: str) -> list[Setting]:
        units = self._units(root.find("ssv:Units", NAMESPACES), label)
        enumerations = self._enumerations(root.find("ssv:Enumerations", NAMESPACES), label)
        settings: dict[str, Setting] = {}
        for parameter in root.iterfind("ssv:Parameters/ssv:Parameter", NAMESPACES):
            where = f"{label}, line {parameter.sourceline}"
            name = prefix + parameter.get("name")
            value = next(child for child in parameter if isinstance(child.tag, str))
            kind = value.tag.rpartition("}")[2]
            if kind == "Binary":
                raise NavfmuError(f"{where}: parameter '{name}' is Binary, which is not supported")
            unit = value.get("unit")
            definition = (units.get(unit) or self.units.get(unit) or Unit(unit)) if unit else None
            typed = _typed(kind, value.get("value"))
            items = self._items(kind, value.get("name"), f"{where}: parameter '{name}'", enumerations)
            if items is not None:
                if typed not in items:
                    raise NavfmuError(
                        f"{where}: parameter '{name}' is '{typed}', expected one of {', '.join(items)}"
                        f"{nearest(typed, items)}"
                    )
            if name in settings:
                self.lenient.append(
                    f"{settings.pop(name).where}: parameter '{name}' has no effect: it stands in the set once more, in "
                    f"line {parameter.sourceline}"
                )
            settings[name] = Setting(name, kind, typed, definition, where, items=items)
        return list(settings.values())

    def _mapped(self, settings: list[Setting], element: Any, where: str) -> list[Setting]:
        where = f"{where}, its parameter mapping"
        _check_source(element, "application/x-ssp-parameter-mapping", where)
        inline = element.find("ssm:ParameterMapping", NAMESPACES)
        self._note_second(element, inline)
        if element.get("source"):
            file = self._resolve(element.get("source"), where)
            if not self._is_there(file, where):
                raise NavfmuError(f"{where}: '{element.get('source')}' is missing")
            root, label = self._parse(file, "SystemStructureParameterMapping", "ssm"), self._label(file)
        elif inline is not None:
            root, label = inline, self._label(self.file)
            validate(root, schema("SystemStructureParameterMapping"), label, self.lenient)
        else:
            raise NavfmuError(f"{where}: has neither a source nor inline entries")
        by_name = {setting.name: setting for setting in settings}
        mapped, used = [], set()
        for entry in root.iterfind("ssm:MappingEntry", NAMESPACES):
            source, place = entry.get("source"), f"{label}, line {entry.sourceline}"
            if source not in by_name:
                self.ignored.append(f"{place}: mapping of '{source}', which the parameter set does not have")
                continue
            used.add(source)
            mapped.append(self._map(by_name[source], entry, place))
        for name in by_name.keys() - used:
            self.ignored.append(f"{by_name[name].where}: parameter '{name}' is not in the mapping")
        self.ignored.sort()
        return mapped

    def _map(self, setting: Setting, entry: Any, where: str) -> Setting:
        found, value = _transformation(entry), setting.value
        unit = None if entry.get("suppressUnitConversion") in ("true", "1") else setting.unit
        if found is not None and found[0] == "Linear":
            if setting.type not in ("Real", "Integer"):
                raise NavfmuError(f"{where}: a LinearTransformation needs a number, '{setting.name}' is {setting.type}")
            factor, offset = float(found[1].get("factor", 1.0)), float(found[1].get("offset", 0.0))
            return Setting(entry.get("target"), setting.type, value, unit, where, factor, offset)
        items = setting.items
        if found is not None:
            kind = found[0].removesuffix("Mapping")
            table: dict[Any, Any] = {}
            for item in found[1].iterfind("ssc:MapEntry", NAMESPACES):
                source = item.get("source")
                self._add(
                    table, _typed(kind, source), _typed(kind, item.get("target")), f"{where}: entry of '{source}'"
                )
            if value not in table:
                raise NavfmuError(f"{where}: the value {value} of '{setting.name}' has no entry in its {found[0]}")
            value, items = table[value], None
        return Setting(entry.get("target"), setting.type, value, unit, where, items=items)

    def _enumerations(self, element: Any, label: str) -> dict[str, dict[str, int]]:
        """The items of enumerations by their names."""
        found: dict[str, dict[str, int]] = {}
        for enumeration in element.iterfind("ssc:Enumeration", NAMESPACES) if element is not None else ():
            name, items = enumeration.get("name"), {}
            for item in enumeration.iterfind("ssc:Item", NAMESPACES):
                where = f"{label}, line {item.sourceline}: item '{item.get('name')}' of enumeration '{name}'"
                self._add(items, item.get("name"), int(item.get("value")), where)
            self._add(found, name, items, f"{label}, line {enumeration.sourceline}: enumeration '{name}'")
        return found

    def _units(self, element: Any, label: str) -> dict[str, Unit]:
        found: dict[str, Unit] = {}
        for unit in element.iterfind("ssc:Unit", NAMESPACES) if element is not None else ():
            base, name = unit.find("ssc:BaseUnit", NAMESPACES), unit.get("name")
            exponents = tuple(int(base.get(power, 0)) for power in BASE)
            defined = Unit(name, exponents, float(base.get("factor", 1.0)), float(base.get("offset", 0.0)))
            where = f"{label}, line {unit.sourceline}: unit '{name}'"
            if not defined.sound:
                scale = f"the factor {defined.factor:g} and the offset {defined.offset:g}"
                self.lenient.append(f"{where}: has {scale}: nothing can be converted")
                defined = Unit(name)
            self._add(found, name, defined, where)
        return found

    def _experiment(self, root: Any) -> tuple[float | None, float | None]:
        """Stop time and step (s); the step as libcosim reads it, or else as OMSimulator does."""
        experiment = root.find("ssd:DefaultExperiment", NAMESPACES)
        if experiment is None:
            experiment = {}
        elif float(experiment.get("startTime", 0.0)) != 0.0:
            where = f"{self._label(self.file)}, line {experiment.sourceline}"
            self.ignored.append(f"{where}: startTime {experiment.get('startTime')}: runs start at 0 s")
        stop = experiment.get("stopTime")
        algorithm, master = root.find(".//osp:FixedStepAlgorithm", NAMESPACES), root.find(MASTER, NAMESPACES)
        name, step = "", None
        if algorithm is not None:
            name, step = "baseStepSize", algorithm.get("baseStepSize")
        elif master is not None:
            name, step = "stepSize", master.get("stepSize")
        try:
            return (float(stop) if stop else None), (float(step) if step else None)
        except ValueError:
            raise NavfmuError(f"{self._label(self.file)}: {name} '{step}' is not a number") from None


def _check_source(element: Any, expected: str, where: str) -> None:
    """Refuse values and mappings of another type, and those that lie in a component."""
    kind = element.get("type", expected)
    if kind != expected:
        raise NavfmuError(f"{where}: type '{kind}' is not supported, expected {expected}")
    if element.get("sourceBase") == "component":
        raise NavfmuError(f"{where}: sourceBase 'component' is not supported, expected 'SSD'")


def _typed(kind: str, text: str) -> float | int | bool | str:
    if kind == "Real":
        return float(text)
    if kind == "Integer":
        return int(text)
    if kind == "Boolean":
        return text.strip() in ("true", "1")
    return text


def _transformation(element: Any) -> tuple[str, Any] | None:
    for name in ("Linear", "BooleanMapping", "IntegerMapping", "EnumerationMapping"):
        found = element.find(f"ssc:{name}Transformation", NAMESPACES)
        if found is not None:
            return name, found
    return None


def _linear(element: Any, where: str) -> tuple[float, float]:
    found = _transformation(element)
    if found is None:
        return 1.0, 0.0
    if found[0] != "Linear":
        raise NavfmuError(f"{where}: {found[0]}Transformation is not supported on a connection")
    return float(found[1].get("factor", 1.0)), float(found[1].get("offset", 0.0))


@contextmanager
def _told(where: str) -> Iterator[None]:
    """An error about a file gets the place of the element that names it."""
    try:
        yield
    except NavfmuError as error:
        raise NavfmuError(f"{where}: {error}") from None
