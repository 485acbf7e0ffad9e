"""What ``run`` and ``sweep`` have in common: the options that say which system is run and how."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

import click

from navfmu.errors import NavfmuError
from navfmu.terminal import sentence

if TYPE_CHECKING:
    from navfmu.system.system import System


strict = click.option("--strict", is_flag=True, help="Refuse what is not as FMI and SSP have it, even if it is clear.")


def system_options(command: Callable) -> Callable:
    """Options that say which system is run and how; shared by ``run`` and ``sweep``."""
    options = [
        click.argument("system"),
        click.option("--variant", metavar="V", help="A sibling of the main system."),
        click.option("--set", "assignments", multiple=True, metavar="COMPONENT.PARAMETER=VALUE",
                     help="Change a parameter; a unit may follow the value: 'imu.gyro_drift_sigma=1 deg/h'."),
        click.option("--faults", multiple=True, metavar="FILE",
                     help="Fault file (TOML), or the name of one inside the system; may be repeated."),
        click.option("--fault", "entries", multiple=True, metavar="ENTRIES",
                     help="One fault: 'id = \"F1\", target = \"gps.jammed\", type = \"input\", start = 300'."),
        click.option("--stop", metavar="TIME", help="End of the run: seconds, or a text such as '35 min'."),
        click.option("--expect", metavar="HASH",
                     help="Refuse a system or faults that have changed since a repeat command was written."),
        click.option("--seed", type=int, metavar="N", help="Seed of every component with noise, and of the faults."),
        strict,
    ]  # fmt: skip
    for option in reversed(options):
        command = option(command)
    return command


def load(system: str, given: dict[str, Any]) -> tuple[System, dict[str, Any]]:
    """The system, and the arguments of an experiment, from the options that ``run`` and ``sweep`` share."""
    from navfmu.faults import parse_fault
    from navfmu.fmi.seconds import seconds
    from navfmu.system.system import System

    for name in ("stop", "step", "record_period"):
        if given.get(name) is not None:
            given[name] = seconds(given[name], f"--{name.replace('_', '-')}")
    loaded = System.load(system, given.pop("variant"), strict=given.pop("strict"))
    inline = [parse_fault(text, "--fault") for text in given.pop("entries")]
    given["faults"] = [*given["faults"], *inline]
    given["parameters"] = assigned(given.pop("assignments"))
    signals = given.pop("signals")
    given["record"] = names(signals) or None
    return loaded, given


_NAME = re.compile(r"(?:'[^']*'|\[[^\]]*\]|\([^)]*\)|[^,])+")


def names(signals: Sequence[str]) -> list[str]:
    """Names from repeated options and lists with commas; those in ``C[1,2]``, ``f(a,b)``, ``'a,b'`` do not separate."""
    found = [name.strip() for text in signals for name in _NAME.findall(text) if name.strip()]
    if signals and not found:
        raise NavfmuError("the names of signals are empty; leave them out to take those that there are")
    return found


def numbers(text: str, option: str) -> list[float]:
    values = []
    for part in text.split(","):
        try:
            values.append(float(part))
        except ValueError:
            raise NavfmuError(
                f"{option}: '{part.strip()}' is not a number; expected, for example, 0.01,0.1,1"
            ) from None
    return values


def assigned(texts: Iterable[str]) -> dict[str, str]:
    parameters = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or "." not in name:
            raise NavfmuError(f"--set '{text}': expected component.parameter=value")
        if name.strip() in parameters:
            raise NavfmuError(f"--set '{text}': '{name.strip()}' is set twice")
        parameters[name.strip()] = value.strip()
    return parameters


def tell(notes: Iterable[str]) -> None:
    for note in notes:
        sentence.tell(f"note: {note}")
