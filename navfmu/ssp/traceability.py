"""SSP Traceability 1.0: what a simulation was made of and what came of it, as a file that other tools read.

A simulation task (STMD) has phases with steps; a step has inputs, a procedure and outputs, which are resources: files
by their URI, or texts in the file. What is to be known of a file, its checksum (SHA3-256) first, is its resource meta
data (SRMD), which stands in the task. https://github.com/PMSFIT/SSPTraceability
"""

from __future__ import annotations

import hashlib
import uuid
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from urllib.parse import quote

from lxml import etree

from navfmu import __version__
from navfmu.files.characters import shown
from navfmu.files.reading import regular, unreadable

SPACE = "http://ssp-standard.org/SSPTraceability1/"
NAMESPACES = {
    "stmd": f"{SPACE}SimulationTaskMetaData",
    "stc": f"{SPACE}SSPTraceabilityCommon",
    "srmd": f"{SPACE}SimulationResourceMetaData",
}
VERSION = "1.0.0"
TYPES = {  # MIME types by the ending of a file
    ".ssp": "application/x-ssp-package",
    ".ssd": "application/x-ssp-definition",
    ".fmu": "application/x-fmu-sharedlibrary",
    ".toml": "application/toml",
    ".csv": "text/csv",
    ".parquet": "application/vnd.apache.parquet",
    ".html": "text/html",
    ".json": "application/json",
}
#: Steps in the order of the phases, each with its phase.
STEPS = {"ExecuteSimulation": "ExecutionPhase", "EvaluateSimulationResults": "EvaluationPhase"}

Entries = Mapping[str, str]  # keyword -> value


@dataclass(frozen=True)
class Resource:
    """Something that went in or came out: a file, or a text."""

    kind: str  # as the standard has them: "system", "testcase", "result" ...
    file: Path | None = None
    text: str = ""
    type: str = "text/plain"  # of the text
    about: Mapping[str, Entries] = field(default_factory=dict)  # classifications, name -> entries


@dataclass(frozen=True)
class Particle:
    """The input, the procedure or the output of a step."""

    resources: tuple[Resource, ...] = ()
    about: Mapping[str, Entries] = field(default_factory=dict)


@dataclass(frozen=True)
class Step:
    """One step of a task; what it is called, ``STEPS`` says."""

    input: Particle
    procedure: Particle
    output: Particle


def document(name: str, description: str, steps: Mapping[str, Step], folder: Path) -> bytes:
    """An STMD file that will lie in a folder, made now."""
    task = etree.Element(_tag("stmd", "SimulationTaskMetaData"), nsmap=NAMESPACES)
    _set(task, version=VERSION, name=name, description=description, generationTool=f"navfmu {__version__}")
    _set(task, generationDateAndTime=datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"))
    for step, phase in STEPS.items():
        if step in steps:
            element = etree.SubElement(etree.SubElement(task, _tag("stmd", phase)), _tag("stmd", step))
            for part in ("input", "procedure", "output"):
                _particle(element, part.capitalize(), getattr(steps[step], part), folder)
    task.set("GUID", str(uuid.uuid5(uuid.NAMESPACE_URL, etree.tostring(task).decode())))
    return etree.tostring(task, xml_declaration=True, encoding="UTF-8", pretty_print=True)


def checksum(file: Path) -> str:
    """SHA3-256 of a file, the only one that the standard has."""
    try:
        with open(regular(file, "a file"), "rb") as content:
            return hashlib.file_digest(content, "sha3_256").hexdigest()
    except OSError as error:
        raise unreadable(file, error) from None


def uri(file: Path, folder: Path) -> str:
    """Where a file is: from the folder, if it is in there, and else from everywhere."""
    if file.is_relative_to(folder):
        return quote(file.relative_to(folder).as_posix())
    return file.as_uri()


def _particle(step: etree._Element, name: str, particle: Particle, folder: Path) -> None:
    element = etree.SubElement(step, _tag("stc", name))
    for resource in particle.resources:
        _resource(element, resource, folder)
    _classify(element, particle.about)


def _resource(parent: etree._Element, resource: Resource, folder: Path) -> None:
    element = etree.SubElement(parent, _tag("stc", "Resource"))
    _set(element, kind=resource.kind)
    if resource.file is None:
        _set(element, type=resource.type)
        etree.SubElement(element, _tag("stc", "Content")).text = shown(resource.text)
        _classify(element, resource.about)
        return
    kind = TYPES.get(resource.file.suffix.lower(), "application/octet-stream")
    _set(element, type=kind, source=uri(resource.file, folder))
    known = etree.SubElement(element, _tag("stc", "MetaData"))
    _set(known, kind="general", type="application/x-srmd-meta-data")
    data = etree.SubElement(etree.SubElement(known, _tag("stc", "Content")), _tag("srmd", "SimulationResourceMetaData"))
    _set(data, version=VERSION, name=resource.file.name, data=uri(resource.file, folder))
    _set(data, checksum=checksum(resource.file), checksumType="SHA3-256")
    _classify(data, resource.about)


def _classify(element: etree._Element, about: Mapping[str, Entries]) -> None:
    for name, entries in about.items():
        if entries:
            classification = etree.SubElement(element, _tag("stc", "Classification"))
            _set(classification, type=f"navfmu.{name}")
            for keyword, value in entries.items():
                entry = etree.SubElement(classification, _tag("stc", "ClassificationEntry"))
                _set(entry, keyword=keyword)
                entry.text = shown(value)


def numbered(word: str, texts: Iterable[str]) -> dict[str, str]:
    """Entries without names of their own."""
    return {f"{word} {number}": text for number, text in enumerate(texts, 1)}


def _tag(prefix: str, name: str) -> str:
    return f"{{{NAMESPACES[prefix]}}}{name}"


def _set(element: etree._Element, **attributes: str) -> None:
    for name, value in attributes.items():
        if value:
            element.set(name, shown(value))
