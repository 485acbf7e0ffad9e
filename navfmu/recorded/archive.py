"""A track FMU from the prebuilt player: the table of the flight goes into its resources, its description says which."""

from __future__ import annotations

from pathlib import Path

from navfmu.errors import NavfmuError, visible
from navfmu.files.archive import zipped
from navfmu.files.markup import parse
from navfmu.files.writing import write_file
from navfmu.fmi.tables import contents, read, replaced
from navfmu.recorded.importer import Imported
from navfmu.recorded.page import recorded

TABLE = "track"
DESCRIPTION = "modelDescription.xml"


def write_fmu(imported: Imported, player: str | Path, out: str | Path, name: str | None = None) -> Path:
    """Write the FMU of an imported track to ``out``; ``player`` is the FMU ``track`` that this package ships."""
    files = contents(player)
    labels, rows = list(read(files, TABLE, str(player))), imported.flight.table()
    if len(labels) != rows.shape[1]:
        have = ", ".join(labels)
        raise NavfmuError(f"{player}: its table has the columns {have}; expected {rows.shape[1]} of them")
    files = replaced(files, TABLE, dict(zip(labels, rows.T, strict=True)), str(player))
    name = visible(name or Path(imported.source).stem)
    flight = imported.flight
    text = (
        f"Recorded flight {visible(Path(imported.source).name)}: {flight.duration / 60.0:.1f} minutes, "
        f"t = 0 is {flight.start:g} s of the recording"
    )
    files[DESCRIPTION] = described(files[DESCRIPTION], name, text, flight.duration)
    return write_file(out, zipped(recorded(files, name, text, _account(imported, name))))


def described(xml: bytes, name: str, text: str, duration: float) -> bytes:
    """Return the description of a player with the name, a sentence about its recording, and how long that lasts, s."""
    from lxml import etree

    root = parse(xml, DESCRIPTION)
    root.set("modelName", name)
    root.set("description", text)
    experiment = root.find("DefaultExperiment")
    if experiment is None:
        experiment = etree.Element("DefaultExperiment")
        root.find("ModelVariables").addprevious(experiment)
    experiment.set("startTime", "0")
    experiment.set("stopTime", repr(float(duration)))
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8")


def _account(imported: Imported, name: str) -> str:
    lines = [f"{name}, imported from {visible(Path(imported.source).name)}", "", *imported.sentences(), ""]
    lines.append(f"{'recorded minus smoothed':24} {'unit':7} {'rows':>6} {'rms':>9} {'95 %':>9} {'largest':>9}")
    for quantity, unit, count, rms, most, largest in imported.residual_table():
        lines.append(f"{quantity:24} {unit:7} {count:6d} {rms:9.2f} {most:9.2f} {largest:9.2f}")
    return "\n".join(lines) + "\n"
