"""A sample of each sensor, at its own rate: the FMU called by a loop in C, and by the compiled engine.

Goals: no sensor takes more than 1 us for a sample in the loop; 24 satellites are measured and solved in 20 us; no
attitude filter takes more than 5 us for an inertial sample, its share of the aiding included.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from benchmarks import overhead
from benchmarks.contest import Contest, compete, main
from benchmarks.everything_on import EVERYTHING
from benchmarks.masters import BareLoop, Ours
from navfmu import System
from navfmu.ssp import SystemSource
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
    "gps_attitude": 0.5,
    "weather": 1.0,
    "imu_replay": 0.01,
    "magnetometer_replay": 0.01,
    "air_data_replay": 0.01,
    "gps_replay": 0.01,
}
"""Step of the master, s: one sample each. What replays does at every tick what it does where a sample comes."""
FILTERS = {
    "ahrs": {},
    "ahrs_velocity": {},
    "ahrs_vectors": {},
    "ahrs_euler": {"gains": 1},
    "ahrs_euler, gains scheduled": {"gains": 2},
    "ahrs_quaternion": {"gains": 1},
    "ahrs_quaternion, gains scheduled": {"gains": 2},
}
"""Attitude filters as they are, behind sensors of their own, and what they are told; named by FMU first."""
SAMPLE = 0.01
"""Of their inertial unit, s."""
MEASUREMENTS = 20_000
WORK = (
    "The loop makes the FMI call and reads the outputs; the engine also checks the status. The inputs do not change: "
    "what an FMU does with them it does at every sample all the same."
)


def run(rounds: int = 7) -> list[Contest]:
    contests = []
    for name, step in SENSORS.items():
        system = System.load(shipped.path(f"{name}.fmu"))
        for told in ({}, EVERYTHING.get(name)):
            if told is not None:
                title = f"{name}, every error on" if told else name
                contests.append(sampled(system, title, _of(name, told), step, SAMPLES, rounds, limit=1.0))
    contests += filters(rounds)
    with tempfile.TemporaryDirectory() as scratch:
        alone, both = (System.load(overhead.system(Path(scratch), solved)) for solved in (False, True))
    told = _of("gps_signals", EVERYTHING["gps_signals"])
    for more, parameters in (("", overhead.MOTION), (", every error on", told)):
        for name, system, limit in (("gps_signals", alone, None), ("gps_signals and gps_solver", both, 20.0)):
            title = f"{name}, 24 satellites{more}"
            contests.append(sampled(system, title, parameters, overhead.PERIOD, MEASUREMENTS, rounds, limit))
    return contests


def filters(rounds: int) -> list[Contest]:
    """An inertial sample of each attitude filter, with that of the sensors before it, and of these alone."""
    with tempfile.TemporaryDirectory() as scratch:
        sensors = System.load(_behind_sensors(Path(scratch)))
        contests = [sampled(sensors, "inertial unit, magnetometer and air data", {}, SAMPLE, SAMPLES, rounds, None)]
        alone = 1e6 * contests[0].median("bare C loop")
        for title, told in FILTERS.items():
            system = System.load(_behind_sensors(Path(scratch), title.partition(",")[0]))
            contest = sampled(system, f"these and {title}", _of("filter", told), SAMPLE, SAMPLES, rounds, None)
            taken = 1e6 * contest.median("bare C loop") - alone
            contest.claim(f"An inertial sample of {title}", 5.0, taken, at_least=False, unit="us")
            contests.append(contest)
    return contests


def _behind_sensors(scratch: Path, filter_: str = "") -> Path:
    """A system of three sensors, and of a filter that takes their samples."""
    made = SystemSource(filter_ or "sensors", fmus=shipped.path("imu.fmu").parent, stop_time=60.0, step=SAMPLE)
    for sensor in ("imu", "magnetometer", "air_data"):
        made.component(sensor, f"{sensor}.fmu")
    if filter_:
        made.component("filter", f"{filter_}.fmu").connect("imu.reading", "filter.imu")
        made.connect("magnetometer.field", "filter.field").connect("air_data.air", "filter.air")
    return made.pack(scratch / f"{made.name}.ssp")


def _of(name: str, values: dict) -> dict:
    return {f"{name}.{key}": value for key, value in values.items()}


def sampled(
    system: System, title: str, parameters: dict, step: float, samples: int, rounds: int, limit: float | None
) -> Contest:
    """Time so many steps of a system; ``limit`` of a step in the loop, us, None where there is none."""
    stop = 10 * (rounds + 2) * samples * step
    plan = system.plan(stop=stop, step=step, record_period=stop, parameters=parameters)
    loop, engine = BareLoop(plan), Ours(plan)
    contenders = {
        "bare C loop": lambda: loop.run(samples) / samples,
        "navfmu": lambda: engine.run(samples) / samples,
    }
    contest = compete(title, "sample", contenders, rounds, WORK)
    if limit is not None:
        taken = 1e6 * contest.median("bare C loop")
        contest.claim(f"A sample of {title}", limit, taken, at_least=False, unit="us")
    return contest


if __name__ == "__main__":
    main(run)
