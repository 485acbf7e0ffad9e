"""What is left of a run when an FMU ends the process: where it was, what FMUs had said, the rows recorded so far.

An engine writes these into a ``Memory``, which is lost with the process, or into a ``BlackBox``, which is a file mapped
into memory: nothing is copied while running, and another process reads it at any time, also after the first has died.

    BlackBox.create(path, plan).close()
    compiled.run(plan, memory=BlackBox.open(path, plan))  # in the process that may end

    with BlackBox.open(path, plan) as box:  # in another one
        print(box.whereabouts(), box.said(), box.recording())
"""

from __future__ import annotations

import ctypes
import errno
import mmap
import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from navfmu.engine.plan import Plan
from navfmu.engine.recording import Recording, complained, recording, room, too_large, warned
from navfmu.engine.structures import NAMES, Log, Place
from navfmu.errors import NavfmuError

_LESS = "record fewer signals, take a longer recording period, or set TMPDIR to a folder with more room"
MAGIC, VERSION = b"navfmu\x1ab", 2


@dataclass(frozen=True, eq=False)
class Memory:
    """What an engine writes while running."""

    place: Place
    logs: Any  # of structures.Log, one for each component
    rows: np.ndarray  # float64, (rows of the recording, columns)

    @classmethod
    def of(cls, plan: Plan) -> Memory:
        """Memory of this process."""
        return cls(Place(component=-1), (Log * len(plan.parts))(), room(plan))


class _Header(ctypes.Structure):
    """The beginning of the file; after it come the logs and the rows."""

    _fields_ = [
        ("magic", ctypes.c_char * 8),
        ("version", ctypes.c_int32),
        ("components", ctypes.c_int32),
        ("rows", ctypes.c_int64),
        ("columns", ctypes.c_int64),
        ("place", Place),
    ]


class BlackBox:
    """A ``Memory`` that is a file. The names of components and signals are those of the plan, at both ends."""

    def __init__(self, path: Path, plan: Plan, file: BinaryIO) -> None:
        self.path, self.plan = path, plan
        self._map = mmap.mmap(file.fileno(), size(plan))
        header = _Header.from_buffer(self._map)
        self.place: Place = header.place
        self.logs = (Log * len(plan.parts)).from_buffer(self._map, ctypes.sizeof(_Header))
        shape = plan.rows, len(plan.recorded)
        start = ctypes.sizeof(_Header) + ctypes.sizeof(self.logs)
        self.rows = np.ndarray(shape, np.float64, self._map, start)
        self._header = header

    @classmethod
    def create(cls, path: str | Path, plan: Plan) -> BlackBox:
        """A new file with room for a run of the plan."""
        path = Path(path)
        header = _Header(MAGIC, VERSION, len(plan.parts), plan.rows, len(plan.recorded), Place(component=-1))
        try:
            with path.open("w+b") as file:
                _reserve(file, size(plan))
                file.write(bytes(header))
                file.flush()
                return cls(path, plan, file)
        except (OSError, OverflowError, MemoryError, ValueError) as error:
            with suppress(OSError):
                path.unlink(missing_ok=True)
            if isinstance(error, OSError):
                full = error.errno in (errno.EFBIG, errno.ENOMEM, errno.ENOSPC)
                how = f"; the recording of a run takes {size(plan) / 1e6:.3g} MB there: {_LESS}" if full else ""
                raise NavfmuError(f"{path}: cannot be written: {error.strerror or error}{how}") from None
            raise too_large(plan) from None

    @classmethod
    def open(cls, path: str | Path, plan: Plan) -> BlackBox:
        """The file of a run of this plan: to write into, or to look into while it goes on or after it has ended."""
        path = Path(path)
        try:
            with path.open("r+b") as file:
                start = file.read(ctypes.sizeof(_Header))
                if len(start) < ctypes.sizeof(_Header) or not start.startswith(MAGIC):
                    raise NavfmuError(f"{path}: is not the black box of a run")
                header = _Header.from_buffer_copy(start)
                about = header.version, header.components, header.rows, header.columns
                if about != (VERSION, len(plan.parts), plan.rows, len(plan.recorded)):
                    raise NavfmuError(f"{path}: is the black box of another run, or of another version of navfmu")
                if os.fstat(file.fileno()).st_size != size(plan):
                    raise NavfmuError(f"{path}: the black box of a run is damaged: its length is wrong")
                return cls(path, plan, file)
        except OSError as error:
            raise NavfmuError(f"{path}: cannot be read: {error.strerror or error}") from None

    def __enter__(self) -> BlackBox:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the file, which stays. An engine that writes into it must be closed before."""
        del self.place, self.logs, self.rows, self._header
        with suppress(BufferError):  # somebody still holds a part of it; it goes with that
            self._map.close()

    def whereabouts(self) -> str:
        """Where the run is, in words."""
        return whereabouts(self.plan, self.place)

    def culprit(self) -> dict[str, str | float]:
        """The component being called, the call, and the time (s); nothing while no component is being called."""
        place = self.place
        if not (0 <= place.component < len(self.plan.parts) and 0 <= place.call < len(NAMES)):
            return {}
        name = self.plan.parts[place.component].component.name
        return {"component": name, "call": NAMES[place.call], "time": self.plan.clock.time(place.k)}

    def said(self) -> str:
        """What the FMU that is being called has complained about, or nothing."""
        number = self.place.component
        if not 0 <= number < len(self.plan.parts):
            return ""
        return self.logs[number].complaint()

    def recording(self) -> Recording | None:
        """The rows recorded so far; None before the row of t = 0."""
        count = min(max(self.place.rows, 0), self.plan.rows)
        if not count:
            return None
        notes = warned(self.plan, self.logs, [0] * len(self.logs))
        notes += complained(self.plan, self.logs, [self.place.component])
        return recording(self.plan, self.rows[:count].copy(), notes)


def steps_made(path: str | Path) -> int:
    """How far the run is that writes this file, without its plan; 0 while there is no such file."""
    with suppress(OSError), open(path, "rb") as file:
        start = file.read(ctypes.sizeof(_Header))
        if len(start) == ctypes.sizeof(_Header) and start.startswith(MAGIC):
            return _Header.from_buffer_copy(start).place.k
    return 0


def size(plan: Plan) -> int:
    """Bytes of the file."""
    return ctypes.sizeof(_Header) + ctypes.sizeof(Log) * len(plan.parts) + 8 * plan.rows * len(plan.recorded)


def _reserve(file: BinaryIO, count: int) -> None:
    """Make a file of zeros whose space is there: writing into the mapping of a hole of a full disk ends the process."""
    try:
        os.posix_fallocate(file.fileno(), 0, count)
    except (AttributeError, OSError) as error:  # not on this system, not in this file system
        if isinstance(error, OSError) and error.errno not in (errno.EINVAL, errno.EOPNOTSUPP):
            raise
        file.truncate(count)


def whereabouts(plan: Plan, place: Place) -> str:
    """A place in words: "component 'gps' in fmi2DoStep at t = 3.2 s"."""
    when = f"at t = {plan.clock.time(place.k):.9g} s"
    if not (0 <= place.component < len(plan.parts) and 0 <= place.call < len(NAMES)):
        return f"in no component, {when}"
    return f"component '{plan.parts[place.component].component.name}' in {NAMES[place.call]} {when}"
