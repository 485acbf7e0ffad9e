"""Flies the shipped system with sanitized libraries. Started by ``test_sanitizers.py``, not by pytest.

The arguments are the packed system, the sanitized engine, and the folder with a sanitized library for each FMU.
"""

import sys
from dataclasses import replace
from pathlib import Path

from navfmu import System
from navfmu.engine import compiled
from navfmu.engine.component import Component
from navfmu.engine.plan import Plan
from navfmu.faults import Fault
from tests.sanitizers import use

STOP = 60.0  # s
FAULTS = [
    Fault("jammed", "gps.jammed", "input", 20.0),
    Fault("off", "dme.station_off[2]", "input", 25.0, 20.0),
    Fault("iron", "magnetometer.hard_iron_change", "input", 10.0, 30.0, {"value": 2e-6}),
    Fault("pitot", "air_data.pitot_blocked", "input", 30.0, 10.0),
    Fault("static", "air_data.static_blocked", "input", 45.0, 5.0),
    Fault("gyro", "imu.reading.rate", "bias", 15.0, 30.0, {"value": [0.01, 0.0, -0.01]}),
    Fault("wind", "wind.wind_n", "drift", 0.0, 50.0, {"rate": [0.1, 0.2, 0.0]}),
    Fault("altitude", "aircraft.altitude", "noise", 5.0, 50.0, {"sigma": 5.0, "period": 0.25}),
    Fault("range", "dme.ranging.slant_range[1]", "bias", 35.0, 10.0, {"value": 500.0}),
    Fault("silent", "air_data.air", "dropout", 40.0, 3.0),
    Fault("roll", "ahrs.attitude.roll", "stuck", 50.0, 5.0),
    Fault("counted", "dme.ranging.sequence", "stuck", 55.0, 2.0, {"value": 2147483647}),
]


def sanitized(plan: Plan, folder: Path) -> Plan:
    """The plan with the libraries of ``folder`` in the place of the FMUs' own."""

    def with_other(component: Component) -> Component:
        library = folder / f"{component.description.model_identifier}.so"
        return replace(component, fmu=replace(component.fmu, library=library))

    return replace(plan, parts=tuple(replace(part, component=with_other(part.component)) for part in plan.parts))


def main(package: str, engine: str, folder: str) -> None:
    use(engine)
    system = System.load(package, "bay_area_scanning")
    for algorithm in ("jacobi", "gauss_seidel"):
        for step, faults in ((0.01, FAULTS), (0.05, [])):
            plan = system.plan(
                stop=STOP, step=step, algorithm=algorithm, seed=3, faults=faults, record=["*"], record_period=1.0
            )
            with compiled.Compiled(sanitized(plan, Path(folder))) as run:
                run.initialise()
                run.advance(plan.clock.steps // 2)
                snapshot = run.snapshot()
                run.advance()
                run.restore(snapshot)
                run.advance()
                run.free(snapshot)
                flight = run.recording()
            coasting = flight["navigator.mode"][-1] == 2.0
            assert coasting == bool(faults), "the faults must reach the navigator"
            assert not faults or flight["navigator.used"][-1] > 10.0, "the ranges must be used"
    print("clean")


main(*sys.argv[1:])
