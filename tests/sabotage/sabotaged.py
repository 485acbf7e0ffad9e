"""A system with saboteurs, flown by this project's master and by two that it did not write."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pandas

from navfmu import Fault, System
from navfmu.sabotage.system import Sabotaged, sabotage
from tests.conformance import hosts

H, STEPS = 0.125, 80
RECEIVERS = ("lag", "estimator")  # what is compared: components behind the saboteurs
READING = tuple(f"estimator.reading.{name}" for name in ("length", "valid", "sequence", "time_of_validity"))


def late(*targets: str) -> list[Fault]:
    """One communication step of delay: what a saboteur costs in a master that sets inputs before each step only."""
    return [Fault(f"late {target}", target, "delay", delay=H) for target in targets]


def own(system: System, *faults: Fault, seed: int = 3, algorithm: str = "jacobi", **more) -> pandas.DataFrame:
    """What the master makes of the faults itself."""
    return fly(system, faults=faults, seed=seed, algorithm=algorithm, **more)


def fly(system: System, **given) -> pandas.DataFrame:
    given = {"record": [f"{name}.*" for name in RECEIVERS], "algorithm": "jacobi"} | given
    return system.run(stop=STEPS * H, step=H, record_period=H, **given)


def package(system: System, file: Path, *faults: Fault, seed: int = 3, direct: bool = False) -> Sabotaged:
    return sabotage(system.experiment(stop=STEPS * H, step=H, seed=seed, faults=faults), file, direct=direct)


def same(one: pandas.DataFrame, other: pandas.DataFrame) -> bool:
    """To the last bit, at all times."""
    assert list(one.columns) == list(other.columns) and len(one) == len(other) == STEPS + 1
    return all(np.array_equal(one[name].to_numpy(), other[name].to_numpy(), equal_nan=True) for name in one)


def foreign(file: Path, folder: Path) -> dict[str, dict[str, float]]:
    """The last values of the receivers, "component.variable", as libcosim and Ecos have them."""
    with zipfile.ZipFile(file) as archive:
        archive.extractall(folder)
    fmus = {name: Path(fmu.path) for name, fmu in System.load(file).fmus.items()}
    flown = {
        "libcosim": hosts.libcosim_ssp(folder, fmus, H, STEPS),
        "Ecos": hosts.ecos_library_ssp(file, fmus, H, STEPS),
    }
    return {
        host: {f"{name}.{variable}": value for name in RECEIVERS for variable, value in values[name].items()}
        for host, values in flown.items()
    }


def last(frame: pandas.DataFrame) -> dict[str, float]:
    return {name: float(frame[name].iloc[-1]) for name in frame}
