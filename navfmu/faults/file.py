"""Reads a fault file: TOML with one ``[[fault]]`` table for each fault. Errors name the file and the line."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

from navfmu.errors import NavfmuError
from navfmu.faults.fault import Fault, FaultError
from navfmu.files.toml import Document


def load_faults(path: str | Path, name: str = "") -> list[Fault]:
    """The faults of a file, in its order; ``name`` is what messages call it, by default its path."""
    return faults_of(Document.read(path, "fault file", name))


def parse_fault(text: str, name: str = "fault") -> Fault:
    """The one fault of a text such as ``id = "F1", target = "gps.jammed", type = "input", start = 300``."""
    found = parse_faults(f"fault = [{{ {text} }}]", f"{name} '{text}'")
    if len(found) != 1:
        raise NavfmuError(f"{name} '{text}': expected the entries of one fault")
    return dataclasses.replace(found[0], where=name, lines={})


def parse_faults(text: str, name: str = "faults") -> list[Fault]:
    """The faults of a text; ``name`` is the file's name in messages."""
    return faults_of(Document(text, name))


def faults_of(document: Document) -> list[Fault]:
    """The faults of a document."""
    from navfmu.faults.schema import FaultFile  # pydantic is needed where a file is read only
    from navfmu.files.schema import validated

    entries = validated(document, FaultFile).fault
    if not entries:
        raise document.error("holds no fault; expected at least one table [[fault]]")
    faults: list[Fault] = []
    for index, entry in enumerate(entries):
        try:
            fault = Fault(
                id=entry.id,
                target=entry.target,
                type=entry.type,
                start=entry.start,
                duration=math.inf if entry.duration is None else entry.duration,
                parameters=entry.parameters(),
                fmea=entry.fmea,
                description=entry.description,
            )
        except FaultError as error:
            where = document.where("fault", index, error.key)
            raise FaultError(error.fault, where, error.sentence, error.key) from None
        if any(fault.id == other.id for other in faults):
            raise document.error(f"the id '{fault.id}' is already taken", "fault", index, "id")
        lines = {key: document.where("fault", index, key) for key in document.content["fault"][index]}
        faults.append(dataclasses.replace(fault, where=document.where("fault", index), lines=lines))
    return faults
