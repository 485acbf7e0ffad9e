"""A track FMU from the prebuilt player: the table of the flight goes into its resources, its description says which.

The binaries stay as they were built; they read the table when instantiated. They accept their own GUID followed by a
dot and a hash, so that every track is a different FMU to masters that tell FMUs apart by GUID.
"""

from __future__ import annotations

import hashlib
import zipfile
from pathlib import Path

import numpy as np

from navfmu.errors import NavfmuError, visible
from navfmu.files.archive import zipped
from navfmu.files.markup import parse
from navfmu.files.writing import write_file
from navfmu.recorded.importer import Imported

TABLE = "resources/track.csv"
COLUMNS = 10
DESCRIPTION = "modelDescription.xml"
ACCOUNT = "documentation/import.txt"


def write_fmu(imported: Imported, player: str | Path, out: str | Path, name: str | None = None) -> Path:
    """Write the FMU of an imported track to ``out``; ``player`` is the FMU ``track`` that this package ships."""
    with zipfile.ZipFile(player) as archive:
        contents = {info.filename: archive.read(info) for info in archive.infolist() if not info.is_dir()}
    if TABLE not in contents or DESCRIPTION not in contents:
        raise NavfmuError(f"{player}: this is not the track player, it has no {TABLE}")
    header = contents[TABLE].split(b"\n", 1)[0].decode().strip()
    if header.count(",") != COLUMNS - 1:
        raise NavfmuError(f"{player}: its {TABLE} has the columns '{header}'; expected {COLUMNS} of them")
    table = table_text(header, imported.flight.table())
    name = visible(name or Path(imported.source).stem)
    contents |= {
        TABLE: table.encode(),
        DESCRIPTION: _describe(contents[DESCRIPTION], imported, table, name),
        ACCOUNT: _account(imported, name).encode(),
    }
    return write_file(out, zipped(contents))


def table_text(header: str, rows: np.ndarray) -> str:
    """The table as the FMU reads it: a header, then numbers that survive writing and reading to the last bit."""
    lines = [",".join(repr(float(value)) for value in row) for row in rows]
    return "\n".join([header, *lines]) + "\n"


def _describe(xml: bytes, imported: Imported, table: str, name: str) -> bytes:
    from lxml import etree

    root = parse(xml, DESCRIPTION)
    digest = hashlib.sha256(table.encode()).hexdigest()[:16]
    flight = imported.flight
    root.set("guid", f"{root.get('guid').split('.')[0]}.{digest}")
    root.set("modelName", name)
    root.set(
        "description",
        f"Recorded flight {visible(Path(imported.source).name)}: {flight.duration / 60.0:.1f} minutes, "
        f"t = 0 is {flight.start:g} s of the recording",
    )
    experiment = root.find("DefaultExperiment")
    if experiment is None:
        experiment = etree.Element("DefaultExperiment")
        root.find("ModelVariables").addprevious(experiment)
    experiment.set("startTime", "0")
    experiment.set("stopTime", repr(float(flight.duration)))
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8")


def _account(imported: Imported, name: str) -> str:
    lines = [f"{name}, imported from {visible(Path(imported.source).name)}", "", *imported.sentences(), ""]
    lines.append(f"{'recorded minus smoothed':24} {'unit':7} {'rows':>6} {'rms':>9} {'95 %':>9} {'largest':>9}")
    for quantity, unit, count, rms, most, largest in imported.residual_table():
        lines.append(f"{quantity:24} {unit:7} {count:6d} {rms:9.2f} {most:9.2f} {largest:9.2f}")
    return "\n".join(lines) + "\n"
