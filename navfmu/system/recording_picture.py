"""A picture of some signals of a recording."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from navfmu.errors import NavfmuError
from navfmu.files.reading import regular
from navfmu.files.writing import write_file
from navfmu.fmi.names import chosen
from navfmu.report.pictures import lines
from navfmu.report.scene import Recorded, Scene
from navfmu.system import result
from navfmu.system.scene import windows

if TYPE_CHECKING:
    import pandas


def read(file: str | Path) -> pandas.DataFrame:
    """A recording with at least one row; refuses other tables."""
    kinds = " or ".join(result.SUFFIXES)
    path = regular(file, f"a recording ({kinds})")
    if path.suffix.lower() not in result.SUFFIXES:
        raise NavfmuError(f"{path}: is not a recording; expected a file whose name ends in {kinds}")
    frame = result.read(path)
    if not len(frame):
        raise NavfmuError(f"{path}: holds no recorded values")
    text = [name for name in frame if frame[name].dtype.kind not in "fiub"]
    if frame.index.name != "time" or frame.index.dtype.kind not in "fiu" or text:
        why = f"'{text[0]}' holds texts" if text else "it has no column 'time' of numbers"
        raise NavfmuError(f"{path}: is not a recording of a run: {why}")
    _refuse_disorder(path, frame)
    return frame


def _refuse_disorder(path: Path, frame: pandas.DataFrame) -> None:
    """Times go up from row to row; a line that runs back and forth would look like values."""
    time = frame.index.to_numpy(float)
    wrong = ~np.isfinite(time)
    wrong[1:] |= ~(np.diff(time) > 0.0)
    if wrong.any():
        row = int(np.argmax(wrong))
        after = f" after {time[row - 1]:.9g}" if row else ""
        place = f"line {row + 2}" if path.suffix.lower() == ".csv" else f"row {row + 1}"
        raise NavfmuError(f"{path}, {place}: time is {time[row]:.9g}{after}; expected times that go up from row to row")


def beside(file: str | Path) -> Path:
    """The picture's default name."""
    return Path(file).with_suffix(".png")


def write(frame: pandas.DataFrame, names: Sequence[str], file: str | Path, target: str | Path) -> list[str]:
    """Draw what the names mean, with the faults of the run, and write it as PNG; the signals that were drawn."""
    signals = chosen(list(frame.columns), names, str(file))
    about = frame.attrs["provenance"]
    time = frame.index.to_numpy(float)
    run = Recorded("", time, {name: frame[name].to_numpy() for name in signals}, _planned(time, about))
    scene = Scene(
        label=_label(about, Path(file)),
        runs=(run,),
        shown=run,
        units=frame.attrs["units"],
        windows=windows([frame.attrs["acted"]]),
    )
    write_file(target, lines.Picture(kind="lines", signals=signals).draw(scene).png)
    return signals


def _planned(time: np.ndarray, about: dict) -> np.ndarray:
    """The times (s) that are there, and the stop time where the run has ended before."""
    stop, period = (about.get(name) for name in ("stop", "record_period"))
    told = all(isinstance(value, (int, float)) for value in (stop, period))
    return np.append(time, stop) if told and stop - time[-1] > (1.0 - 1e-9) * period else time


def _label(about: dict, file: Path) -> str:
    """Which run it is, from a recording's provenance."""
    system, variant, seed = (about.get(name) for name in ("system", "variant", "seed"))
    if not system:
        return file.name
    parts = [Path(system).stem, variant, None if seed is None else f"seed {seed}"]
    return ", ".join(part for part in parts if part)
