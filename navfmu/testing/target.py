"""What a fault does to a target when the test does not say."""

from __future__ import annotations

from collections.abc import Sequence

from navfmu.errors import NavfmuError
from navfmu.faults.fault import TYPES
from navfmu.fmi import names
from navfmu.fmi.description import Variable
from navfmu.system.system import System


def usual_type(system: System, target: str | Sequence[str]) -> str:
    """The type of fault that a target has when none is given; several targets must have the same."""
    targets = list(target) if isinstance(target, (list, tuple)) else [target]
    if not targets:
        raise NavfmuError("fault([]): the list of targets is empty")
    types = {str(name): _usual(system, name) for name in targets}
    if len(set(types.values())) != 1:
        told = ", ".join(f"'{name}': {kind}" for name, kind in types.items())
        raise NavfmuError(f"fault({target!r}): these targets fail in different ways ({told}); give one type")
    return next(iter(types.values()))


def check_target(system: System, target: str) -> None:
    """Refuse a target that the system does not have; a component alone is one, too."""
    if target not in system.fmus:
        _variables(system, target)


def _usual(system: System, target: str) -> str:
    if isinstance(target, str) and target in system.fmus:
        raise _nothing_usual(target, "a component")
    found = _variables(system, target)
    component, rest = names.split(target)
    what, variability = found[0].causality, found[0].variability
    source = {link.target: link.source for link in system.links}.get(f"{component}.{found[0].name}")
    known = system.descriptions[component].by_name
    bundles = [names.bundle(name) for name in known if name.endswith(".valid")]
    is_bundle = any(f"{bundle}.sequence" in known for bundle in names.meant(bundles, rest))
    if is_bundle and (what == "output" or source is not None):
        return "dropout"
    if what == "input" and source is None:
        return "input"
    if what == "parameter" and variability == "tunable":
        return "parameter"
    if what == "parameter":
        raise NavfmuError(
            f"fault('{target}'): a {variability} parameter keeps its value during a run; give it another from the "
            f"start: s.parameters['{target}'] = ..."
        )
    kind = f"{'an' if what[0] in 'aeiou' else 'a'} {what}" + (f", connected to '{source}'" if source else "")
    raise _nothing_usual(target, kind)


def _nothing_usual(target: str, kind: str) -> NavfmuError:
    return NavfmuError(
        f"fault('{target}'): it is {kind}; say what happens to it: fault('{target}', TYPE, ...) with one of "
        f"{', '.join(TYPES)}"
    )


def _variables(system: System, target: str) -> list[Variable]:
    """All variables that a target means; at least one."""
    where = f"fault('{target}')"
    component, rest = names.split(target) if isinstance(target, str) else ("", "")
    if not rest:
        raise NavfmuError(f"fault({target!r}): expected a target written component.signal, such as 'gps.jammed'")
    system.known(component, where)
    known = system.descriptions[component].by_name
    found = [known[name] for name in names.group(known, rest).values()]
    return found or [names.find(system.descriptions, target, where).variable]
