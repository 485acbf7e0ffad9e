"""A loaded system: its structure, its FMUs unpacked, and everything in the documents checked against them."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from navfmu.engine.link import Link
from navfmu.errors import NavfmuError, nearest, visible
from navfmu.files.reading import located, what_is
from navfmu.files.toml import Document
from navfmu.fmi import names
from navfmu.fmi.description import Description, Variable, refuse_lenient
from navfmu.fmi.fmu import Fmu, load
from navfmu.fmi.units import Unit, conversion
from navfmu.fmi.values import checked, is_number
from navfmu.ssp import reader
from navfmu.ssp.structure import Component, Connection, Setting, Structure
from navfmu.system import shipped

if TYPE_CHECKING:
    from navfmu.faults import Fault
    from navfmu.system.report_file import ReportFile


@dataclass(frozen=True, eq=False)
class Assembly:
    """A system structure with its FMUs unpacked. Nothing changes in it: threads may share it."""

    structure: Structure
    fmus: Mapping[str, Fmu]  # by component
    values: Mapping[str, Mapping[str, Any]]  # start values by component and variable, from the documents
    links: tuple[Link, ...]
    variant: str | None = None
    place: Path = field(init=False)  # where it lies, from everywhere

    def __post_init__(self) -> None:
        object.__setattr__(self, "place", located(self.structure.origin))

    @classmethod
    def load(cls, path: str | Path, variant: str | None = None, *, strict: bool = False) -> Self:
        """Load an .ssp, a folder with SystemStructure.ssd, an .ssd, one .fmu, or a shipped system by its name.

        What is not as FMI and SSP have it, but clear all the same, is read with a note; ``strict`` refuses it.
        """
        file = shipped.system(str(path))
        if file.suffix.lower() == ".fmu":
            if variant is not None:
                raise NavfmuError(f"{file}: a single FMU has no variants")
            loaded = cls.of(_single(file))
        else:
            loaded = cls.of(reader.read(file, variant, shipped.find), variant)
        if strict:
            refuse_lenient(str(file), loaded.lenient)
        return loaded

    @classmethod
    def of(cls, structure: Structure, variant: str | None = None) -> Self:
        """Open the FMUs of a structure and check that everything in it fits them."""
        fmus = {name: _open(component, structure) for name, component in structure.components.items()}
        for name, component in structure.components.items():
            _check_connectors(component, fmus[name], structure.lenient)
        links = tuple(_link(connection, structure, fmus) for connection in structure.connections)
        fed = {link.target: link.source for link in links}
        values = {
            name: _settings(component, fmus[name], fed, structure) for name, component in structure.components.items()
        }
        assembly = cls(structure, fmus, values, links, variant)
        assembly._check_unconnected()
        return assembly

    @property
    def name(self) -> str:
        """The name that the system structure gives itself."""
        return self.structure.name

    @cached_property
    def descriptions(self) -> dict[str, Description]:
        """What each component's FMU says about itself."""
        return {name: fmu.description for name, fmu in self.fmus.items()}

    @cached_property
    def digest(self) -> str:
        """A hash of everything that determines a run beside its arguments: FMUs, connections, values."""
        total = hashlib.sha256()
        for name, fmu in self.fmus.items():
            total.update(f"{name}={fmu.digest};{sorted(self.values[name].items())!r};".encode())
        total.update(repr(self.links).encode())
        return total.hexdigest()

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know about the documents: where FMUs were found, what has no effect, what is wrong."""
        notes = (
            *self.structure.notes,
            *(f"has no effect: {line}" for line in self.structure.ignored),
            *(f"read leniently: {line}" for line in self.lenient),
        )
        return tuple(map(visible, notes))

    @property
    def lenient(self) -> tuple[str, ...]:
        """What is not as FMI and SSP have it, in documents and FMUs, and was read all the same."""
        fmus = {fmu.path: fmu.description.lenient for fmu in self.fmus.values()}
        return (*self.structure.lenient, *(f"{path.name}: {line}" for path, lines in fmus.items() for line in lines))

    def hashes(self) -> dict[str, str]:
        """SHA-256 of each component's FMU."""
        return {name: fmu.digest for name, fmu in self.fmus.items()}

    def variable(self, name: str, where: str = "signal") -> Variable:
        """The variable that "component.variable" names."""
        return names.find(self.descriptions, name, f"{where} '{name}'").variable

    def value(self, name: str) -> Any:
        """The start value of "component.variable": the system's, or else that of the FMU."""
        variable = self.variable(name)
        component, _ = names.split(name)
        return self.values[component].get(variable.name, variable.start)

    def faults(self, faults: str | Path | Fault | Sequence[str | Path | Fault] | None) -> tuple[Fault, ...]:
        """Faults from files (also by their names inside the system's package), and those given as they are."""
        from navfmu.faults import Fault, load_faults

        if not isinstance(faults, (str, Path, Fault, Sequence, type(None))):
            raise NavfmuError(f"faults: {faults!r} is no list of faults")
        found: list[Fault] = []
        for entry in [faults] if isinstance(faults, (str, Path, Fault)) else faults or ():
            if isinstance(entry, (str, Path)):
                path = self.attachment("faults", entry)
                file = str(located(path)) if path == Path(entry) else str(entry)
                found += [replace(fault, file=file) for fault in load_faults(path, self.called(path))]
            elif isinstance(entry, Fault):
                found.append(entry)
            else:
                raise NavfmuError(
                    f"faults: {entry!r} is not a fault; expected the name of a fault file, or a navfmu.Fault such as "
                    'Fault("gps", "gps.jammed", "input", start=300.0)'
                )
        ids = [fault.id for fault in found]
        for fault in found:
            if ids.count(fault.id) > 1:
                raise NavfmuError(f"two faults have the id '{fault.id}'; give them different ones")
        return tuple(found)

    def attachment(self, kind: str, name: str | Path) -> Path:
        """A file by path, or by its name among the package's own: ``extra/faults/gps_lost.toml`` by "gps_lost"."""
        if not str(name).strip():
            raise NavfmuError(f"{kind}: the name of the file is empty")
        path = Path(name)
        return path if what_is(path) not in (None, "a folder") else self.own_attachment(kind, name)

    def own_attachment(self, kind: str, name: str | Path) -> Path:
        """A file by its name among the package's own; what is no such name is returned as the path that it is."""
        path = Path(name)
        folder = self.structure.file.parent
        for place in (folder / "extra" / kind, folder / kind):
            for candidate in (place / path.name, place / f"{path.name}.toml"):
                if what_is(candidate) not in (None, "a folder"):
                    return candidate
        if path.suffix in ("", ".toml") and path.parent == Path() and what_is(path) is None:
            known = [file.stem for place in (folder / "extra" / kind, folder / kind) for file in place.glob("*.toml")]
            have = f" (the system has: {', '.join(sorted(known))})" if known else ""
            raise NavfmuError(f"{kind}: there is no file '{name}'{nearest(path.stem, known)}{have}")
        return path

    def called(self, file: Path) -> str:
        """What messages call a file: one of the package "system.ssp: extra/report.toml", not by a path in the cache."""
        folder, origin = self.structure.file.parent, self.structure.origin
        packed = origin.is_file() and origin != self.structure.file and file.is_relative_to(folder)
        return f"{origin}: {file.relative_to(folder).as_posix()}" if packed else str(file)

    def signals(self, record: Sequence[str] | None = None) -> list[str]:
        """Names to record: those given, where the name of a component stands for all its outputs.

        Without names: what the system's report file says, or else all outputs.
        """
        if record is not None:
            given = [record] if isinstance(record, str) else record
            return [f"{name}.*" if name in self.fmus else name for name in given]
        return [
            signal
            for name in self.default_record or self.fmus
            for signal in (self._outputs(name) if name in self.fmus else [name])
        ]

    def _outputs(self, component: str) -> list[str]:
        return [str(output) for output in names.outputs({component: self.descriptions[component]})]

    @cached_property
    def default_record(self) -> list[str]:
        """What the system's report file wants recorded when nothing is named; empty where it does not say."""
        from navfmu.system.default_record import default_record

        document = self._report_document
        return [] if document is None else default_record(document, self.fmus, lambda: self._siblings)

    @cached_property
    def phases(self) -> dict[str, str]:
        """Conditions that have a name in the system's report file."""
        document = self._report_document
        if document is None or "phase" not in document.content:
            return {}
        from navfmu.system.phase import phases_of

        return phases_of(document, self.fmus, lambda: self._siblings)

    @cached_property
    def report(self) -> ReportFile | None:
        """What the system says about its report, checked against it and its other variants; None without a file."""
        if self._report_document is None:
            return None
        from navfmu.system.report_file import ReportFile

        return ReportFile.of(self._report_document, self.fmus, lambda: self._siblings)

    @cached_property
    def _report_document(self) -> Document | None:
        if self.structure.file.suffix.lower() != ".ssd":
            return None
        folder = self.structure.file.parent
        for file in (folder / "extra" / "report.toml", folder / "report.toml"):
            if what_is(file) is not None:
                return Document.read(file, "report file", self.called(file))
        return None

    @cached_property
    def _siblings(self) -> list[Mapping[str, Fmu]]:
        """The FMUs of the other variants; of those that can be opened."""
        found = []
        for file in sorted(self.structure.file.parent.glob("*.ssd")):
            if file != self.structure.file:
                with suppress(NavfmuError):
                    found.append(type(self).load(file).fmus)
        return found

    # -- checks --------------------------------------------------------------------------------------------------

    def refuse_connected(self, component: str, values: Mapping[str, Any], where: str) -> None:
        """A value for an input that another component feeds would do nothing; that is not left unsaid."""
        fed = {link.target: link.source for link in self.links}
        for name in values:
            source = fed.get(f"{component}.{name}")
            if source is not None:
                raise NavfmuError(
                    f"{where}: '{name}' is connected to '{source}', so a value of its own would have no effect; "
                    "change the source, or let a fault act on it"
                )

    def known(self, component: str, where: str) -> None:
        """Refuse the name of a component that there is not."""
        if component not in self.fmus:
            raise NavfmuError(f"{where}: there is no component '{component}'{nearest(component, self.fmus)}")

    def _check_unconnected(self) -> None:
        fed = {link.target for link in self.links}
        for name, fmu in self.fmus.items():
            for variable in fmu.description.variables:
                if variable.causality != "input" or f"{name}.{variable.name}" in fed:
                    continue
                if variable.start is None and variable.name not in self.values[name]:
                    raise NavfmuError(
                        f"{self.structure.file}: input '{name}.{variable.name}' is not connected and has no start "
                        "value; connect it or give it one in a parameter set"
                    )


def _open(component: Component, structure: Structure) -> Fmu:
    """Load a component's FMU; messages about a packed one name the package and not the folder it was unpacked to."""
    try:
        return load(component.source)
    except NavfmuError as error:
        folder = structure.file.parent
        if structure.origin in (folder, structure.file) or not component.source.is_relative_to(folder.resolve()):
            raise
        inside = component.source.relative_to(folder.resolve()).as_posix()
        raise NavfmuError(str(error).replace(str(component.source), f"{structure.origin}: {inside}")) from None


def _single(file: Path) -> Structure:
    fmu = load(file)
    about = fmu.description
    component = Component(about.model_identifier.replace(".", "_"), file, {}, [], str(file), about.description)
    return Structure(
        about.model_name,
        about.description,
        file,
        file,
        {component.name: component},
        [],
        about.stop_time,
        about.step_size,
    )


def _check_connectors(component: Component, fmu: Fmu, lenient: list[str]) -> None:
    for connector in component.connectors.values():
        where = f"{component.where}, connector '{connector.name}'"
        is_parameter = connector.kind in ("parameter", "calculatedParameter")
        if is_parameter and connector.name not in fmu.description.by_name:
            lenient.append(f"{where}: is a parameter that {fmu.path.name} does not have")
            continue
        variable = fmu.description.variable(connector.name, where)
        kind = "Integer" if connector.type == "Enumeration" else connector.type
        if kind not in (None, variable.type):
            sentence = f"{where}: is {connector.type}, but the FMU's variable is {variable.type}"
            if not is_parameter:
                raise NavfmuError(sentence)
            lenient.append(sentence)  # nothing goes through it
        if connector.kind in ("input", "output", "parameter") and connector.kind != variable.causality:
            raise NavfmuError(f"{where}: is an {connector.kind}, but the FMU's variable is {variable.causality}")
        if connector.unit is not None and variable.unit:
            _check_name(_unit_of(fmu, variable), connector.unit, where, lenient)
            conversion(_unit_of(fmu, variable), connector.unit, where)


def _check_name(one: Unit | None, other: Unit | None, where: str, lenient: list[str]) -> None:
    """Two units of one name are taken for one unit, also where they are defined differently."""
    if one is not None and other is not None and one.name == other.name and not one.agrees(other):
        lenient.append(f"{where}: the unit '{one.name}' has two different definitions, and is taken by its name")


def _unit_of(fmu: Fmu, variable: Variable) -> Unit | None:
    if not variable.unit or variable.type != "Real":
        return None
    return fmu.description.units.get(variable.unit) or Unit(variable.unit)


def _settings(component: Component, fmu: Fmu, fed: Mapping[str, str], structure: Structure) -> dict[str, Any]:
    """The values of a component in its own types and units; those without effect are listed.

    These are of names that the FMU does not have, of inputs that are ``fed`` by another component, those that a later
    one overrides, and units of what has none.
    """
    values: dict[str, Any] = {}
    places: dict[str, str] = {}
    ignored = structure.ignored
    missing: dict[tuple[str, str], list[Setting]] = {}  # elements of an array together
    for setting in component.settings:
        variable = fmu.description.by_name.get(setting.name)
        if variable is None:
            missing.setdefault((setting.where.rpartition(", line")[0], names.array(setting.name)), []).append(setting)
            continue
        name = f"{component.name}.{setting.name}"
        if name in fed:
            ignored.append(f"{setting.where}: '{name}' is connected to '{fed[name]}'")
            continue
        where, unit = f"{setting.where}: {component.name}", _setting_unit(component, fmu, variable)
        _check_name(setting.unit, unit, f"{setting.where}: '{name}'", structure.lenient)
        if setting.type == "String" and variable.type != "String":
            structure.lenient.append(f"{setting.where}: '{name}' is {variable.type} and is given as a String")
        if unit is None and setting.unit is not None and not setting.unit.plain:
            ignored.append(f"{setting.where}: the unit '{setting.unit.name}' of '{name}', which has none")
        if isinstance(setting.value, str) and setting.type == "Enumeration":
            items = setting.items if setting.items is not None else fmu.description.items(variable)
            if setting.value.strip() not in items and is_number(setting.value):
                structure.lenient.append(f"{setting.where}: '{name}' is the number {setting.value} and no item's name")
        value = checked(fmu.description, variable, _converted(setting, variable, unit, where), where)
        if setting.name in values:
            ignored.append(f"{places[setting.name]}: the value of '{name}' is overridden in {setting.where}")
        values[setting.name], places[setting.name] = value, setting.where
    for (_, whole), settings in missing.items():
        first, *others = settings
        close = names.hint(first.name, fmu.description.by_name)
        name = f"{whole}' of {len(settings)} elements" if others else f"{first.name}'"
        ignored.append(f"{first.where}: '{component.name}' has no variable '{name}{close}")
    return values


def _setting_unit(component: Component, fmu: Fmu, variable: Variable) -> Unit | None:
    """The unit of a variable as its FMU says it, or else its connector."""
    connector = component.connectors.get(variable.name)
    if variable.type == "Real" and not variable.unit and connector is not None:
        return connector.unit
    return _unit_of(fmu, variable)


def _converted(setting: Setting, variable: Variable, unit: Unit | None, where: str) -> Any:
    value = setting.value
    if setting.items is not None and isinstance(value, str):
        if value not in setting.items:
            known = ", ".join(setting.items)
            raise NavfmuError(f"{where}: '{variable.name}' is '{value}', expected one of {known}")
        value = setting.items[value]
    if variable.type == "Real" and not isinstance(value, (bool, str)):
        what = f"{where}: '{variable.name}'"
        factor, offset = conversion(setting.unit, unit, what, difference=variable.relative)
        return setting.factor * (factor * value + offset) + setting.offset
    if (setting.factor, setting.offset) != (1.0, 0.0):
        return setting.factor * value + setting.offset
    return value


def _check_kinds(
    source: Variable, connection: Connection, origins: Sequence[Unit], where: str, lenient: list[str]
) -> None:
    """FMI connects a difference (``relativeQuantity``) to another only.

    In units without an origin of their own it is the same number all the same; between others there is no conversion.
    """
    kinds = ["a difference (relativeQuantity)", "a quantity that is none"]
    first, second = kinds if source.relative else reversed(kinds)
    if connection.convert_units and origins:
        raise NavfmuError(
            f"{where}: connects {first} to {second}; '{origins[0].name}' has an origin of its own, so what this means "
            "is not clear: expected two of a kind, or suppressUnitConversion"
        )
    lenient.append(f"{where}: connects {first} to {second}")


def _link(connection: Connection, structure: Structure, fmus: Mapping[str, Fmu]) -> Link:
    """A connection with the one factor and offset that do all its conversions."""
    where = f"{connection.where} {connection}"
    ends, items = [], []
    for component, name in (connection.start, connection.end):
        variable = fmus[component].description.variable(name, where)
        unit = _unit_of(fmus[component], variable)
        connector = structure.components[component].connectors[name]
        ends.append((variable, unit, connector.unit or unit))
        items.append(connector.items or fmus[component].description.items(variable))
    (source, source_unit, start_unit), (target, target_unit, end_unit) = ends
    if source.causality != "output" or target.causality != "input":
        raise NavfmuError(f"{where}: goes from {source.causality} to {target.causality}, expected output to input")
    steps = [conversion(source_unit, start_unit, where, difference=source.relative)]
    if connection.convert_units:
        _check_name(start_unit, end_unit, where, structure.lenient)
        steps.append(conversion(start_unit, end_unit, where, difference=source.relative))
    steps.append((connection.factor, connection.offset))
    steps.append(conversion(end_unit, target_unit, where, difference=target.relative))
    if source.relative != target.relative:
        origins = [unit for unit in (start_unit, end_unit) if unit is not None and unit.offset != 0.0]
        _check_kinds(source, connection, origins, where, structure.lenient)
    factor, offset = 1.0, 0.0
    for a, b in steps:
        factor, offset = a * factor, a * offset + b
    link = Link(".".join(connection.start), ".".join(connection.end), factor, offset)
    link.check(source, target, where)
    if all(items) and set(items[0].values()) - set(items[1].values()):
        first, second = (", ".join(f"{name} = {value}" for name, value in known.items()) for known in items)
        raise NavfmuError(f"{where}: connects one enumeration ({first}) to another ({second})")
    return link
