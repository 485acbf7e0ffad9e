"""Campaign files with axes, for the tests of what becomes of them."""

from __future__ import annotations

from pathlib import Path

from navfmu.campaign import Campaign, load_campaign
from tests.components import systems

HEAD = 'system = "{system}"\nstop = 2.0\nstep = 0.1\n'
DRIFT = '[[fault]]\nid = "D"\ntarget = "sensor.reading.length"\ntype = "drift"\nrate = 1.0\nstart = 0.5\n'
BIAS = '[[fault]]\nid = "B"\ntarget = "sensor.reading.length"\ntype = "bias"\nvalue = 2.0\nduration = 1.0\n'
NOISE = '[[fault]]\nid = "N"\ntarget = "lag.y"\ntype = "noise"\nsigma = 1.0\nperiod = 0.1\n'
CASES = """
[[case]]
name = "nominal"

[[case]]
name = "drift"
faults = "drift.toml"

[[case]]
name = "both"
faults = ["drift.toml", "bias.toml"]
"""


def written(folder: Path, text: str, head: str = HEAD) -> Path:
    """A campaign file of the tracker, with the fault files beside it."""
    for name, content in (("drift", DRIFT), ("bias", BIAS), ("noise", NOISE)):
        (folder / f"{name}.toml").write_text(content)
    file = folder / "campaign.toml"
    file.write_text(head.format(system=systems.tracker()) + text)
    return file


def loaded(folder: Path, text: str, **more: object) -> Campaign:
    """The campaign of such a file."""
    return load_campaign(written(folder, text), **more)
