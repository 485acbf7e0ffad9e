"""Both engines against a master that shares no plan with them (oracle.py): random systems, random faults."""

import math

import numpy as np
import pytest

from navfmu.engine.link import Link
from navfmu.faults import Fault
from tests.engine import oracle
from tests.engine.probe import declared, known, probe, simulate

STEP, STEPS = 0.1, 30
NEEDS = {"y": (), "data.value": (), "data.sequence": (), "data.valid": (), "seen": ("u",), "current": ("u",)}
NEEDS |= {"echo": ("number",), "flag_echo": ("flag",)}
WINDOWS = [(0.0, 0.5), (0.5, 0.3), (1.0, 0.1), (2.5, 5.0)]  # from the start, in the middle, one step, beyond the end


def system(rng):
    """Probes in random order: what is passed backwards is ``y``, so that initial values have one solution."""
    count = int(rng.integers(2, 8))
    made = [
        probe(
            f"p{i}",
            interpolates=bool(rng.integers(2)),
            start=float(rng.normal()),
            tau=float(rng.uniform(0.5, 3)),
            gain=float(rng.uniform(-2, 2)),
            u=float(rng.normal()),
            number=int(rng.integers(100)),
            flag=bool(rng.integers(2)),
        )
        for i in range(count)
    ]
    links = []
    for i in range(count):
        if rng.random() < 0.8:
            source = int(rng.integers(count))
            names = ["y", "y", "seen", "current", "data.value", "data.sequence"] if source < i else ["y"]
            scale = {"factor": 0.5, "offset": -0.25} if rng.random() < 0.3 else {}
            links.append(Link(f"p{source}.{rng.choice(names)}", f"p{i}.u", **scale))
        for target, names in (("number", ["echo", "data.sequence"]), ("flag", ["flag_echo", "data.valid"])):
            if i and rng.random() < 0.6:
                links.append(Link(f"p{rng.integers(i)}.{rng.choice(names)}", f"p{i}.{target}"))
    made = [known(declared(one, **NEEDS), "y") for one in made]
    shuffled = [made[i] for i in rng.permutation(count)]
    return shuffled, [links[i] for i in rng.permutation(len(links))]


def random_faults(rng, components, links):
    """Several faults in their order, overlapping, on outputs and on inputs that nothing is connected to."""
    connected = {link.target for link in links}
    free = [f"{c.name}.u" for c in components if f"{c.name}.u" not in connected]
    faults = []
    for number in range(int(rng.integers(5))):
        start, duration = WINDOWS[rng.integers(len(WINDOWS))]
        if free and rng.random() < 0.3:
            target, kind, parameters = str(rng.choice(free)), "input", {"value": float(rng.normal())}
        else:
            target = f"{components[rng.integers(len(components))].name}.{rng.choice(['y', 'seen', 'data.value'])}"
            passed_on = [link.source for link in links if link.target.endswith(".u") and "sequence" not in link.source]
            target = str(rng.choice([target, *passed_on, *passed_on]))
            kind = str(rng.choice(["bias", "drift", "stuck"]))
            parameters = {"rate" if kind == "drift" else "value": float(rng.normal())}
        faults.append(Fault(f"f{number}", target, kind, start, duration, parameters))
    return faults


def waiting(rng, components, faults):
    """Some of the faults come and go, or wait for conditions on values on which others act, or on one another."""
    for fault in faults:
        outputs = [f"{component.name}.{name}" for component in components for name in ("y", "seen", "y@true")]
        failing = [other.target for other in faults if not other.target.endswith(".u")]
        signal, bound = str(rng.choice([*outputs, *failing * 6])), float(rng.normal())
        bound = f"{10 * abs(bound) if 'data' in signal else bound:.3f}"
        condition = str(
            rng.choice(
                [
                    f"{signal} > {bound}",
                    f"{signal} < {bound} and time > 0.35",
                    f"not ({signal} > {bound} or 1.05 < time < 1.35)",
                    f"active({rng.choice(faults).id})",
                    f"not active({rng.choice(faults).id})",
                ]
            )
        )
        turns = {"on": float(rng.choice([0.3, 0.45])), "off": float(rng.choice([0.22, 0.55]))}
        hold = {"hold": float(rng.choice([0.1, 0.25, 0.3]))} if rng.integers(2) else {}
        more = [
            {},
            turns,
            {"when": condition} | hold,
            {"during": condition} | hold,
            {"during": condition} | turns | hold,
        ]
        chosen = more[rng.integers(len(more))]
        duration = math.inf if rng.integers(2) else fault.duration
        yield Fault(fault.id, fault.target, fault.type, fault.start, duration, fault.parameters | chosen)


@pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])
@pytest.mark.parametrize("waits", [False, True], ids=["timed", "waiting"])
@pytest.mark.parametrize("seed", range(60))
def test_random_systems_run_as_the_documentation_says(seed, algorithm, waits):
    """Wrong with conditions: one step early or late, seen without other faults, a drift from the start of the run."""
    rng = np.random.default_rng(seed)
    components, links = system(rng)
    faults = random_faults(rng, components, links)
    faults = list(waiting(rng, components, faults)) if waits else faults
    want = oracle.simulate(components, links, faults, step=STEP, steps=STEPS, algorithm=algorithm)
    recording = simulate(
        (components, links), step=STEP, stop=STEP * STEPS, algorithm=algorithm, faults=faults, record=list(want)
    )
    for name in want:
        np.testing.assert_allclose(recording[name], want[name], rtol=1e-11, atol=1e-11, err_msg=name)
