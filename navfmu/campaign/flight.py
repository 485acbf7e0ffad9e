"""One run of a campaign in this process: flown, and kept as a recording and the answer how it ended."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from navfmu.campaign.runs import Answer, Run
from navfmu.engine.recording import Recording, RunError
from navfmu.errors import visible
from navfmu.files.digest import content_hash
from navfmu.files.writing import write_file
from navfmu.system.result import as_frame, other_notes, write

if TYPE_CHECKING:
    import pandas

    from navfmu.engine.blackbox import BlackBox
    from navfmu.engine.plan import Plan


def fly(
    run: Run,
    folder: Path,
    progress: Callable[[int, int], None] | None = None,
    memory: Callable[[Plan], BlackBox] | None = None,
    landed: Callable[[], None] = lambda: None,
) -> None:
    """Do the run; an FMU's refusal is an answer, too, with the rows recorded before.

    ``landed`` is called when no FMU will be called any more, before anything is written.
    """
    try:
        frame = run.experiment.run(progress, memory)
    except RunError as error:
        landed()
        fail(run, folder, str(error), error.place, error.recording)
    else:
        landed()
        _keep(run, folder, frame, None, {})


def fail(run: Run, folder: Path, error: str, place: dict[str, str | float], recording: Recording | None) -> None:
    """Keep why a run failed, and what it had recorded."""
    frame = None
    if recording is not None and len(recording.time):
        frame = as_frame(recording)
        frame.attrs["notes"] = [*run.experiment.notes, *map(visible, recording.notes)]
        frame.attrs["provenance"] = run.experiment.provenance() | {"error": error}
    _keep(run, folder, frame, error, place)


def _keep(
    run: Run, folder: Path, frame: pandas.DataFrame | None, error: str | None, place: dict[str, str | float]
) -> None:
    """Write the recording, and then the answer: what has no answer is run again."""
    file = None if frame is None else write(frame, run.recording(folder, whole=error is None))
    answer = Answer(
        key=run.key,
        variant=run.variant,
        case=run.case.name,
        seed=run.seed,
        error=error,
        place=place,
        recording=None if file is None else file.name,
        sha256=None if file is None else content_hash(file),
        notes=() if frame is None else tuple(other_notes(frame, idle=False)),
        not_finite={} if frame is None else frame.attrs["not_finite"],
        idle={} if frame is None else frame.attrs["idle"],
        acted={} if frame is None else frame.attrs["acted"],
        observed={} if frame is None else frame.attrs["observed"],
    )
    write_file(run.answer(folder), answer.text())
    for other in (run.recording(folder, whole) for whole in (True, False)):
        if other != file:  # of an earlier try
            other.unlink(missing_ok=True)
