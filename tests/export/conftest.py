"""The small components as unzipped native FMUs, built once."""

import pytest

from navfmu.export.build import build

from .arrays import Beacons, Cube, Receiver
from .components import (
    Iterating,
    Lag,
    Listener,
    Mixed,
    Modes,
    Named,
    Planned,
    Rows,
    Searcher,
    Sensor,
    Source,
    Ticking,
    TwoRates,
)
from .slave import Unzipped


@pytest.fixture(scope="session")
def unzipped(tmp_path_factory):
    """Name -> native FMU."""
    folder = tmp_path_factory.mktemp("small")
    small = [Sensor, Listener, Source, Rows, Searcher, TwoRates, Lag, Mixed, Modes, Named, Ticking]
    paths = build([Planned, *small, Iterating, Beacons, Cube, Receiver], folder)
    return {path.stem: Unzipped(path, folder / path.stem) for path in paths}
