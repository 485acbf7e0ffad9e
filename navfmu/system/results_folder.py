"""The folder of a report: it holds what one kind of work has left, and is not the folder of a system."""

from __future__ import annotations

import re
from pathlib import Path

from navfmu.errors import NavfmuError
from navfmu.files.reading import what_is
from navfmu.ssp.document import MAIN
from navfmu.system.result import check_folder

KINDS = {  # what a folder holds, and the files that say so when all of them are there
    "a campaign": ("campaign.json",),
    "a sweep": ("sweep.json",),
    "an analysis": ("analysis.json",),
    "figures": ("figures.json",),
    "a run": ("recording.parquet", "report.html"),
}
_ANSWER = re.compile(r"[0-9a-f]{16,}\.json")  # of a run, in a campaign that has been interrupted


def check_results(folder: str | Path, kind: str, *files: str) -> Path:
    """Like ``check_folder``; a system, and a folder with the results of another kind than this one, are refused.

    ``kind`` is one of ``KINDS``. What the same kind has left there is replaced or continued.
    """
    path, wanted = check_folder(folder, *files), f"the results of {kind} are to be written; name another folder"
    if what_is(path / MAIN) is not None:
        raise NavfmuError(f"{folder}: is the folder of a system (it has {MAIN}), where {wanted}")
    for other, marks in KINDS.items():
        found = all(what_is(path / mark) is not None for mark in marks)
        if other != kind and (found or (other == "a campaign" and _begun(path))):
            raise NavfmuError(f"{folder}: holds the results of {other}, where {wanted}")
    return path


def _begun(folder: Path) -> bool:
    """Whether a campaign has finished runs there."""
    runs = folder / "runs"
    return what_is(runs) == "a folder" and any(_ANSWER.fullmatch(file.name) for file in runs.glob("*.json"))
