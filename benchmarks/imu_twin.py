"""The native IMU against its PythonFMU twin, both in the compiled engine: one sample for each step of 10 ms.

Goal: the twin takes at least 40 x as long.
"""

from __future__ import annotations

from benchmarks.contest import Contest, compete, main
from benchmarks.masters import Ours
from navfmu import System
from navfmu.system import shipped

STEP, LONG = 0.01, 50_000.0
WORK = "The same engine calls both; its own share of the time is in both."


def run(rounds: int = 7) -> list[Contest]:
    def engine(name: str) -> Ours:
        system = System.load(shipped.path(name))
        return Ours(system.plan(stop=LONG, step=STEP, algorithm="jacobi", record_period=LONG))

    shares = {"native": (engine("imu.fmu"), 50_000), "PythonFMU twin": (engine("python/imu.fmu"), 1_000)}
    contenders = {name: (lambda m=m, n=n: m.run(n) / n) for name, (m, n) in shares.items()}
    contest = compete("IMU in the compiled engine", "step of one sample", contenders, rounds, WORK)
    contest.claim(
        "IMU: time of the PythonFMU twin over that of the native FMU", 40.0, contest.ratio("PythonFMU twin", "native")
    )
    return [contest]


if __name__ == "__main__":
    main(run)
