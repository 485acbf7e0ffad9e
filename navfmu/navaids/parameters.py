"""Stations as the parameters of an FMU that has places for some."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from navfmu.errors import NavfmuError
from navfmu.fmi.description import Description
from navfmu.fmi.fmu import describe
from navfmu.fmi.values import expand
from navfmu.navaids.station import Station
from navfmu.ssp.writer import values_document

COUNT = "station_count"
COLUMNS = {
    "station_latitude": "latitude",
    "station_longitude": "longitude",
    "station_altitude": "elevation",
    "station_range": "range",
}
"""Parameter, an array over the places -> what it holds of a station (rad, rad, m, m)."""
OPTIONAL = ("station_range",)
"""Which only receivers have."""


def places(fmu: str | Path) -> int:
    """How many stations an FMU can hold, or a sentence that it holds none."""
    return _places(describe(fmu), str(fmu))


def document(stations: Sequence[Station], fmu: str | Path, text: str) -> bytes:
    """The parameter set (.ssv) of an FMU with these stations; places that are left keep their start values."""
    description = describe(fmu)
    room = _places(description, str(fmu))
    if not 0 < len(stations) <= room:
        raise NavfmuError(f"{fmu}: has places for {room} stations and is given {len(stations)}")
    values: dict[str, object] = {COUNT: len(stations)}
    for name, of in COLUMNS.items():
        variables = [description.by_name.get(f"{name}[{i + 1}]") for i in range(room)]
        if None not in variables:
            given = [getattr(one, of) for one in stations]
            values[name] = given + [variable.start for variable in variables[len(given) :]]
    return values_document(description, expand(description, values, str(fmu)), text)


def _places(description: Description, fmu: str) -> int:
    for name in COLUMNS:
        if name not in OPTIONAL and (COUNT not in description.by_name or f"{name}[1]" not in description.by_name):
            raise NavfmuError(
                f"{fmu}: has no places for stations; expected an FMU with the parameters {COUNT} and the arrays "
                f"{', '.join(name for name in COLUMNS if name not in OPTIONAL)}"
            )
    first = next(iter(COLUMNS))
    return sum(1 for name in description.by_name if name.startswith(f"{first}["))
