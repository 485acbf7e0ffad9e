"""What a browser draws of single runs: each is read once, thinned out and packed, the worst ones first."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from navfmu.campaign.judged import Judged, read_series
from navfmu.campaign.outcome import Outcome
from navfmu.campaign.scenes import bounds_of, pictures_of
from navfmu.report.kind import Picture
from navfmu.report.notice import Notice
from navfmu.report.packed import packed
from navfmu.report.panel import Panel
from navfmu.report.scene import Event, Recorded, Scene
from navfmu.system.report_file import missing
from navfmu.system.scene import scene_of

LIMIT = 16_000_000  # letters of all packed runs in one page: what a mail still carries
MOST = 100  # stretches of a run whose peaks are kept, of which there are fewer in a page with more runs
LEAST = 20
SHARED = 110_000  # stretches for all runs
REPEATED = 12  # times a notice is marked in one run


@dataclass(frozen=True)
class Drawn:
    """One run as the page has it: what happened in it, and its curves, or "" where they are left out."""

    events: tuple[Event, ...]
    curves: str


def stretches(runs: int) -> int:
    """In how many stretches a run is thinned out, where a page has so many runs."""
    return int(np.clip(SHARED // max(runs, 1), LEAST, MOST))


def drawn(outcome: Outcome, order: Sequence[int], note: Callable[[int], None] = lambda _: None) -> list[Drawn]:
    """Of ``outcome.every`` run by run; curves in this ``order`` until the page is full."""
    found: dict[int, Drawn] = {}
    artist, room, full = Artist(outcome), LIMIT, False
    for count, number in enumerate(order):
        note(count)
        one = artist.draw(outcome.every[number], curves=not full)
        full = full or len(one.curves) > room
        found[number] = replace(one, curves="") if full else one
        room -= len(found[number].curves)
    return [found[number] for number in range(len(outcome.every))]


class Artist:
    """Draws runs of an outcome."""

    def __init__(self, outcome: Outcome) -> None:
        self._outcome = outcome
        self._stretches = stretches(len(outcome.every))
        self._scenes: dict[tuple[str, str, int], Scene] = {}
        self._pictures: dict[tuple[str, str], list[Picture]] = {}
        self._notices: dict[str, list[Notice]] = {}
        for variant, system in outcome.campaign.systems.items():
            given = system.report.notices if system.report else ()
            self._notices[variant] = [notice for notice in given if not missing(notice, system.fmus)]

    def draw(self, judged: Judged, curves: bool) -> Drawn:
        """What happened in a run, and its curves."""
        run, name = judged.run, judged.answer.recording
        if name is None:
            return Drawn(tuple(_faults(judged)), "")
        pictures, notices = self._pictures_of(judged), self._notices[run.variant]
        needed = [signal for entry in (*(pictures if curves else ()), *notices) for signal in entry.needs()]
        series = read_series(self._outcome.folder / "runs" / name, needed)
        recorded = Recorded(f"seed {run.seed}", series.pop("time"), series, run.experiment.points)
        events = tuple(self._events(judged, notices, recorded))
        return Drawn(events, self._packed(judged, recorded, events) if curves and len(recorded.time) else "")

    def _events(self, judged: Judged, notices: Sequence[Notice], recorded: Recorded) -> Iterator[Event]:
        yield from _faults(judged)
        for notice in notices:
            for time in notice.times(recorded)[:REPEATED]:
                yield Event("notice", notice.label, float(time))
        for requirement in self._outcome.campaign.requirements:
            finding = judged.findings.get(requirement.id)
            if requirement.quantile is None and finding is not None and finding.violated_from is not None:
                yield Event("violation", requirement.id, finding.violated_from)

    def _packed(self, judged: Judged, recorded: Recorded, events: tuple[Event, ...]) -> str:
        panels: list[Panel] = []
        for number, picture in enumerate(self._pictures_of(judged)):
            scene = self._scene(judged, number, picture)
            panels += picture.panels(replace(scene, runs=(recorded,), shown=recorded, events=events))
        windows = [[name, *span] for name, spans in judged.answer.acted.items() for span in spans]
        about = {"windows": windows, "end": float(recorded.points[-1])}
        return packed(panels, about, self._stretches) if panels else ""

    def _pictures_of(self, judged: Judged) -> list[Picture]:
        """Those that can be drawn of the runs of a variant in a case."""
        run = judged.run
        place = run.variant, run.case.name
        if place not in self._pictures:
            fmus = self._outcome.campaign.systems[run.variant].fmus
            every = pictures_of(self._outcome, run.variant, run.case)
            self._pictures[place] = [picture for picture in every if not missing(picture, fmus)]
        return self._pictures[place]

    def _scene(self, judged: Judged, number: int, picture: Picture) -> Scene:
        """All but the run itself, which runs of a variant in a case share."""
        run = judged.run
        place = run.variant, run.case.name, number
        if place not in self._scenes:
            none = Recorded("", np.empty(0), {})
            bounds = bounds_of(self._outcome, run.variant, run.case)
            self._scenes[place] = scene_of(picture, run.experiment, [none], none, [], bounds=bounds)
        return self._scenes[place]


def _faults(judged: Judged) -> Iterator[Event]:
    for fault, spans in judged.answer.acted.items():
        yield from (Event("fault", fault, begin) for begin, _ in spans[:REPEATED])
