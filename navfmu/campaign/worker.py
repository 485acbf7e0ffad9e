"""A worker process: flies the runs that it is told of, one after the other. ``python -m navfmu.campaign.worker``.

One JSON object a line comes in on standard input. On a copy of standard output three go out for each: when its FMUs
begin, when they have ended, and when it is done; what FMUs print goes to standard error. When the campaign's own
process is gone, standard input ends, and so does the worker, even in the middle of an FMU that never returns.

The run in which an FMU returns fmi2Fatal is the last one: nothing that its library then computes can be trusted.
"""

from __future__ import annotations

import json
import os
import traceback
from pathlib import Path
from queue import SimpleQueue
from threading import Thread
from typing import Any, TextIO

from navfmu.campaign.case import Case
from navfmu.campaign.flight import fly
from navfmu.campaign.runs import Run
from navfmu.engine import fatal
from navfmu.engine.blackbox import BlackBox
from navfmu.engine.plan import Plan
from navfmu.errors import NavfmuError
from navfmu.system.experiment import Experiment
from navfmu.system.system import System


def main() -> None:
    """Answer requests until there are no more."""
    lines, out = _own_streams()
    requests: SimpleQueue[str] = SimpleQueue()
    Thread(target=_listen, args=(lines, requests), daemon=True).start()
    systems: dict[tuple[str, str | None], System] = {}
    say(out, {"ready": True})
    while True:
        request = json.loads(requests.get())
        try:
            _fly(request, systems, out)
            answer: dict[str, Any] = {"done": True, "last": fatal.happened()}
        except NavfmuError as error:
            answer = {"refused": str(error)}
        except Exception:
            answer = {"broken": traceback.format_exc()}
        say(out, answer)


def _own_streams() -> tuple[TextIO, TextIO]:
    """Standard input and output for the campaign alone: FMUs read nothing, and print to standard error, from now on."""
    lines, out = os.fdopen(os.dup(0), encoding="utf-8"), os.fdopen(os.dup(1), "w", encoding="utf-8")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    return lines, out


def _listen(lines: TextIO, requests: SimpleQueue[str]) -> None:
    for line in lines:
        requests.put(line)
    os._exit(0)


def say(out: TextIO, message: dict[str, Any]) -> None:
    """Send a message to the campaign."""
    print(json.dumps(message), file=out, flush=True)


def _fly(request: dict[str, Any], systems: dict[tuple[str, str | None], System], out: TextIO) -> None:
    os.chdir(request["cwd"])  # an FMU may have gone elsewhere
    about = request["experiment"]
    place = about["system"], about["variant"]
    if place not in systems:
        systems[place] = System.load(*place)
    experiment = Experiment.restored(about, systems[place])
    run = Run(request["variant"], Case(request["case"]), experiment, request["key"])

    def begin(plan: Plan) -> BlackBox:
        box = BlackBox.create(request["box"], plan)
        say(out, {"begun": True})
        return box

    fly(run, Path(request["folder"]), memory=begin, landed=lambda: say(out, {"landed": True}))


if __name__ == "__main__":
    main()
