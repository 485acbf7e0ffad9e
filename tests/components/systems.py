"""Systems of the test components, built once per test session."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from navfmu.export.build import build
from navfmu.ssp.writer import SystemSource

from . import ALL

_kept: list[TemporaryDirectory] = []  # removed when the process ends


@cache
def fmus() -> Path:
    """A folder with source.fmu, lag.fmu, sensor.fmu, estimator.fmu and two.fmu."""
    _kept.append(TemporaryDirectory(prefix="navfmu-tests-"))
    folder = Path(_kept[0].name)
    build(ALL, folder)
    return folder


@cache
def ring() -> Path:
    """Six lags in a circle, all at 1 m; variant ``one`` starts only the first there."""
    source = SystemSource("ring", fmus=fmus(), stop_time=1.0, step=0.1, description="six lags in a circle")
    for i in range(6):
        source.component(f"m{i}", "lag.fmu")
    for i in range(6):
        source.connect(f"m{i}.y", f"m{(i + 1) % 6}.u")
        source.parameters(f"m{i}", {"y0": 1.0})
    source.variant("one", parameters={f"m{i}": {"y0": 0.0} for i in range(1, 6)})
    return source.pack(fmus() / "ring.ssp")


@cache
def tracker() -> Path:
    """Source, sensor and estimator; variant ``slow`` has a lazy estimator."""
    source = SystemSource("tracker", fmus=fmus(), stop_time=20.0, step=0.1, description="a length is measured")
    source.component("truth", "source.fmu").component("lag", "lag.fmu")
    source.component("sensor", "sensor.fmu").component("estimator", "estimator.fmu")
    source.connect("truth.y", "lag.u").connect("lag.y", "sensor.length")
    source.connect("sensor.reading", "estimator.reading")
    source.parameters("truth", {"time_constant": 5.0})
    source.variant("slow", parameters={"estimator": {"gain": 0.01}})
    faults = fmus() / "stuck.toml"
    faults.write_text(
        '[[fault]]\nid = "F1"\ntarget = "sensor.reading.length"\ntype = "stuck"\n'
        "value = 3.0\nstart = 5.0\nduration = 5.0\n"
    )
    source.attach("faults/stuck.toml", faults)
    return source.pack(fmus() / "tracker.ssp")


@cache
def pair() -> Path:
    """One source of two lengths, each for a lag of its own."""
    source = SystemSource("pair", fmus=fmus(), stop_time=20.0, step=0.1, description="two lengths")
    source.component("truth", "two.fmu").component("one", "lag.fmu").component("two", "lag.fmu")
    source.connect("truth.y", "one.u").connect("truth.z", "two.u")
    return source.pack(fmus() / "pair.ssp")
