"""FMUs and systems that have a habit which FMI or SSP do not allow, but which is clear: a first-order lag each."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path

from navfmu.fmi.fmu import library_suffix, platforms
from tests.engine.probe import library
from tests.ssp import fmus


def same(text: str) -> str:
    """What has no habit."""
    return text


def lag(
    folder: Path,
    description: Callable[[str], str] = same,
    entry: Callable[[str], str] = same,
    binary: str = "probe",
) -> Path:
    """``lag.fmu``: y follows u with the time constant tau.

    ``description`` changes its model description, ``entry`` the names of its archive, ``binary`` is that of its
    library.
    """
    variables = [
        fmus.variable("u", "input", reference=0, unit="m", start="2"),
        fmus.variable("y", "output", reference=1, unit="m", initial="calculated"),
        fmus.variable("tau", "parameter", reference=2, unit="s", start="1"),
        fmus.variable("number", "input", "Integer", 0),
        fmus.variable("label", "parameter", "String", 0, start="probe"),
    ]
    text = description(fmus.describe("probe", variables, guid="{probe}"))
    path = folder / "lag.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(entry("modelDescription.xml"), text)
        archive.writestr(entry(f"binaries/{platforms()[0]}/{binary}{library_suffix()}"), library().read_bytes())
    return path


def replaced(*pairs: tuple[str, str]) -> Callable[[str], str]:
    """A change of a text: each pair is (what stands there, what stands there instead)."""

    def change(text: str) -> str:
        for old, new in pairs:
            assert old in text, f"{old!r} does not stand in {text}"
            text = text.replace(old, new)
        return text

    return change
