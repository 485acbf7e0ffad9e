"""Flies the searches of a campaign: one run after the other in each, several searches at a time."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from pathlib import Path
from threading import Lock

from navfmu.campaign.judged import Judged, judge_run
from navfmu.campaign.runs import Answer, Run
from navfmu.campaign.threshold import Sought, Threshold
from navfmu.errors import NavfmuError
from navfmu.system.pool import Board, Report, in_threads

Hand = Callable[[Run, Path, Callable[[int, int], None]], None]  # flies a run and leaves its answer in the folder


class Searching:
    """Searches under way. What they ask next depends on what was seen, so a second start asks the same again."""

    def __init__(self, sought: Sequence[Sought], folder: Path, retry_failed: bool, progress: Report | None) -> None:
        self.sought, self.folder, self.retry_failed, self.progress = sought, folder, retry_failed, progress
        self.mended: list[str] = []  # answers that were damaged, and so flown again
        self.seen: set[str] = set()  # keys of runs
        self._locks: defaultdict[str, Lock] = defaultdict(
            Lock
        )  # variants may be alike: no run is flown twice at a time

    def found(self, hand: Hand, jobs: int | None) -> list[Threshold]:
        """What all searches find, in their order."""
        places = {id(sought): number for number, sought in enumerate(self.sought)}
        board = Board(sum(map(_steps, self.sought)), self.progress)

        def search(sought: Sought) -> Threshold:
            return self._found(sought, hand, board.of(places[id(sought)], _steps(sought)))

        answers = {places[id(sought)]: found for sought, found in in_threads(self.sought, search, jobs, board)}
        return [answers[number] for number in sorted(answers)]

    def _found(self, sought: Sought, hand: Hand, report: Callable[[int, int], None]) -> Threshold:
        total, made = _steps(sought), 0

        def judge(run: Run) -> Judged:
            nonlocal made
            judged = self._judged(sought, run, lambda part, _: hand_on(made + part), hand)
            made += run.steps
            hand_on(made)
            return judged

        def hand_on(steps: int) -> None:
            report(min(steps, total - 1), total)

        threshold = sought.found(judge)
        report(total, total)
        return threshold

    def _judged(self, sought: Sought, run: Run, report: Callable[[int, int], None], hand: Hand) -> Judged:
        """The run, which is flown unless it is kept."""
        with self._locks[run.key]:
            answer = self._kept(run)
            again = self.retry_failed and run.key not in self.seen
            if answer is None or (again and answer.error is not None):
                hand(run, self.folder, report)
                answer = Answer.read(run, self.folder)
            self.seen.add(run.key)
        return judge_run(sought.campaign, run, answer)

    def _kept(self, run: Run) -> Answer | None:
        try:
            return Answer.read(run, self.folder)
        except NavfmuError as error:
            self.mended.append(str(error))
            return None


def _steps(sought: Sought) -> int:
    """The macro steps that a search takes at most."""
    campaign, case = sought.campaign, sought.search.case
    step = campaign.step if case.step is None else case.step
    return sought.search.most * round(campaign.stop / step)
