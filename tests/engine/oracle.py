"""A second master for systems of probes: the prose of docs/master.md and docs/faults.md, read anew.

It shares nothing with the plan: no FMU, no signals in vectors, no order, no table of faults. Each value is looked up
by its name, and an input asks at each step what it should be.
"""

from __future__ import annotations

from collections.abc import Sequence

from navfmu.engine.component import Component
from navfmu.engine.link import Link
from navfmu.faults import Fault

Values = dict[str, float]
INPUTS = ("u", "number", "flag")


class Probe:
    """The lag of probe.c."""

    def __init__(self, component: Component) -> None:
        self.start = {"u": 0.0, "number": 0, "flag": False, "tau": 1.0, "gain": 1.0, "start": 0.0} | dict(
            component.start
        )
        self.out: Values = {name: 0.0 for name in ("seen", "slope", "current", "echo", "flag_echo")}
        self.out |= {"data.value": 0.0, "data.sequence": 0.0, "data.valid": 0.0, "y": self.start["start"]}

    def leave(self, given: Values) -> None:
        """End of initialisation."""
        self.out |= {
            "seen": given["u"],
            "current": given["u"] + 100,
            "echo": given["number"],
            "flag_echo": given["flag"],
        }

    def step(self, t: float, h: float, given: Values, slope: float) -> None:
        """One step."""
        middle = self.start["gain"] * (given["u"] + 0.5 * slope * h)
        y = self.out["y"] + h * (middle - self.out["y"]) / self.start["tau"]
        self.out |= {"y": y, "seen": given["u"] + slope * h, "slope": slope, "echo": given["number"]}
        self.out |= {"flag_echo": given["flag"], "data.value": 10 * (t + h), "data.valid": 1.0}
        self.out["data.sequence"] += 1


def cuts(names: Sequence[str], edges: set[tuple[str, str]]) -> set[tuple[str, str]]:
    """What is cut: as long as a component needs itself, the first that does takes nothing from its circle."""

    def needs(a: str, b: str, live: set[tuple[str, str]]) -> bool:
        known, new = set(), {a}
        while new:
            new = {source for source, target in live if target in new} - known
            known |= new
        return b in known

    cut: set[tuple[str, str]] = set()
    while True:
        live = edges - cut
        first = next((name for name in names if needs(name, name, live)), None)
        if first is None:
            return cut
        cut |= {(a, b) for a, b in live if b == first and needs(a, first, live)}


def disturbed(value: float, name: str, faults: Sequence[Fault], t: float, at: float) -> float:
    """A value under the faults that act at ``t``, for the time ``at``."""
    for fault in faults:
        if fault.target != name or not fault.start - 1e-9 <= t < fault.start + fault.duration - 1e-9:
            continue
        if fault.type == "bias":
            value += fault.parameters["value"]
        elif fault.type == "drift":
            value += fault.parameters["rate"] * (at - fault.start)
        else:
            value = fault.parameters["value"]
    return value


def simulate(
    components: Sequence[Component],
    links: Sequence[Link],
    faults: Sequence[Fault],
    *,
    step: float,
    steps: int,
    algorithm: str,
) -> dict[str, list[float]]:
    """All outputs as they leave, and all outputs as they are ("...@true"), at each communication point."""
    probes = {c.name: Probe(c) for c in components}
    smooth = {c.name for c in components if c.fmu.description.can_interpolate_inputs}
    link_of = {link.target: link for link in links}
    edges = {(link.source.split(".")[0], link.target.split(".")[0]) for link in links}
    cut = cuts(list(probes), edges)

    def passed(link: Link | None, at_source: float) -> float:
        return at_source if link is None or not link.scaled else link.factor * at_source + link.offset

    def true(name: str) -> float:
        component, variable = name.split(".", 1)
        return float(probes[component].out[variable])

    def leaving(t: float) -> Values:
        return {
            f"{n}.{v}": disturbed(true(f"{n}.{v}"), f"{n}.{v}", faults, t, t) for n, p in probes.items() for v in p.out
        }

    def free(name: str, t: float) -> float:
        component, variable = name.split(".")
        return disturbed(float(probes[component].start[variable]), name, faults, t, t)

    for _ in range(len(probes) + 1):  # t = 0: until nothing changes any more
        now = leaving(0.0)
        for name, one in probes.items():
            ends = {i: link_of.get(f"{name}.{i}") for i in INPUTS}
            one.leave({i: passed(k, now[k.source]) if k else free(f"{name}.{i}", 0.0) for i, k in ends.items()})
    now = leaving(0.0)
    history = {name: [value] for name, value in now.items()} | {f"{name}@true": [true(name)] for name in now}

    for k in range(steps):
        t, end = k * step, (k + 1) * step
        done: set[str] = set()

        def given(name: str, variable: str, t: float, end: float, now: Values, done: set[str]) -> tuple[float, float]:
            """An input over the step, and its slope."""
            link = link_of.get(f"{name}.{variable}")
            if link is None:
                return free(f"{name}.{variable}", t), 0.0
            source, output = link.source.split(".", 1)
            begin = passed(link, now[link.source])
            if source not in done:
                return begin, 0.0
            if output != "y" or variable != "u":  # discrete: the newest, as it leaves
                return passed(link, disturbed(true(link.source), link.source, faults, end, end)), 0.0
            newest = passed(link, disturbed(true(link.source), link.source, faults, t, end))
            return (begin, (newest - begin) / step) if name in smooth else (newest, 0.0)

        while len(done) < len(probes):
            ready = next(n for n in probes if n not in done and not {a for a, b in edges - cut if b == n} - done)
            if algorithm == "jacobi":
                ready = next(n for n in probes if n not in done)
            seen = set() if algorithm == "jacobi" else done
            inputs = {i: given(ready, i, t, end, now, seen) for i in INPUTS}
            probes[ready].step(t, step, {i: value for i, (value, _) in inputs.items()}, inputs["u"][1])
            done.add(ready)
        now = leaving(end)
        for name, value in now.items():
            history[name].append(value)
            history[f"{name}@true"].append(true(name))
    return history
