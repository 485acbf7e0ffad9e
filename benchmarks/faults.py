"""Twenty faults that act all the time, against none: the backup navigator's flight at 100 Hz.

Goal: they cost less than a tenth of the loop.
"""

from __future__ import annotations

from benchmarks.contest import Contest, compete, main
from benchmarks.flight import LONG, STEP
from benchmarks.masters import Ours
from navfmu import Fault, System
from navfmu.system import shipped

WORK = (
    "Steps of one flight in Gauss-Seidel with the slopes of inputs; loading, initialisation and recording are not in "
    "the times. The twenty faults act at every step, each on one variable, at outputs of nine components and inputs of "
    "two; they are so small that components have the same to do with and without them; something has been seen of each "
    "of them before the first round."
)


def faults() -> list[Fault]:
    """Twenty faults of all sorts, at outputs and at connected inputs."""
    small = [
        ("bias", "imu.reading.rate[1]", {"value": 1e-12}),
        ("drift", "imu.reading.specific_force[3]", {"rate": 1e-15}),
        ("scale", "magnetometer.field.field_b[2]", {"factor": 1.0 + 1e-12}),
        ("noise", "air_data.air.true_airspeed", {"sigma": 1e-9, "period": 1.0}),
        ("quantise", "air_data.air.pressure_altitude", {"step": 1e-9}),
        ("bias", "gps.fix.altitude", {"value": 1e-12}),
        ("bias", "gps.fix.velocity_n[1]", {"value": 1e-12}),
        ("spike", "gps.fix.latitude", {"value": 1e-15, "every": 1.0}),
        ("scale", "dme.ranging.slant_range[1]", {"factor": 1.0 + 1e-12}),
        ("saturate", "ahrs.attitude.heading_sigma", {"low": 1e-3}),
        ("scale", "ahrs.attitude.yaw_rate", {"factor": 1.0 + 1e-12}),
        ("drift", "aircraft.altitude", {"rate": 1e-12}),
        ("bias", "aircraft.roll", {"value": 1e-15}),
        ("quantise", "aircraft.pitch", {"step": 1e-15}),
        ("noise", "wind.wind_n[1]", {"sigma": 1e-9, "period": 1.0}),
        ("bias", "navigator.air.true_airspeed", {"value": 1e-12}),
        ("scale", "evaluation.north_sigma", {"factor": 1.0 + 1e-12}),
        ("bias", "evaluation.altitude", {"value": 1e-9}),
        ("delay", "evaluation.east_sigma", {"delay": 0.05}),
        ("slow", "navigator.solution.altitude", {"period": 1.0}),
    ]
    return [Fault(f"{n}_{kind}", target, kind, **given) for n, (kind, target, given) in enumerate(small, 1)]


def run(rounds: int = 60) -> list[Contest]:
    system = System.load(shipped.path("backup_navigator.ssp"))

    def ours(*acting: Fault) -> Ours:
        options = {"stop": LONG, "step": STEP, "record_period": LONG, "faults": acting}
        return Ours(system.plan(record=["evaluation.horizontal_error"], **options))

    contenders = {"no fault": ours(), "twenty faults": ours(*faults())}
    for contender in contenders.values():
        contender.run(5_000)
    seen = contenders["twenty faults"].engine._effects["seen"]
    assert (seen >= 0).all(), "a fault has changed nothing yet, and what it costs is another question"
    contest = compete(
        "backup navigator, faults",
        "macro step",
        {name: lambda m=m: m.run(5_000) / 5_000 for name, m in contenders.items()},
        rounds,
        WORK,
    )
    text = "Flight, Gauss-Seidel: time with twenty active faults over that with none"
    contest.claim(text, 1.1, contest.ratio("twenty faults", "no fault"), at_least=False)
    return [contest]


if __name__ == "__main__":
    main(run)
