"""The test FMU ``probe.c`` as components of a system: a lag, and windows on what its master does."""

from __future__ import annotations

import dataclasses
import hashlib
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from navfmu.engine import compiled, reference
from navfmu.engine.component import Component
from navfmu.engine.library import RUNTIME
from navfmu.engine.link import Link
from navfmu.engine.plan import Plan, make_plan
from navfmu.engine.recording import Recording
from navfmu.export import toolchain
from navfmu.fmi.description import Description, Variable
from navfmu.fmi.fmu import Fmu

HERE = Path(__file__).parent


@cache
def library() -> Path:
    """The compiled probe; kept between test runs."""
    return compile_fmu(HERE / "probe.c")


def compile_fmu(source: Path) -> Path:
    """The library of an FMU in one C file; kept between test runs."""
    name = hashlib.sha256(source.read_bytes()).hexdigest()[:12]
    path = Path(tempfile.gettempdir()) / f"navfmu-{source.stem}-{name}" / f"{source.stem}{toolchain.suffix('host')}"
    return path if path.exists() else toolchain.compile_shared([source], path, include=[RUNTIME])


def _variables() -> tuple[Variable, ...]:
    real = [
        ("u", "input", "continuous", None, 0.0),
        ("y", "output", "continuous", None, None),
        ("tau", "parameter", "fixed", "exact", 1.0),
        ("gain", "parameter", "tunable", "exact", 1.0),
        ("start", "parameter", "fixed", "exact", 0.0),
        ("fail_at", "parameter", "fixed", "exact", 1e9),
        ("seen", "output", "discrete", None, None),  # u at the end of the step
        ("slope", "output", "discrete", None, None),
        ("time", "local", "continuous", None, None),
        ("data.value", "output", "discrete", None, None),
        ("data.time_of_validity", "output", "discrete", None, None),
        ("current", "output", "discrete", None, None),  # u + 100, computed once, at the end of initialisation
        ("sets", "local", "discrete", None, None),  # how many times something was set
    ]
    integer = [
        ("number", "input", "discrete", None, 0),
        ("echo", "output", "discrete", None, None),
        ("fail_status", "parameter", "fixed", "exact", 0),
        ("fail_call", "parameter", "fixed", "exact", 0),
        ("data.sequence", "output", "discrete", None, None),
    ]
    boolean = [
        ("flag", "input", "discrete", None, False),
        ("flag_echo", "output", "discrete", None, None),
        ("data.valid", "output", "discrete", None, None),
    ]
    ranges = {"tau": {"min": 1e-3}, "gain": {"min": -10.0, "max": 10.0}}
    variables = [Variable("label", 0, "String", "parameter", "fixed", "exact", "probe")]
    for kind, rows in (("Real", real), ("Integer", integer), ("Boolean", boolean)):
        for number, (name, *rest) in enumerate(rows):
            unit = "1" if kind == "Real" else None
            variables.append(Variable(name, number, kind, *rest, unit=unit, **ranges.get(name, {})))
    return tuple(variables)


VARIABLES = _variables()


def probe(
    name: str,
    *,
    interpolates: bool = False,
    any_step: bool = True,
    restores: bool = True,
    single: bool = False,
    guid: str = "{probe}",
    binary: Path | None = None,
    **start: Any,
) -> Component:
    """A component; ``start`` gives parameters and inputs."""
    binary = binary or library()
    description = Description(
        model_name="probe",
        guid=guid,
        model_identifier="probe",
        variables=VARIABLES,
        only_one_instance=single,
        can_get_and_set_state=restores,
        can_interpolate_inputs=interpolates,
        can_handle_variable_step=any_step,
    )
    return Component(name, Fmu(binary, "", binary.parent, binary, description), start)


def declared(component: Component, **dependencies: tuple[str, ...]) -> Component:
    """A probe that says on which inputs its outputs depend."""
    about = dataclasses.replace(component.description, dependencies=dependencies)
    return dataclasses.replace(component, fmu=dataclasses.replace(component.fmu, description=about))


def known(component: Component, *names: str) -> Component:
    """A probe some outputs of which have a start value of the user's choice."""
    about = component.description
    variables = tuple(dataclasses.replace(v, initial="exact") if v.name in names else v for v in about.variables)
    about = dataclasses.replace(about, variables=variables)
    return dataclasses.replace(component, fmu=dataclasses.replace(component.fmu, description=about))


def ring(count: int = 6, **start: Any) -> tuple[list[Component], list[Link]]:
    """Lags in a circle."""
    lags = [probe(f"lag{i}", **({"start": 1.0} | start)) for i in range(count)]
    return lags, [Link(f"lag{i}.y", f"lag{(i + 1) % count}.u") for i in range(count)]


def chain(count: int, *, interpolates: bool = False, **start: Any) -> tuple[list[Component], list[Link]]:
    """Lags in a row; the first has the input u, every lag starts at 0."""
    lags = [probe(f"lag{i}", interpolates=interpolates, **(start if i == 0 else {})) for i in range(count)]
    return lags, [Link(f"lag{i}.y", f"lag{i + 1}.u") for i in range(count - 1)]


def run_both(plan: Plan) -> Recording:
    """Run a plan in both engines, which must agree to the last bit."""
    fast, slow = compiled.run(plan), reference.run(plan)
    assert fast.names == slow.names
    assert fast.time.tobytes() == slow.time.tobytes()
    different = [name for name in fast.names if fast[name].tobytes() != slow[name].tobytes()]
    assert not different, f"engines differ in {different}"
    assert fast.idle == slow.idle
    assert fast.acted == slow.acted
    assert repr(fast.observed) == repr(slow.observed)  # NaN is NaN
    return fast


def simulate(system: tuple[list[Component], list[Link]], **options: Any) -> Recording:
    """Plan and run a system in both engines."""
    return run_both(make_plan(*system, **options))


def rows(recording: Recording) -> np.ndarray:
    """Communication points of a recording as whole numbers of its first step."""
    return np.round(recording.time / recording.time[1]).astype(int)
