"""Six first-order lags in a ring: the FMUs cost next to nothing, what is measured is the master.

Goals: an FMPy loop takes at least 20 x as long, the faster of ecospy and libcosimpy 5 x; at most 2 x a bare C loop.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from benchmarks.contest import Contest, compete, main
from benchmarks.masters import BareLoop, Ecos, FmpyLoop, Libcosim, Ours, check_equal
from navfmu import System
from navfmu.export import Component, Input, Output, Parameter, every, start
from navfmu.export.build import build
from navfmu.ssp import SystemSource

STEP, COUNT = 1.0 / 64.0, 6
WORK = (
    "All run Jacobi over the same FMUs and have the same bits, which is checked after 500 steps; none records. navfmu "
    "and the bare C loop make the same FMI calls; the bare loop checks no status and knows no faults and no names. The "
    "FMPy loop is in Python, as its users write it. ecospy and libcosimpy run masters in C++ that are called once for "
    "many steps; what they do beside the FMI calls is theirs."
)


class Lag(Component):
    """First-order lag, explicit Euler: y <- y + (u - y) T / tau."""

    u = Input("1", description="input")
    y = Output("1", description="output")
    tau = Parameter("s", start=1.0, min=0.01, description="time constant")
    y0 = Parameter("1", start=1.0, description="output at t = 0")
    sample_period = Parameter("s", start=STEP, min=1e-4, description="time between values")

    @start
    def begin(self):
        self.y = self.y0

    @every("sample_period")
    def step(self):
        self.y = self.y + (self.u - self.y) * self.period / self.tau


def make(folder: Path) -> Path:
    """Build the FMU and pack the ring. The lags are so slow that every value still changes in every step at the end:
    an input that stays the same would not be set again, and nothing would be measured."""
    build([Lag], folder)
    system = SystemSource("ring", fmus=folder, stop_time=1e6, step=STEP)
    for i in range(COUNT):
        system.component(f"lag{i}", "lag.fmu")
        system.parameters(f"lag{i}", {"tau": 1e5 * (1.0 + 0.3 * i), "y0": float(i)})
    for i in range(COUNT):
        system.connect(f"lag{i}.y", f"lag{(i + 1) % COUNT}.u")
    return system.pack(folder / "ring.ssp")


def run(rounds: int = 7) -> list[Contest]:
    with tempfile.TemporaryDirectory() as scratch:
        ssp = make(Path(scratch))
        system = System.load(ssp)
        plan = system.plan(stop=2.0**20, step=STEP, algorithm="jacobi", record=["lag0.y"], record_period=2.0**20)
        check_equal(ssp, plan)
        shares = {
            "bare C loop": (BareLoop(plan), 200_000),
            "navfmu": (Ours(plan), 200_000),
            "FMPy loop": (FmpyLoop(plan), 2_000),
            "ecospy": (Ecos(ssp, plan), 20_000),
            "libcosimpy": (Libcosim(ssp, plan), 5_000),
        }
        contenders = {name: (lambda m=m, n=n: m.run(n) / n) for name, (m, n) in shares.items()}
        contest = compete("ring of six lags", "macro step", contenders, rounds, WORK)
    peer = min(("ecospy", "libcosimpy"), key=contest.median)
    ratio = contest.ratio("navfmu", "bare C loop")
    contest.claim("Ring: time of navfmu over that of a bare C loop, which checks nothing", 2.0, ratio, at_least=False)
    contest.claim("Ring: time of an FMPy loop over that of navfmu", 20.0, contest.ratio("FMPy loop", "navfmu"))
    contest.claim(
        f"Ring: time of {peer}, the faster of the two, over that of navfmu", 5.0, contest.ratio(peer, "navfmu")
    )
    return [contest]


if __name__ == "__main__":
    main(run)
