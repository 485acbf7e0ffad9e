"""The shipped system under the address and undefined-behaviour sanitizers: the engine, and the C of all ten FMUs."""

import zipfile
from concurrent.futures import ThreadPoolExecutor

import pytest

from navfmu.engine.library import RUNTIME, SOURCE, UNITS
from system_ssp.backup_navigator.system import COMPONENTS
from tests import sanitizers


@sanitizers.needs_gcc
@pytest.mark.slow
def test_sanitizers_find_nothing_in_a_flight_with_faults(package, fmus, tmp_path):
    engine = sanitizers.compile(UNITS, tmp_path / "engine.so", (SOURCE, RUNTIME), *sanitizers.SHARED)

    def library(name):
        """From the sources that the FMU itself carries."""
        folder = tmp_path / name
        with zipfile.ZipFile(fmus / f"{name}.fmu") as archive:
            archive.extractall(folder, [entry for entry in archive.namelist() if entry.startswith("sources/")])
        sources = folder / "sources"
        return sanitizers.compile([sources / "fmu.c"], tmp_path / f"{name}.so", [sources], *sanitizers.SHARED)

    with ThreadPoolExecutor(2) as pool:
        assert len(list(pool.map(library, COMPONENTS))) == 10
    sanitizers.run_python("tests.system.sanitized_flight", package, engine, tmp_path)
