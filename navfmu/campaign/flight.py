"""One run of a campaign in this process: flown, and kept as a recording or as the reason why there is none."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from navfmu.campaign.runs import Run
from navfmu.engine.recording import Recording, RunError
from navfmu.system.result import as_frame, write


def fly(run: Run, folder: Path, progress: Callable[[int, int], None] | None = None, memory: Any = None) -> None:
    """Do the run; an FMU's refusal is kept as its result, with the rows recorded before."""
    try:
        frame = run.experiment.run(progress, memory)
    except RunError as error:
        keep_failure(run, folder, {"error": str(error), **error.place}, error.recording)
    else:
        frame.attrs["provenance"]["key"] = run.key
        write(frame, run.file(folder))


def keep_failure(run: Run, folder: Path, about: dict[str, Any], recording: Recording | None) -> None:
    """Keep why a run failed, and first what it had recorded."""
    if recording is not None and len(recording.time):
        frame = as_frame(recording)
        frame.attrs["notes"] = [*run.experiment.system.notes, *recording.warnings]
        frame.attrs["provenance"] = run.experiment.provenance() | {"key": run.key, "error": about["error"]}
        write(frame, run.partial(folder))
    run.fail(folder, about)
