"""Report of a single run: what was run, its notes, pictures and numbers, and how to repeat it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from navfmu.files.writing import write_file
from navfmu.fmi.names import stands_for
from navfmu.report import faults
from navfmu.report.kind import Picture
from navfmu.report.page import Page
from navfmu.report.pictures import lines
from navfmu.report.repeat import section
from navfmu.report.scene import Recorded
from navfmu.system.assembly import Assembly
from navfmu.system.experiment import Experiment
from navfmu.system.report_file import missing
from navfmu.system.result import write
from navfmu.system.results_folder import check_results
from navfmu.system.scene import scene_of
from navfmu.system.summary import summary

if TYPE_CHECKING:
    import pandas

RECORDING = "recording.parquet"
DRAWN = 24  # signals that are drawn where the system says nothing about its report


def to_record(record: Sequence[str] | None, system: Assembly) -> list[str]:
    """What must be recorded for the report of a run that was asked to record ``record``."""
    report = system.report
    named = system.signals(record or system.default_record or list(system.fmus))
    pictures = report.pictures if report else ()
    needed = [name for picture in pictures if not missing(picture, system.fmus) for name in picture.needs()]
    return named + [name for name in dict.fromkeys(needed) if not any(stands_for(other, name) for other in named)]


def write_report(
    frame: pandas.DataFrame, experiment: Experiment, folder: str | Path, named: Sequence[str] = ()
) -> Path:
    """Write ``report.html`` and the recording into a folder; return the path of the report.

    Signals in ``named`` are drawn beside the pictures of the system's report file. A folder with the results of
    something else is refused.
    """
    check_results(folder, "a run", "report.html", RECORDING)
    folder = Path(folder)
    write(frame, folder / RECORDING)
    return write_file(folder / "report.html", page(frame, experiment, named).html())


def page(frame: pandas.DataFrame, experiment: Experiment, named: Sequence[str] = ()) -> Page:
    """The whole report."""
    system = experiment.system
    what = f"{experiment.stop:g} s in steps of {experiment.step:g} s, {experiment.algorithm}, {_seed(experiment)}"
    about = system.structure.description
    result = Page(f"Run of {system.name}", f"{about}{'. ' if about else ''}{what}")
    if experiment.parameters:
        result.heading("Changed parameters")
        result.table(["parameter", "value"], [[name, str(value)] for name, value in experiment.parameters.items()])
    if experiment.faults:
        result.heading("Faults")
        result.table(faults.HEADINGS, [faults.cells(fault.describe()) for fault in experiment.faults])
    if frame.attrs["notes"]:
        result.heading("Notes")
        result.items(frame.attrs["notes"])
    _pictures(result, frame, experiment, named)
    result.heading("Recorded signals")
    result.text(f"{len(frame)} rows of {len(frame.columns)} signals are in {RECORDING} beside this report.")
    for block in summary(frame, system):
        if block.title:
            result.text(f"{block.title.capitalize()}:")
        result.table(block.headings, block.rows)
    section(result, frame.attrs["provenance"])
    return result


def _pictures(result: Page, frame: pandas.DataFrame, experiment: Experiment, named: Sequence[str]) -> None:
    fmus, report = experiment.system.fmus, experiment.system.report
    pictures: list[Picture] = list(report.pictures) if report else []
    drawn = list(frame.columns)
    if pictures or named:
        drawn = [name for name in drawn if any(stands_for(other, name) for other in named)]
    if drawn:
        pictures.append(lines.Picture(kind="lines", signals=drawn[:DRAWN]))
    result.heading("Pictures")
    columns = {column: frame[column].to_numpy() for column in frame}
    run = Recorded(_seed(experiment), frame.index.to_numpy(), columns, experiment.points)
    for picture in pictures:
        lacking = missing(picture, fmus)
        if lacking:
            result.text(f"The picture '{picture.kind}' is left out: this variant has no {', '.join(lacking)}.")
            continue
        made = picture.draw(scene_of(picture, experiment, [run], run, [frame.attrs["acted"]]))
        result.picture(made.png, made.title, made.caption)
    if len(drawn) > DRAWN:
        result.text(
            f"Of {len(drawn)} signals the first {DRAWN} are drawn; 'navfmu plot {RECORDING} SIGNAL' draws any of them."
        )


def _seed(experiment: Experiment) -> str:
    return "the system's own seeds" if experiment.seed is None else f"seed {experiment.seed}"
