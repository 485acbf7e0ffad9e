"""Result files: a recording as Parquet or CSV, complete or not at all, with what is needed to repeat the run."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from navfmu.errors import NavfmuError, visible
from navfmu.files.reading import read_bytes, regular, what_is
from navfmu.files.writing import replacing, write_file
from navfmu.fmi.names import bundle

if TYPE_CHECKING:
    import pandas
    import pyarrow

    from navfmu.engine.recording import Recording

SUFFIXES = (".parquet", ".csv")


def check_target(path: str | Path) -> Path:
    """The absolute path of a result file; one that could not be written is refused, before the run and not after."""
    path = check_file(path, *SUFFIXES)
    if path.suffix.lower() == ".csv":
        check_folder(path.parent, f"{path.name}.json")
    return path


def check_file(path: str | Path, *suffixes: str) -> Path:
    """The absolute path of a file; one that could not be written, or has none of the suffixes, is refused.

    Absolute because an FMU may make another folder the current one: to be asked for before any FMU is loaded.
    """
    if not str(path).strip():
        raise NavfmuError(f"the name of the file to write is empty; expected {' or '.join(suffixes)} at its end")
    path = Path(path)
    if path.suffix.lower() not in suffixes:
        raise NavfmuError(f"{path}: cannot tell the format from the name; expected {' or '.join(suffixes)} at its end")
    found = what_is(path)
    if found not in ("a file", None):
        raise NavfmuError(f"{path}: is {found}, expected a file")
    check_folder(path.parent)
    return path.absolute()


def check_folder(folder: str | Path, *files: str) -> Path:
    """The absolute path of a folder to write into; what neither is one nor could become one is refused.

    And so is what stands in it where one of the ``files`` will be written: before the work, and not after it.
    """
    if not str(folder).strip():
        raise NavfmuError("the name of the folder to write into is empty")
    folder = Path(folder)
    above = (folder.absolute(), *folder.absolute().parents)
    existing = next(place for place in above if what_is(place) or place.is_symlink())  # a link to nothing is in the way
    if what_is(existing) != "a folder":
        raise NavfmuError(f"{folder}: cannot be written: {existing} is not a folder")
    if not os.access(existing, os.W_OK):
        raise NavfmuError(f"{folder}: cannot be written: no permission to write to {existing}")
    for file in files:
        found = what_is(folder / file)
        if found not in ("a file", None):
            raise NavfmuError(f"{folder / file}: is {found}, where a file is to be written; move it away")
    return folder.absolute()


def as_frame(recording: Recording) -> pandas.DataFrame:
    """A recording with time (s) as index; Booleans and Integers in their own types.

    In ``attrs``: ``units`` by signal; ``not_finite``, at how many points a signal is NaN or infinite; ``lost``, how
    many samples each counter says were lost; ``acted``, from when to when each fault acted (s); ``idle``, the faults
    that changed nothing and why; ``observed``, what monitors saw (:class:`navfmu.engine.monitor.Observed`).
    """
    import numpy as np
    import pandas

    columns = {}
    for name, kind, values in zip(recording.names, recording.types, recording.values.T, strict=True):
        columns[name] = values != 0.0 if kind == "Boolean" else values.astype(np.int64) if kind == "Integer" else values
    frame = pandas.DataFrame(columns, index=pandas.Index(recording.time, name="time"))
    frame.attrs["units"] = dict(zip(recording.names, recording.units, strict=True))
    frame.attrs["not_finite"] = {name: count for name, (count, _) in recording.not_finite.items()}
    frame.attrs["observed"] = {name: seen.describe() for name, seen in recording.observed.items()}
    frame.attrs["acted"] = {fault: [list(span) for span in spans] for fault, spans in recording.acted.items()}
    frame.attrs["lost"] = dict(recording.lost)
    frame.attrs["idle"] = {fault: visible(why) for fault, why in recording.idle.items()}
    return frame


def other_notes(frame: pandas.DataFrame, *, lost: bool = True, idle: bool = True) -> list[str]:
    """The notes of a run without those that ``not_finite`` tells (and ``lost``, ``idle``): they differ by run."""
    told = [f"'{visible(name)}' is not finite at " for name in frame.attrs["not_finite"]]
    told += [] if idle else [f"fault '{visible(fault)}' {why}" for fault, why in frame.attrs["idle"].items()]
    told += [] if lost else [f" of '{visible(bundle(name))}' w" for name in frame.attrs["lost"]]
    return [note for note in frame.attrs["notes"] if not any(part in note for part in told)]


def write(frame: pandas.DataFrame, path: str | Path) -> Path:
    """Write a recording; a CSV file gets its units and provenance in a file ``NAME.csv.json`` beside it."""
    path = check_target(path)
    about = {"units": frame.attrs.get("units", {})} | frame.attrs.get("provenance", {})
    about["notes"] = frame.attrs.get("notes", [])
    about["not_finite"] = frame.attrs.get("not_finite", {})
    about["acted"] = frame.attrs.get("acted", {})
    if path.suffix.lower() == ".csv":
        with replacing(path) as temporary:
            frame.to_csv(temporary, float_format=None)
        write_file(path.with_name(path.name + ".json"), json.dumps(about, indent=2) + "\n")
    else:
        _write_parquet(frame, path, about)
    return path


def read(path: str | Path) -> pandas.DataFrame:
    """Read a result file back, with units and provenance in ``attrs``."""
    import pandas
    import pyarrow

    path = regular(path, "a recording of a run")
    try:
        if path.suffix.lower() == ".csv":
            frame = pandas.read_csv(path, index_col="time")
            side = path.with_name(path.name + ".json")
            about = json.loads(read_bytes(side, "what is told of a recording")) if side.exists() else {}
        else:
            table, about = _read_parquet(path)
            frame = table.replace_schema_metadata().to_pandas()
            frame = frame.set_index("time") if "time" in frame.columns else frame
    except (OSError, ValueError, KeyError, TypeError, IndexError, AttributeError, pyarrow.ArrowException) as error:
        raise NavfmuError(f"{path}: cannot be read: {' '.join(str(error).split()) or error!r}") from None
    if not isinstance(about, dict):
        raise NavfmuError(f"{path}: cannot be read: what it says of itself is no table")
    apart = {"units": about.pop("units", {}), "notes": about.pop("notes", [])}
    apart |= {name: about.pop(name, {}) for name in ("not_finite", "acted")}
    frame.attrs = apart | {"provenance": about}
    return frame


def _read_parquet(path: Path) -> tuple[pyarrow.Table, dict[str, Any]]:
    from pyarrow import parquet

    table = parquet.read_table(path)
    return table, json.loads((table.schema.metadata or {}).get(b"navfmu", b"{}"))


def _write_parquet(frame: pandas.DataFrame, path: Path, about: dict[str, Any]) -> None:
    import pyarrow
    from pyarrow import parquet

    names = ["time", *frame.columns]
    columns = [frame.index.to_numpy(), *(frame[name].to_numpy() for name in frame.columns)]
    arrays = [pyarrow.array(column) for column in columns]
    units = {"time": "s"} | about["units"]
    fields = [
        pyarrow.field(name, array.type, metadata={"unit": units[name]} if units.get(name) else None)
        for name, array in zip(names, arrays, strict=True)
    ]
    table = pyarrow.Table.from_arrays(arrays, schema=pyarrow.schema(fields, metadata={"navfmu": json.dumps(about)}))
    with replacing(path) as temporary:
        parquet.write_table(table, temporary, compression="zstd")
