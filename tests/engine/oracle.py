"""A second master for systems of probes: the prose of docs/master.md and docs/faults.md, read anew.

It shares nothing with the plan: no FMU, no signals in vectors, no order, no table of faults. Each value is looked up
by its name, and an input asks at each step what it should be.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence

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


def true_for(met: Sequence[bool], step: float, hold: float) -> bool:
    """Whether a condition has been true at all points of a time, the last of which is the last point."""
    points = math.ceil(hold / step - 1e-9) + 1
    return len(met) >= points and all(met[-points:])


def windows(fault: Fault, until: float) -> Iterator[tuple[float, float]]:
    """From when to when a fault may act, as its times say."""
    on, off = (fault.parameters.get(name, math.inf) for name in ("on", "off"))
    waits = "when" in fault.parameters  # its duration is counted from where it begins
    begin, end = fault.start, math.inf if waits else fault.start + fault.duration
    while begin < end and begin < until:
        yield begin, min(begin + on, end)
        begin += on + off


class Acting:
    """When each fault acts: from which time on, by id, at every point up to the one after the last that is known."""

    def __init__(self, faults: Sequence[Fault], step: float, until: float) -> None:
        self.faults, self.step, self.until = faults, step, until
        self.since: list[dict[str, float]] = []  # by point
        self.met: dict[str, list[bool]] = {fault.id: [] for fault in faults}
        self.begun: dict[str, int] = {}
        self.known = 0

    def see(self, left: Values) -> None:
        """All values that left at the next point: conditions are asked, and say what acts at the one after it."""
        if not self.since:
            self.since.append(self._at(0))
        k = self.known
        active = self.since[k]
        for fault in self.faults:
            if fault.condition:
                text = re.sub(r"active\((\w+)\)", r"('\1' in active)", fault.condition)
                text = re.sub(r"p\d+\.[\w.]+(?:@true)?", lambda name: f"left['{name[0]}']", text)
                self.met[fault.id].append(eval(text, {"left": left, "active": active, "time": k * self.step}))
        self.known += 1
        self.since.append(self._at(k + 1))

    def at(self, t: float) -> dict[str, float]:
        """Since when each of those acts that do so at the time of a point."""
        if not self.since:
            self.since.append(self._at(0))
        return self.since[round(t / self.step)]

    def _at(self, k: int) -> dict[str, float]:
        t, found = k * self.step, {}
        for fault in self.faults:
            window = next((b for b, e in windows(fault, self.until) if b - 1e-9 <= t < e - 1e-9), None)
            if fault.condition:
                held = true_for(self.met[fault.id], self.step, fault.parameters.get("hold", 0.0))
                if "when" in fault.parameters:
                    if window is not None and held:
                        self.begun.setdefault(fault.id, k)
                    begun = self.begun.get(fault.id)
                    acts = begun is not None and (k - begun) * self.step < fault.duration - 1e-9
                    window = begun * self.step if acts else None
                elif window is not None:
                    before = self.since[k - 1].get(fault.id) if k else None
                    first = window > t - self.step + 1e-9  # the condition was met when the window began
                    window = None if not held else window if first else t if before is None else before
            if window is not None:
                found[fault.id] = window
        return found


def disturbed(value: float, name: str, faults: Sequence[Fault], since: dict[str, float], at: float) -> float:
    """A value under the faults that act, for the time ``at``."""
    for fault in faults:
        if fault.target != name or fault.id not in since:
            continue
        if fault.type == "bias":
            value += fault.parameters["value"]
        elif fault.type == "drift":
            value += fault.parameters["rate"] * (at - since[fault.id])
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
    acting = Acting(faults, step, step * (steps + 2))

    def passed(link: Link | None, at_source: float) -> float:
        return at_source if link is None or not link.scaled else link.factor * at_source + link.offset

    def true(name: str) -> float:
        component, variable = name.split(".", 1)
        return float(probes[component].out[variable])

    def leaving(t: float) -> Values:
        return {
            f"{n}.{v}": disturbed(true(f"{n}.{v}"), f"{n}.{v}", faults, acting.at(t), t)
            for n, p in probes.items()
            for v in p.out
        }

    def free(name: str, t: float) -> float:
        component, variable = name.split(".")
        return disturbed(float(probes[component].start[variable]), name, faults, acting.at(t), t)

    def visible(now: Values) -> Values:
        """What conditions see of a point."""
        return now | {f"{name}@true": true(name) for name in now}

    for _ in range(len(probes) + 1):  # t = 0: until nothing changes any more
        now = leaving(0.0)
        for name, one in probes.items():
            ends = {i: link_of.get(f"{name}.{i}") for i in INPUTS}
            one.leave({i: passed(k, now[k.source]) if k else free(f"{name}.{i}", 0.0) for i, k in ends.items()})
    now = leaving(0.0)
    acting.see(visible(now))
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
            if source not in done or (source, name) in cut:
                return begin, 0.0
            if output != "y" or variable != "u":  # discrete: the newest, as it leaves
                return passed(link, disturbed(true(link.source), link.source, faults, acting.at(end), end)), 0.0
            newest = passed(link, disturbed(true(link.source), link.source, faults, acting.at(t), end))
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
        acting.see(visible(now))
        for name, value in now.items():
            history[name].append(value)
            history[f"{name}@true"].append(true(name))
    return history
