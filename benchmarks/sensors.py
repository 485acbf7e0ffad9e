"""A sample of each sensor, at its own rate: the FMU called by a loop in C, and by the compiled engine.

Goal: no sensor takes more than 1 us for a sample in the loop.
"""

from __future__ import annotations

from benchmarks.contest import Contest, compete, main
from benchmarks.everything_on import EVERYTHING
from benchmarks.masters import BareLoop, Ours
from navfmu import System
from navfmu.system import shipped

SAMPLES = 100_000
SENSORS = {
    "imu": 0.01,
    "ring_laser": 0.01,
    "magnetometer": 0.05,
    "azimuth_detector": 0.05,
    "air_data": 0.1,
    "wind": 0.1,
    "gps": 1.0,
    "dme": 1.0,
    "vor": 1.0,
    "radar_fix": 0.8,
    "doppler_radar": 1 / 7.5,
    "loran": 1.0,
}
"""Step of the master, s: one sample each."""
WORK = (
    "The loop makes the FMI call and reads the outputs; the engine also checks the status. The inputs do not change: "
    "what an FMU does with them it does at every sample all the same."
)


def run(rounds: int = 7) -> list[Contest]:
    contests = []
    for name, step in SENSORS.items():
        system = System.load(shipped.path(f"{name}.fmu"))
        for title, told in ((name, {}), (f"{name}, every error on", EVERYTHING[name])):
            parameters = {f"{name}.{key}": value for key, value in told.items()}
            stop = 10 * (rounds + 2) * SAMPLES * step
            plan = system.plan(stop=stop, step=step, algorithm="jacobi", record_period=step, parameters=parameters)
            loop, engine = BareLoop(plan), Ours(plan)
            contenders = {
                "bare C loop": lambda loop=loop: loop.run(SAMPLES) / SAMPLES,
                "navfmu": lambda engine=engine: engine.run(SAMPLES) / SAMPLES,
            }
            contest = compete(title, "sample", contenders, rounds, WORK)
            contest.claim(f"A sample of {title}", 1.0, 1e6 * contest.median("bare C loop"), at_least=False, unit="us")
            contests.append(contest)
    return contests


if __name__ == "__main__":
    main(run)
