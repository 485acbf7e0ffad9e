"""Runs plans with an engine that was built with sanitizers. Started by ``test_sanitizers.py``, not by pytest.

The arguments are the sanitized engine, the sanitized probe and the sanitized stepper.
"""

import itertools
import sys
import tempfile
from pathlib import Path

from navfmu.engine import compiled
from navfmu.engine.link import Link
from navfmu.engine.monitor import Monitor
from navfmu.engine.plan import make_plan
from navfmu.engine.recording import RunError
from navfmu.faults import Fault
from tests.engine import probe as probes
from tests.engine.probe import chain, probe, ring
from tests.foreign import stepper as steppers
from tests.foreign.stepper import stepper
from tests.sanitizers import use

use(sys.argv[1])
probes.library = lambda: Path(sys.argv[2])
steppers.library = lambda: Path(sys.argv[3])

FAULTS = [
    Fault("bias", "lag0.y", "bias", 2.0, 3.0, {"value": 0.5}),
    Fault("drift", "lag2.y", "drift", 0.0, 9.0, {"rate": 0.1}),
    Fault("stuck", "lag1.y", "stuck", 6.0, 1.0),
    Fault("given", "lag3.echo", "stuck", 6.0, 1.0, {"value": 9}),
    Fault("late", "lag0.data", "dropout", 4.5, 2.0),
    Fault("tiny", "lag1.y", "bias", 0.5, 8.0, {"value": 1e-300}),
    Fault("noise", "lag1.y", "noise", 1.0, 6.0, {"sigma": 0.1, "period": 0.25}),
    Fault("held", "lag1.y", "stuck", 6.5, 1.0),
    Fault("pushed", "lag2.number", "input", 3.0, 4.0, {"value": 7}),
    Fault("raised", "lag2.flag", "input", 0.0, 4.0),
    Fault("turned", "lag3.gain", "parameter", 3.0, 4.0, {"value": 2.0}),
    Fault("once", "lag0.y", "delay", 1.0, 2.0, when="lag1.y@true > 0.1 and not active(turned)", hold=0.3, delay=0.4),
    Fault("phase", "lag1.u", "spike", during="lag0.data.sequence < 70 or lag2.flag", value=1.0, every=0.3),
    Fault("flicker", "lag2.y", "garbage", during="not active(flicker)", low=0.0, high=1.0, period=0.2),
    Fault("random", "lag3", "lost_step", mttf=0.5, mttr=0.4),
    Fault("slow", "lag0.data", "slow", on=0.5, off=0.3, period=0.2),
    Fault("turn", ["lag2.y", "lag2.seen"], "swap", when="time > 5", order=[2, 1]),
]
MONITORS = [
    Monitor("value", "norm(lag0.y, lag1.u) / lag2.y@true", most=1.0, when="active()", tolerance=0.2),
    Monitor("onset", "lag1.y > 0.5", counts_from="onset", fault="phase"),
    Monitor("over", "lag1.y > 0.5", counts_from="over", fault="flicker"),
    Monitor("any", "lag3.flag_echo", counts_from="over"),
]


def circle(algorithm: str, folder: Path) -> None:
    """Values of all types that go round in initialisation mode; at 0.5 s one of the FMUs wants no more."""
    file = steppers.write(folder / f"{algorithm}.fmu")
    system = [stepper("a", file, number=3, bias=1.0), stepper("b", file, flag=True, ends_at=0.5), stepper("c", file)]
    links = [Link("a.double", "b.number"), Link("b.not", "a.flag"), Link("a.fixed", "b.u"), Link("b.direct", "a.u")]
    faults = [
        Fault("bias", "a.fixed", "bias", 0.0, 0.3, {"value": 0.5}),
        Fault("stuck", "b.not", "stuck", 0.0, 0.2),
        Fault("number", "c.number", "input", 0.0, 0.2, {"value": 9}),
    ]
    for some in ([], faults):
        plan = make_plan(system, [*links, Link("b.x", "c.u")], step=0.1, stop=1.0, algorithm=algorithm, faults=some)
        assert len(compiled.run(plan).time) == 6


def main() -> None:
    for algorithm, interpolates in itertools.product(("jacobi", "gauss_seidel"), (True, False)):
        lags, connections = chain(4, interpolates=interpolates, start=1.0, u=0.5, label="first of them")
        connections += [Link("lag0.data.sequence", "lag1.number"), Link("lag0.data.valid", "lag1.flag")]
        with tempfile.TemporaryDirectory() as folder:
            circle(algorithm, Path(folder))
        for faults in ([], FAULTS):
            plan = make_plan(
                lags,
                connections,
                step=0.1,
                stop=10.0,
                algorithm=algorithm,
                faults=faults,
                record=["*"],
                monitors=MONITORS,
            )
            with compiled.Compiled(plan) as engine:
                engine.initialise()
                engine.advance(40)
                snapshot = engine.snapshot()
                engine.advance()
                engine.restore(snapshot)
                engine.advance()
                engine.free(snapshot)
                engine.recording()
        compiled.run(make_plan(*ring(), step=0.1, stop=10.0, algorithm=algorithm, record_period=0.3))
        compiled.run(make_plan([probe("alone")], [], step=0.1, stop=1.0, algorithm=algorithm, record=[]))
        for call in range(5):
            bad = probe("bad", fail_call=call, fail_status=3, fail_at=0.0, u=1.0, label="x" * 60)
            for pushed in ([], [Fault("push", "bad.u", "input", 0.5, 1.0, {"value": 2.0})]):
                try:
                    compiled.run(make_plan([bad], [], step=0.1, stop=1.0, algorithm=algorithm, faults=pushed))
                except RunError as error:
                    assert "gave up" in str(error)
    print("clean")


main()
