"""FMUs that consist of a model description only: enough to write and read systems, not to run them."""

from __future__ import annotations

import zipfile
from pathlib import Path

from navfmu.fmi.fmu import library_suffix, platforms

UNITS = """
    <Unit name="m"><BaseUnit m="1"/><DisplayUnit name="nmi" factor="0.0005399568034557236"/></Unit>
    <Unit name="ft"><BaseUnit m="1" factor="0.3048"/></Unit>
    <Unit name="rad/s"><BaseUnit s="-1" rad="1"/><DisplayUnit name="deg/s" factor="57.29577951308232"/></Unit>
    <Unit name="s"><BaseUnit s="1"/></Unit>
    <Unit name="K"><BaseUnit K="1"/><DisplayUnit name="degC" offset="-273.15"/></Unit>
"""


def variable(name: str, causality: str, kind: str = "Real", reference: int = 0, **attributes: str) -> str:
    """One ScalarVariable element."""
    variability = {"parameter": "fixed", "input": "continuous", "output": "continuous"}[causality]
    if kind != "Real" and causality != "parameter":
        variability = "discrete"
    initial = attributes.pop("initial", "" if causality == "input" else "exact")
    initial = f' initial="{initial}"' if initial else ""
    if "calculated" not in initial:
        attributes.setdefault("start", {"Boolean": "false"}.get(kind, "0"))
    text = " ".join(f'{key}="{value}"' for key, value in attributes.items())
    return (
        f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" '
        f'variability="{variability}"{initial}><{kind} {text}/></ScalarVariable>'
    )


def describe(name: str, variables: list[str], **root: str) -> str:
    """A model description with the given ScalarVariable elements."""
    outputs = [i + 1 for i, text in enumerate(variables) if 'causality="output"' in text]
    unknowns = "".join(f'<Unknown index="{i}"/>' for i in outputs)
    structure = f"<Outputs>{unknowns}</Outputs>" if outputs else ""
    attributes = {"fmiVersion": "2.0", "modelName": name, "guid": "{1}"} | root
    head = " ".join(f'{key}="{value}"' for key, value in attributes.items())
    return (
        f'<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription {head}>'
        f'<CoSimulation modelIdentifier="{name}"/><UnitDefinitions>{UNITS}</UnitDefinitions>'
        f"<ModelVariables>{''.join(variables)}</ModelVariables><ModelStructure>{structure}</ModelStructure>"
        "</fmiModelDescription>"
    )


def write(path: Path, description: str, **files: bytes) -> Path:
    """Zip a model description (and other entries) into an FMU file."""
    identifier = description.partition('modelIdentifier="')[2].partition('"')[0]
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", description)
        files.setdefault(f"binaries/{platforms()[0]}/{identifier}{library_suffix()}", b"not a library")
        for name, content in files.items():
            archive.writestr(name, content)
    return path


def sensor(folder: Path) -> Path:
    """rate[3] in, the bundle reading (rate[3], temperature) out, some parameters."""
    names = [variable(f"rate[{i}]", "input", reference=i, unit="rad/s") for i in (1, 2, 3)]
    names += [variable("heater", "input", reference=20, unit="K")]
    names += [variable(f"reading.rate[{i}]", "output", reference=3 + i, unit="rad/s") for i in (1, 2, 3)]
    names += [
        variable("reading.temperature", "output", reference=7, unit="K"),
        variable("reading.valid", "output", "Boolean", 8),
        variable("reading.sequence", "output", "Integer", 9),
        variable("reading.time_of_validity", "output", reference=10, unit="s"),
    ]
    names += [variable(f"bias[{i}]", "parameter", reference=10 + i, unit="rad/s", min="0", max="1") for i in (1, 2, 3)]
    names += [
        variable("period", "parameter", reference=14, unit="s", min="0.001", start="0.01"),
        variable("seed", "parameter", "Integer", 15, start="1", min="0"),
        variable("aligned", "parameter", "Boolean", 16),
        variable("ambient", "parameter", reference=17, unit="K", start="288.15"),
    ]
    return write(folder / "sensor.fmu", describe("sensor", names))


def filter_(folder: Path) -> Path:
    """The bundle imu (rate[3] only) in, the rate out."""
    names = [variable(f"imu.rate[{i}]", "input", reference=i, unit="rad/s") for i in (1, 2, 3)]
    names += [
        variable("imu.valid", "input", "Boolean", 4),
        variable("imu.sequence", "input", "Integer", 5),
        variable("imu.time_of_validity", "input", reference=6, unit="s"),
        variable("imu.lost", "output", "Integer", 7, initial="calculated"),
    ]
    names += [variable(f"rate[{i}]", "output", reference=10 + i, unit="rad/s") for i in (1, 2, 3)]
    return write(folder / "filter.fmu", describe("filter", names))
